"""The work of a job: its runs one after the other, each into the store."""

import traceback
from pathlib import Path

from granstudy.runs.execute import Outcome, obtain
from granstudy.runs.store import is_link, link
from granstudy.study.jobs import Job
from granstudy.study.layout import Layout
from granstudy.study.run import Run
from granstudy.support.files import write_json


class JobError(Exception):
    """Some runs of a job could not be computed; the others were."""


def work(job: Job, layout: Layout, threads: int, receipt: str | Path) -> None:
    """Compute the runs of a job, each into the store and under its name in the study's folder.

    A run that is in the store is left alone. A run that cannot be computed does not keep the others from it.

    Parameters
    ----------
    receipt : str or Path
        File that is written once all runs are there.

    Raises
    ------
    JobError
        Names every run that could not be computed, with its cause.
    """
    names: dict[str, list[Run]] = {}
    for experiment, path, key in job.runs:
        names.setdefault(key, []).append(layout.study.run(experiment, path))
    left, outcomes, errors = list(names), list[Outcome](), list[str]()
    for wait in (False, True):  # runs that another process computes come last
        waiting = []
        for key in left:
            first = names[key][0]
            try:
                outcome = obtain(first.computation, key, layout.store, threads, wait)
            except Exception as error:
                traceback.print_exc()
                errors.append(f"{first.experiment}/{first.path}: {type(error).__name__}: {error}")
                continue
            if outcome is None:
                waiting.append(key)
                continue
            outcomes.append(outcome)
            for run in names[key]:
                _name(layout, run, key)
        left = waiting
    if errors:
        raise JobError("\n".join(errors))
    write_json(Path(receipt), [outcome.label for outcome in outcomes])


def _name(layout: Layout, run: Run, key: str) -> None:
    """Give a run in the store its name in the study's folder."""
    source, target = layout.store.path(key), Path(layout.run_file(run.experiment, run.path))
    if not is_link(source, target):
        link(source, target)
