# One NetCDF file a run; cheap runs share a job. The keys hash the solver's code with the run's
# parameters: Snakemake does not see edits in an imported package. The longest jobs start first.
for job in LAYOUT.jobs:

    rule:
        name:
            f"run_{job.experiment}_{job.number}"
        output:
            [update(LAYOUT.run_file(job.experiment, run.path)) for run in job.runs],
        log:
            f"{RESULTS}/logs/{job.experiment}/{job.number}.log",
        priority: int(job.seconds)
        conda:
            "../envs/granstudy.yaml"
        threads: job.threads
        resources:
            mem_mb=each_attempt_more(SNAKEMAKE_MB + job.memory_mb),
            runtime=each_attempt_more(job.minutes),
        params:
            study=STUDY_FILE,
            experiment=job.experiment,
            points=[run.path for run in job.runs],
            run_keys=job.keys,
            unfinished=LAYOUT.unfinished(job.experiment),
        message:
            f"{job.experiment}: {len(job.runs)} runs from {job.runs[0].path}"
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
    threads: lambda wildcards: workflow.cores
    params:
        study=STUDY_FILE,
        parameters=lambda wildcards: LAYOUT.benchmark_parameters(wildcards.experiment),
        code=lambda wildcards: LAYOUT.benchmark_code(wildcards.experiment),
    message:
        "benchmark {wildcards.experiment}"
    script:
        "../scripts/benchmark.py"
