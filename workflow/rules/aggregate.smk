# Many runs to one labelled table, and tables or runs to figures.
rule table:
    input:
        runs=lambda wildcards: LAYOUT.run_files(wildcards.experiment),
        beside=lambda wildcards: LAYOUT.beside_table(wildcards.experiment),
    output:
        multiext(f"{RESULTS}/tables/{{experiment}}", ".nc", ".csv", ".md"),
    log:
        f"{RESULTS}/logs/tables/{{experiment}}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        study=STUDY_FILE,
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
        runs=lambda wildcards: LAYOUT.run_files(wildcards.experiment),
    output:
        multiext(f"{RESULTS}/figures/{{experiment}}", ".png", ".svg"),
    log:
        f"{RESULTS}/logs/figures/{{experiment}}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        study=STUDY_FILE,
        request=lambda wildcards: LAYOUT.figure_request(wildcards.experiment),
        code=fingerprint(["granstudy.analysis.figures.figure"]),
    message:
        "figure {wildcards.experiment}"
    script:
        "../scripts/figure.py"
