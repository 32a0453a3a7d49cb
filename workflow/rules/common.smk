# The study, loaded and checked once; paths of what it makes.
import sys
from pathlib import Path

from snakemake.exceptions import WorkflowError

from granstudy.support.fingerprint import fingerprint, run_fingerprint
from granstudy.study.jobs import jobs
from granstudy.study.study import load_study
from granstudy.study.schema.file import MAP

STUDY_FILE = config.get("study", "workflow/config/paper.yaml")

try:
    STUDY = load_study(STUDY_FILE)
except ValueError as error:
    raise WorkflowError(str(error)) from None

RESULTS = f"{config.get('results', 'results')}/{STUDY.name}"
RUNS = f"{RESULTS}/runs"


JOBS = [
    job
    for name, runs in STUDY.runs.items()
    if STUDY.model.experiments[name].run != "benchmark"
    for job in jobs(list(runs.values()))
]


# The map's files lie beside those of experiments, none of which has its name.
wildcard_constraints:
    experiment=rf"(?!{MAP}\.)[^/]+",


def run_files(experiment):
    """Datasets of an experiment's runs."""
    if STUDY.model.experiments[experiment].run == "benchmark":
        return [f"{RESULTS}/benchmarks/{experiment}.nc"]
    return [f"{RUNS}/{experiment}/{path}.nc" for path in STUDY.runs[experiment]]


def tables_beside(experiment, part):
    """Tables of the other experiments that a ``figure`` or a ``table`` shows."""
    asked = getattr(STUDY.model.experiments[experiment], part)
    return [f"{RESULTS}/tables/{name}.nc" for name in (asked.beside if asked else [])]


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
        fingerprint(["granstudy.study.benchmark.benchmark"])
    ]


def experiments_with(part):
    """Names of the experiments that ask for a ``table`` or a ``figure``."""
    return [
        name
        for name, model in STUDY.model.experiments.items()
        if getattr(model, part) is not None
    ]


def tables():
    """All tables, in three formats."""
    return expand(
        f"{RESULTS}/tables/{{name}}.{{format}}",
        name=experiments_with("table"),
        format=["nc", "csv", "md"],
    )


def figures():
    """All figures, in two formats."""
    return expand(
        f"{RESULTS}/figures/{{name}}.{{format}}",
        name=experiments_with("figure"),
        format=["png", "svg"],
    )


def study_map():
    """The map of the study's cases, where it asks for one."""
    return (
        [f"{RESULTS}/tables/{MAP}.nc", f"{RESULTS}/figures/{MAP}.png"]
        if STUDY.model.map is not None
        else []
    )


def notebooks():
    """The executed analysis notebook, of the paper study."""
    return (
        f"{RESULTS}/notebooks/cooling_and_convergence.ipynb"
        if STUDY.name == "paper"
        else []
    )
