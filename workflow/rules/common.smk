# The study, loaded and checked once; where its results lie (granstudy/study/layout.py).
from pathlib import Path

from snakemake.exceptions import WorkflowError

from granstudy.study.layout import Layout
from granstudy.study.schema.file import MAP
from granstudy.study.study import load_study
from granstudy.support.fingerprint import fingerprint

STUDY_FILE = config.get("study", "workflow/config/paper.yaml")

try:
    STUDY = load_study(STUDY_FILE)
    if (
        workflow.is_main_process
    ):  # jobs load this file again, and Matplotlib takes half a second
        from granstudy.analysis.vocabulary import check_words

        check_words(STUDY.model, STUDY_FILE)
except ValueError as error:
    raise WorkflowError(str(error)) from None

LAYOUT = Layout(STUDY, config.get("results", "results"))
RESULTS = LAYOUT.results


# A job of a cluster is two processes of Snakemake beside the one that computes: measured 180 MB each.
SNAKEMAKE_MB = 400


def each_attempt_more(amount):
    """A resource of which a job that failed asks for twice, then three times as much."""
    return lambda wildcards, attempt: amount * attempt


# On a cluster all but runs and benchmarks stay where snakemake was started.
localrules:
    all,
    plan,
    table,
    figure,
    map,
    notebook,


# The map's files lie beside those of experiments, none of which has its name.
wildcard_constraints:
    experiment=rf"(?!{MAP}\.)[^/]+",
