"""What there is to know of a study while Snakemake runs it, from files: the overview and jobs' progress."""

import json
import os
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

VARIABLE = "GRANSTUDY_OVERVIEW"
"""Environment variable of Snakemake's main process: path of the overview, beside jobs' progress files."""

LABELS = ("trusted", "marginal", "untrusted", "failed")
"""Labels in the order in which they are shown."""


@dataclass(frozen=True)
class Overview:
    """A study as it was before its first job.

    Attributes
    ----------
    study, results : str
        Its name and the folder of its results.
    runs, done : int
        All runs, and those that were done.
    seconds : float
        Estimated seconds left, on one core.
    cores : int
    labels : dict of int
        Runs that were done, by label.
    page : str
        The file that shows the study on one page.
    """

    study: str
    results: str
    runs: int
    done: int = 0
    seconds: float = 0.0
    cores: int = 1
    labels: dict[str, int] = field(default_factory=dict)
    page: str = ""


@dataclass(frozen=True)
class Now:
    """A study at present: runs that are done, by label too; seconds left; all jobs begun; those running."""

    overview: Overview
    done: int
    labels: Counter[str]
    left: float
    jobs: list[Any]
    running: list[Any]


def announce(path: Path) -> None:
    """Say where the overview lies: the screen of this process looks there."""
    os.environ[VARIABLE] = str(path)


def read_overview() -> tuple[Overview, Path] | None:
    """The overview and its folder; None where there is none."""
    path = os.environ.get(VARIABLE)
    try:
        values = json.loads(Path(path).read_text()) if path else None
        return (Overview(**values), Path(path)) if path and values else None
    except (OSError, ValueError, TypeError):
        return None


def now(overview: Overview, jobs: list[Any], since: float, time: float) -> Now:
    """The study at a time, by the progress of the jobs that began ``since``.

    Parameters
    ----------
    jobs : list of granstudy.support.reporter.JobProgress
    since, time : float
        Seconds since 1970.
    """
    jobs = [job for job in jobs if job.started >= since]
    labels = Counter(overview.labels)
    for job in jobs:
        labels.update(job.labels)
    done = min(overview.runs, overview.done + sum(job.done for job in jobs))
    running = [job for job in jobs if job.state == "running" and not job.is_stale(time)]
    return Now(overview, done, labels, _left(overview, jobs, running), jobs, running)


def _left(overview: Overview, jobs: list[Any], running: list[Any]) -> float:
    """Seconds left: estimates scaled by the measured speed, on all cores, no less than the longest job's."""
    worth = sum(job.worth for job in jobs)
    spent = sum((job.updated - job.started) * job.threads for job in jobs)
    prior = max(
        5.0, 0.02 * overview.seconds
    )  # seconds of estimates that count as if they were measured
    speed = (spent + prior) / (worth + prior)
    left = max(0.0, overview.seconds - worth) * speed / max(1, overview.cores)
    return max([left, *(job.left for job in running)])
