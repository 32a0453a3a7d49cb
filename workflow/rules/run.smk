# One NetCDF file a run. The fingerprint of the solver's code is a parameter: Snakemake does not see
# edits in an imported package.
rule run:
    output:
        f"{RUNS}/{{experiment}}/{{point}}.nc",
    log:
        f"{RESULTS}/logs/{{experiment}}/{{point}}.log",
    conda:
        "../envs/granstudy.yaml"
    threads: lambda wildcards: study_run(wildcards).model.threads
    resources:
        mem_mb=lambda wildcards: study_run(wildcards).cost.memory_mb,
        runtime=lambda wildcards: study_run(wildcards).cost.minutes,
    params:
        study=STUDY_FILE,
        parameters=lambda wildcards: study_run(wildcards).parameters(),
        code=lambda wildcards: run_fingerprint(
            study_run(wildcards).model.run, study_run(wildcards).solver.method
        ),
    message:
        "{wildcards.experiment} {wildcards.point}"
    script:
        "../scripts/run.py"


# Alone on the machine: it takes all cores, so that nothing else disturbs its timings.
rule benchmark:
    output:
        f"{RESULTS}/benchmarks/{{experiment}}.nc",
    log:
        f"{RESULTS}/logs/{{experiment}}/benchmark.log",
    conda:
        "../envs/granstudy.yaml"
    threads: workflow.cores
    params:
        study=STUDY_FILE,
        parameters=lambda wildcards: [
            run.parameters() for run in STUDY.runs[wildcards.experiment].values()
        ],
        code=lambda wildcards: [
            run_fingerprint("collision", method)
            for method in ("direct", "fast", "literal")
        ],
    message:
        "benchmark {wildcards.experiment}"
    script:
        "../scripts/benchmark.py"
