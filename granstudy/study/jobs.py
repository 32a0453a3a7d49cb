"""Cheap runs of an experiment share a job: starting one takes seconds, whatever it computes."""

from dataclasses import dataclass
from functools import cached_property
from itertools import count
from math import ceil

from granstudy.study.estimates import estimate_run
from granstudy.study.run import Run
from granstudy.study.run_key import run_keys

JOB_SECONDS = 60.0
"""Runs are put together until their estimated time reaches this; a longer run is alone in its job."""


@dataclass(frozen=True)
class Job:
    """Some runs of one experiment, computed one after the other by one process."""

    experiment: str
    number: int
    runs: tuple[Run, ...]

    @cached_property
    def keys(self) -> list[str]:
        """`run_key` of every run."""
        return run_keys(self.runs)

    @property
    def threads(self) -> int:
        """Cores that the job takes."""
        return self.runs[0].model.threads

    @property
    def seconds(self) -> float:
        """Estimated time on one core."""
        return sum(_seconds(run) for run in self.runs)

    @property
    def minutes(self) -> int:
        """Minutes to ask a cluster for: five times the estimate, and time to start."""
        return 5 + ceil(5 * self.seconds / 60)

    @property
    def memory_mb(self) -> int:
        """Estimated memory of its largest run."""
        return max(estimate_run(run).cost.memory_mb for run in self.runs)


def jobs(runs: list[Run]) -> list[Job]:
    """Divide an experiment's runs into jobs, in their order."""
    numbers = count(1)
    found: list[Job] = []
    waiting: list[Run] = []
    together = 0.0
    for run in [*runs, None]:
        alone = run is None or _seconds(run) >= JOB_SECONDS
        if waiting and (together >= JOB_SECONDS or alone):
            found.append(Job(waiting[0].experiment, next(numbers), tuple(waiting)))
            waiting, together = [], 0.0
        if run is not None:
            waiting.append(run)
            together += _seconds(run)
    return found


def _seconds(run: Run) -> float:
    """Estimated time of a run on one core."""
    return estimate_run(run).cost.seconds
