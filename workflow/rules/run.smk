# One NetCDF file a run; cheap runs share a job. The keys hash the solver's code with the run's
# parameters: Snakemake does not see edits in an imported package. The longest jobs start first.
for job in JOBS:

    rule:
        name:
            f"run_{job.experiment}_{job.number}"
        output:
            [update(f"{RUNS}/{job.experiment}/{run.path}.nc") for run in job.runs],
        log:
            f"{RESULTS}/logs/{job.experiment}/{job.number}.log",
        priority: int(job.seconds)
        conda:
            "../envs/granstudy.yaml"
        threads: job.threads
        resources:
            mem_mb=job.memory_mb,
            runtime=job.minutes,
        params:
            study=STUDY_FILE,
            experiment=job.experiment,
            points=[run.path for run in job.runs],
            run_keys=job.keys,
            unfinished=f"{RUNS}/.unfinished",
        message:
            f"{job.experiment}: {len(job.runs)} runs from {job.runs[0].path}"
        script:
            "../scripts/run.py"


def benchmarked(experiment):
    """Runs of a benchmark, and those that their errors are measured against."""
    runs = list(STUDY.runs[experiment].values())
    with_errors = STUDY.model.experiments[experiment].reference is not None
    return runs + [run.reference for run in runs if with_errors]


def benchmark_parameters(experiment):
    """All that a benchmark's numbers depend on but the code."""
    runs = benchmarked(experiment)
    parameters = list(dict.fromkeys(run.parameters() for run in runs))
    return [*parameters, runs[0].timing.model_dump_json()]


def benchmark_code(experiment):
    """Fingerprints of the code that is timed, and of the code that times it."""
    operators = sorted({run.choice.solver.operator for run in benchmarked(experiment)})
    return [run_fingerprint("collision", operator) for operator in operators] + [
        fingerprint(["granstudy.benchmark"])
    ]


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
        parameters=lambda wildcards: benchmark_parameters(wildcards.experiment),
        code=lambda wildcards: benchmark_code(wildcards.experiment),
    message:
        "benchmark {wildcards.experiment}"
    script:
        "../scripts/benchmark.py"
