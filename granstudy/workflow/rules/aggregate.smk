# All runs of an experiment to one labelled dataset, that to a table, and table or runs to figures.
rule dataset:
    input:
        LAYOUT.complete("{experiment}"),
    output:
        f"{RESULTS}/datasets/{{experiment}}.nc",
    log:
        f"{RESULTS}/logs/datasets/{{experiment}}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        study=STUDY_FILE,
        results=lambda wildcards: RESULTS_FOLDER,
        code=fingerprint(["granstudy.datasets.collected"]),
    message:
        "dataset {wildcards.experiment}"
    script:
        "../scripts/dataset.py"


rule table:
    input:
        dataset=lambda wildcards: LAYOUT.dataset(wildcards.experiment),
        beside=lambda wildcards: LAYOUT.beside_table(wildcards.experiment),
    output:
        multiext(f"{RESULTS}/tables/{{experiment}}", ".nc", ".csv", ".md"),
    log:
        f"{RESULTS}/logs/tables/{{experiment}}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        study=STUDY_FILE,
        results=lambda wildcards: RESULTS_FOLDER,
        request=lambda wildcards: LAYOUT.table_request(wildcards.experiment),
        code=fingerprint(["granstudy.analysis.tables.table"]),
    message:
        "table {wildcards.experiment}"
    script:
        "../scripts/table.py"


rule figure:
    input:
        table=f"{RESULTS}/tables/{{experiment}}.nc",
        beside=lambda wildcards: LAYOUT.beside_figure(wildcards.experiment),
        dataset=lambda wildcards: LAYOUT.dataset(wildcards.experiment),
    output:
        f"{RESULTS}/figures/{{experiment}}.png",
        report(
            f"{RESULTS}/figures/{{experiment}}.svg",
            caption="../captions/figure.rst",
            category="Figures",
            labels=lambda wildcards: report_labels(wildcards.experiment),
        ),
    log:
        f"{RESULTS}/logs/figures/{{experiment}}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        study=STUDY_FILE,
        results=lambda wildcards: RESULTS_FOLDER,
        request=lambda wildcards: LAYOUT.figure_request(wildcards.experiment),
        code=fingerprint(["granstudy.analysis.figures.figure"]),
    message:
        "figure {wildcards.experiment}"
    script:
        "../scripts/figure.py"
