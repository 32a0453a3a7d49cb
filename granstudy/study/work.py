"""The work of a job: its runs one after the other, each into the store."""

import traceback
from pathlib import Path

from granstudy.runs.execute import obtain
from granstudy.runs.store import link
from granstudy.study.jobs import Job
from granstudy.study.layout import Layout
from granstudy.study.run import Run
from granstudy.support.files import write_json
from granstudy.support.reporter import SUFFIX, Reporter


class JobError(Exception):
    """Some runs of a job could not be computed; the others were."""


def work(job: Job, layout: Layout, threads: int, receipt: str | Path) -> None:
    """Compute the runs of a job, each into the store and under its names in the study's folder.

    A run that is in the store is left alone. A run that cannot be computed does not keep the others from it.

    Parameters
    ----------
    receipt : str or Path
        File that is written once all runs are there: key ↦ label, as JSON.

    Raises
    ------
    JobError
        Names every run that could not be computed, with its cause.
    """
    names: dict[str, list[Run]] = {}
    for experiment, path, key in job.runs:
        names.setdefault(key, []).append(layout.study.run(experiment, path))
    errors: list[str] = []
    labels: dict[str, str] = {}
    progress, title = layout.jobs / f"{job.id}{SUFFIX}", ", ".join(job.experiments)
    with Reporter(progress, job.id, title, job.seconds_by_run, threads) as reporter:
        for key, runs in names.items():
            there, name = key in layout.store, f"{runs[0].experiment}/{runs[0].path}"
            if not there:
                reporter.start(name)
            try:
                outcome = obtain(runs[0].computation, key, layout.store, threads, reporter.step)
            except Exception as error:
                traceback.print_exc()
                errors.append(f"{name}: {type(error).__name__}: {error}")
                reporter.finish("failed", "failed")
                continue
            labels[key] = outcome.label
            for run in runs:
                link(layout.store.path(key), Path(layout.run_file(run.experiment, run.path)))
            if there:
                reporter.found(outcome.label)
            else:
                reporter.finish(outcome.status, outcome.label)
        if errors:
            raise JobError("\n".join(errors))
    write_json(Path(receipt), labels)
