# The study on one page, and a page for each table, which Snakemake's own report shows.
from granstudy.analysis.report.frames import frames_digest


rule page:
    input:
        LAYOUT.reported,
        study=STUDY_FILE,
    output:
        page=report(
            LAYOUT.report,
            caption="../captions/page.rst",
            category="The study on one page",
            labels={"study": STUDY.model.title},
        ),
        tables=[
            report(
                LAYOUT.table_page(name),
                caption="../captions/table.rst",
                category="Tables",
                labels=report_labels(name),
            )
            for name in LAYOUT.tabled
        ],
    log:
        f"{RESULTS}/logs/page.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        results=lambda wildcards: RESULTS_FOLDER,
        tables=lambda wildcards: str(Path(LAYOUT.table_page(MAP)).parent),
        code=[fingerprint(["granstudy.analysis.report.page"]), frames_digest()],
    message:
        "page"
    script:
        "../scripts/page.py"


# Where a table or a figure failed, the page shows the others, and says what is missing.
onerror:
    if not interrupt.stopped():
        from granstudy.analysis.report.page import write_report

        write_report(LAYOUT, STUDY_FILE, LAYOUT.report)
