# The study, loaded and checked once; where its results lie (granstudy/study/layout.py); what is left to do.
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake_logger_plugin_granstudy import interrupt, locks, overview

from granstudy.study.jobs import Job
from granstudy.study.layout import Layout
from granstudy.study.schema.names import ATLAS, MAP
from granstudy.study.state import check_owner, prepare
from granstudy.study.study import load_study, read_study
from granstudy.support.fingerprint import fingerprint

# ^C ends all jobs at once, and the same command goes on.
shell.prefix(interrupt.SHELL_PREFIX)
if workflow.is_main_process:
    interrupt.install()
    locks.clear_stale()

if "study" not in config:
    raise WorkflowError("no study is named; add --config study=my_study.yaml")
STUDY_FILE = config["study"]
RESULTS_FOLDER = config.get("results", "results")

try:
    # A job on a cluster loads this file again; the study was checked before.
    STUDY = (load_study if workflow.is_main_process else read_study)(STUDY_FILE)
    LAYOUT = Layout(STUDY, RESULTS_FOLDER)
    if workflow.is_main_process:  # Matplotlib takes half a second
        from granstudy.analysis.requests import check_requests

        check_requests(STUDY, STUDY_FILE)
        check_owner(LAYOUT, STUDY_FILE)
except ValueError as error:
    raise WorkflowError(str(error)) from None

RESULTS = LAYOUT.results

# Cores that share the work. None on a cluster, where a dry run claims to have one, beside `jobs` of the profile.
CORES = workflow.resource_settings.cores
if CORES == 1 and workflow.resource_settings.nodes is not None:
    CORES = None

# The jobs that are left: each is written to a file, which a job on a cluster finds there.
if workflow.is_main_process:
    JOBS = {job.id: job for job in prepare(LAYOUT, STUDY_FILE, CORES)}
    overview.announce(LAYOUT.overview)
else:
    JOBS = {
        path.stem: Job.read(path)
        for path in LAYOUT.jobs.glob("*.json")
        if "." not in path.stem and path not in (LAYOUT.overview, LAYOUT.labels)
    }


def receipts_by_experiment():
    """Receipts of the jobs that an experiment waits for, by experiment; of those with runs that are left."""
    job_of = {key: job.id for job in JOBS.values() for _, _, key in job.runs}
    waited = {}
    for member in STUDY.members if workflow.is_main_process else ():
        if member.key in job_of:
            receipt = LAYOUT.receipt(job_of[member.key])
            waited.setdefault(member.experiment, {})[receipt] = None
    return {name: list(receipts) for name, receipts in waited.items()}


# A job of a cluster is two processes of Snakemake beside the one that computes: measured 180 MB each.
SNAKEMAKE_MB = 400


def each_attempt_more(amount):
    """A resource of which a job that failed asks for twice, then three times as much."""
    return lambda wildcards, attempt: amount * attempt


def report_labels(name):
    """What Snakemake's report calls an experiment, the map, or the atlas."""
    joint = {MAP: STUDY.model.map, ATLAS: STUDY.model.atlas}
    titled = joint[name] if name in joint else STUDY.model.experiments[name]
    return {"experiment": name, "title": titled.title if titled else ""}


# On a cluster all but runs and benchmarks stay where snakemake was started.
localrules:
    all,
    plan,
    dataset,
    table,
    figure,
    map,
    atlas,
    notebook,
    notebooks,
    page,


# The files of map and atlas lie beside those of experiments, none of which has such a name.
wildcard_constraints:
    experiment=rf"(?!{MAP}\.|{ATLAS}\.)[^/]+",
