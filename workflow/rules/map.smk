# All experiments of a study that have a truth: case × configuration → errors and label.
rule map:
    input:
        expand(f"{RESULTS}/tables/{{name}}.nc", name=STUDY.model.with_truth),
    output:
        nc=f"{RESULTS}/tables/{MAP}.nc",
        csv=f"{RESULTS}/tables/{MAP}.csv",
        md=f"{RESULTS}/tables/{MAP}.md",
        png=f"{RESULTS}/figures/{MAP}.png",
        svg=f"{RESULTS}/figures/{MAP}.svg",
    log:
        f"{RESULTS}/logs/{MAP}.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        cases=STUDY.model.with_truth,
        title=STUDY.model.map.title if STUDY.model.map else "",
        code=fingerprint(["granstudy.analysis.tables.map", "granstudy.analysis.figures.map"]),
    message:
        "map"
    script:
        "../scripts/map.py"
