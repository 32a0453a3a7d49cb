# All experiments of a study that have a truth: case × configuration → errors and label.
rule map:
    input:
        LAYOUT.map_tables,
    output:
        nc=LAYOUT.table_file(MAP, "nc"),
        csv=LAYOUT.table_file(MAP, "csv"),
        md=LAYOUT.table_file(MAP, "md"),
        png=LAYOUT.figure_file(MAP, "png"),
        svg=report(
            LAYOUT.figure_file(MAP, "svg"),
            caption="../captions/figure.rst",
            category="Figures",
            labels=report_labels(MAP),
        ),
    log:
        f"{RESULTS}/logs/{MAP}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        cases=STUDY.model.with_truth,
        title=STUDY.model.map.title if STUDY.model.map else "",
        code=fingerprint(
            ["granstudy.analysis.tables.map", "granstudy.analysis.figures.map"]
        ),
    message:
        "map"
    script:
        "../scripts/map.py"
