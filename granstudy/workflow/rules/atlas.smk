# All states to an accuracy: one dataset over e, λ, dimension and state, and its maps.
rule atlas:
    input:
        LAYOUT.atlas_tables,
    output:
        nc=LAYOUT.table_file(ATLAS, "nc"),
        csv=LAYOUT.table_file(ATLAS, "csv"),
        md=LAYOUT.table_file(ATLAS, "md"),
        png=LAYOUT.figure_file(ATLAS, "png"),
        svg=report(
            LAYOUT.figure_file(ATLAS, "svg"),
            caption="../captions/atlas.rst",
            category="Figures",
            labels=report_labels(ATLAS),
        ),
    log:
        f"{RESULTS}/logs/{ATLAS}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        title=STUDY.model.atlas.title if STUDY.model.atlas else "",
        code=fingerprint(
            ["granstudy.analysis.tables.atlas", "granstudy.analysis.figures.atlas"]
        ),
    message:
        "atlas"
    script:
        "../scripts/atlas.py"
