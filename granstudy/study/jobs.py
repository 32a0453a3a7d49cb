"""Runs that share a job: starting a process takes seconds, whatever it computes."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import ceil
from pathlib import Path

from granstudy.collision.choice.cost import one_after_the_other
from granstudy.runs.estimates import estimate_run
from granstudy.study.schema.experiment import EvolutionTableModel
from granstudy.study.study import Member
from granstudy.support.files import write_json

LONGEST, SHORTEST = 60.0, 2.0
"""Seconds of estimated work that a job gets at most and at least; a longer run is alone in its job."""

JOBS_PER_CORE = 3
"""Jobs a core that the work is divided into, so that one long job does not keep the others waiting."""


@dataclass(frozen=True)
class Job:
    """Some runs of a study, computed one after the other by one process.

    Attributes
    ----------
    runs : tuple of (str, str, str)
        Experiment, path and key of each run; a run with several names is there several times.
    seconds : tuple of float
        Estimated time of each run on one core, 0 for a further name.
    threads : int
        Cores that the job takes.
    memory_mb : int
        Estimated memory of its largest run.
    """

    runs: tuple[tuple[str, str, str], ...]
    seconds: tuple[float, ...]
    threads: int
    memory_mb: int

    @property
    def id(self) -> str:
        """Name of the job: a hash over its runs."""
        return hashlib.sha256(" ".join(key for _, _, key in self.runs).encode()).hexdigest()[:10]

    @property
    def experiments(self) -> list[str]:
        """The experiments that its runs were taken from."""
        return list(dict.fromkeys(experiment for experiment, _, _ in self.runs))

    @property
    def total(self) -> float:
        """Estimated time of all its runs on one core."""
        return sum(self.seconds)

    @property
    def seconds_by_run(self) -> list[float]:
        """Estimated time of each run, whatever its names."""
        seconds: dict[str, float] = {}
        for (_, _, key), one in zip(self.runs, self.seconds, strict=True):
            seconds[key] = seconds.get(key, 0.0) + one
        return list(seconds.values())

    @property
    def minutes(self) -> int:
        """Minutes to ask a cluster for: five times the estimate, and time to start."""
        return 5 + ceil(5 * self.total / 60)

    def write(self, path: Path) -> None:
        """Write the job to a file, which the process that computes it reads."""
        write_json(path, asdict(self))

    @classmethod
    def read(cls, path: str | Path) -> "Job":
        """Read a job from its file."""
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        runs = tuple((experiment, name, key) for experiment, name, key in content["runs"])
        return cls(runs, tuple(content["seconds"]), content["threads"], content["memory_mb"])


def jobs(runs: Sequence[Sequence[Member]], cores: int | None) -> list[Job]:
    """Divide runs into jobs, in their order; the longest job comes first.

    Runs of an experiment whose table has their seconds share one job: a process loads code at its first run,
    which so is part of one run's seconds alone.

    Parameters
    ----------
    runs : sequence of sequences of Member
        Members of one inner sequence are the same run under several names.
    cores : int or None
        Cores that the jobs share; None where each job gets a machine of its own.
    """
    priced = list(zip(runs, seconds_of(runs), strict=True))
    share = LONGEST if cores is None else sum(map(_price, priced)) / (JOBS_PER_CORE * cores)
    enough = min(max(share, SHORTEST), LONGEST)
    found: list[Job] = []
    waiting: list[Priced] = []
    together = 0.0
    for one in [*priced, None]:
        alone = one is None or _price(one) >= enough
        other = one is not None and bool(waiting) and _apart(one[0], waiting[0][0])
        full = (together >= enough or alone) and not (one and waiting and _timed(one[0]))
        if waiting and (full or other):
            found.append(_job(waiting))
            waiting, together = [], 0.0
        if one is not None:
            waiting.append(one)
            together += _price(one)
    return sorted(found, key=lambda job: -job.total)


def _timed(run: Sequence[Member]) -> str:
    """The experiment whose table has the run's seconds; "" where none has."""
    table = run[0].run.model.table
    timed = isinstance(table, EvolutionTableModel) and table.seconds
    return run[0].experiment if timed else ""


def _apart(run: Sequence[Member], other: Sequence[Member]) -> bool:
    """Whether two runs do not share a job, whatever they cost."""
    return threads_of(run) != threads_of(other) or _timed(run) != _timed(other)


Priced = tuple[Sequence[Member], float]
"""A run under all its names, and its estimated seconds."""


def _price(one: Priced) -> float:
    return one[1]


def _job(runs: Sequence[Priced]) -> Job:
    names = [(m.experiment, m.path, m.key) for run, _ in runs for m in run]
    seconds = [price if m is run[0] else 0.0 for run, price in runs for m in run]
    memory = [estimate_run(run[0].run.computation).cost.memory_mb for run, _ in runs]
    return Job(tuple(names), tuple(seconds), threads_of(runs[0][0]), max(memory))


def seconds_of(runs: Sequence[Sequence[Member]]) -> list[float]:
    """Estimated time of each run on one core, one after the other: a tensor counts for the first of them."""
    return one_after_the_other(estimate_run(run[0].run.computation).cost for run in runs)


def threads_of(run: Sequence[Member]) -> int:
    """Most cores that an experiment gives the run."""
    return max(member.run.model.threads for member in run)
