# What the study will take, before it runs: `snakemake plan`. Not part of `all`.
rule plan:
    input:
        study=STUDY_FILE,
    output:
        f"{RESULTS}/plan.md",
        f"{RESULTS}/plan.csv",
    log:
        f"{RESULTS}/logs/plan.log",
    conda:
        "../envs/granstudy.yaml"
    params:
        code=fingerprint(["granstudy.analysis.tables.plan"]),
    message:
        "plan"
    script:
        "../scripts/plan.py"
