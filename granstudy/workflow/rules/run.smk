# The runs that are not in the store yet: cheap ones share a job, the longest job starts first. A run is known
# by its key, a hash over its parameters and the code that computes it: Snakemake does not see edits in an
# imported package.
for job in JOBS.values():

    rule:
        name:
            f"run_{job.id}"
        output:
            receipt=LAYOUT.receipt(job.id),
        log:
            f"{RESULTS}/logs/runs/{job.id}.log",
        priority: int(job.total)
        conda:
            "../envs/granstudy.yaml"
        threads: job.threads
        resources:
            mem_mb=each_attempt_more(SNAKEMAKE_MB + job.memory_mb),
            runtime=each_attempt_more(job.minutes),
        params:
            study=STUDY_FILE,
            results=lambda wildcards: RESULTS_FOLDER,
            job=LAYOUT.job_file(job.id),
        message:
            f"{len(job.runs)} runs from {job.runs[0][0]}/{job.runs[0][1]}"
        script:
            "../scripts/run.py"


# Experiments with runs that are left: the file that says that all are there. Of the others it is there already.
for name, waited in receipts_by_experiment().items():

    rule:
        name:
            f"complete_{name}"
        input:
            waited,
        output:
            LAYOUT.complete(name),
        log:
            f"{RESULTS}/logs/runs/{name}.log",
        localrule: True
        conda:
            "../envs/granstudy.yaml"
        params:
            awaited=LAYOUT.awaited(name),
            since=Path(LAYOUT.since(name)).read_text(),
        message:
            f"runs of {name}"
        shell:
            "cp {params.awaited:q} {output:q} 2> {log:q}"


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
