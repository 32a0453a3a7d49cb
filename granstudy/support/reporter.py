"""What a job of many runs tells while it runs: lines of its log, and a file that others read."""

import json
import math
import os
import socket
import sys
import time as clock
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from types import TracebackType
from typing import Any

import psutil

from granstudy.support.files import TEMPORARY_PREFIX

SUFFIX = ".progress.json"
"""End of the name of a job's progress file."""

WRITE_EVERY = 1.0
"""Seconds between two writings of the file at least."""

LINE_EVERY = 10.0
"""Seconds between two lines about the same run at least."""

STALE_AFTER = 60.0
"""Seconds without news after which a job that says it runs is taken for dead."""

ESTIMATES_COUNT = 2.0
"""Seconds of measured work that count as much as the estimates made before the start."""


@dataclass(frozen=True)
class JobProgress:
    """How far a job is.

    Attributes
    ----------
    job, title : str
        Its identity, and what a reader calls it: the experiment's name.
    runs, done : int
        All runs; those that are done, also those that another process or an earlier attempt made.
    run : str
        Path of the run that is computed now; "" between runs.
    step, steps : int
        Steps of that run that are done, and all; 0 where they are not known.
    time : float or None
        Time t that it has reached.
    started, updated : float
        Seconds since 1970.
    left : float
        Estimated seconds left.
    worth : float
        Estimated seconds, as they were before the start, of what was computed so far.
    threads : int
        Cores that the job takes.
    state : str
        ``running``, ``done``, ``stopped`` (by a signal), ``failed``.
    labels : dict of int
        Runs that are done, by label: trusted, marginal, untrusted, failed.
    pid, host
        The process.
    """

    job: str
    title: str
    runs: int
    done: int = 0
    run: str = ""
    step: int = 0
    steps: int = 0
    time: float | None = None
    started: float = 0.0
    updated: float = 0.0
    left: float = 0.0
    worth: float = 0.0
    threads: int = 1
    state: str = "running"
    labels: Mapping[str, int] = field(default_factory=dict)
    pid: int = 0
    host: str = ""

    def is_stale(self, now: float) -> bool:
        """Whether a job that says it runs is dead: no news for long, or on this host no such process."""
        if self.state != "running":
            return False
        gone = self.host == socket.gethostname() and not _alive(self.pid)
        return gone or now - self.updated > STALE_AFTER


def write_progress(path: Path, progress: JobProgress) -> None:
    """Write a progress file whole or not at all; it is not synchronised, as the next second's replaces it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{TEMPORARY_PREFIX}{os.getpid()}-{path.name}")
    partial.write_text(json.dumps(asdict(progress)))
    os.replace(partial, path)


def read_progress(folder: Path) -> list[JobProgress]:
    """All jobs that have a progress file in ``folder``, by name; damaged files are left out."""
    found = map(read_progress_file, sorted(folder.glob(f"*{SUFFIX}")))
    return [progress for progress in found if progress is not None]


def read_progress_file(path: Path) -> JobProgress | None:
    """The progress in a file; None where it is missing or damaged."""
    try:
        values = json.loads(path.read_text())
        known = {one.name: values[one.name] for one in fields(JobProgress)}
    except (OSError, ValueError, KeyError, TypeError):
        return None
    numbers = (known[name] for name in ("runs", "done", "updated", "left", "worth"))
    whole = isinstance(known["labels"], dict) and all(isinstance(n, int | float) for n in numbers)
    return JobProgress(**known) if whole else None


def _alive(pid: int) -> bool:
    """Whether a process of this host lives."""
    return psutil.pid_exists(pid)  # os.kill(pid, 0) ends it on Windows


def duration(seconds: float) -> str:
    """A duration in words, in steps that an estimate deserves: 8 s, 40 s, 3 min, 2 h 10 min, 3 days."""
    if seconds < 10:
        return f"{max(1, round(seconds))} s"
    if seconds < 55:
        return f"{5 * round(seconds / 5)} s"
    minutes = max(1, round(seconds / 60))
    if minutes < 60:
        return f"{minutes} min"
    if minutes < 24 * 60:
        minutes = 10 * round(minutes / 10)
        hours, rest = divmod(minutes, 60)
        return f"{hours} h {rest} min" if rest else f"{hours} h"
    days = round(minutes / (24 * 60))
    return "1 day" if days == 1 else f"{days} days"


class Reporter:
    """Reports the runs of a job: a context in which each run is found, or started, stepped and finished.

    Parameters
    ----------
    path : Path
        The progress file.
    job, title : str
        As of `JobProgress`.
    seconds : sequence of float
        Estimated seconds of every run, in their order.
    threads : int
        Cores that the job takes.
    say : callable
        Takes a line of the log; standard error by default.
    now : callable
        The time in seconds since 1970.
    """

    def __init__(
        self,
        path: Path,
        job: str,
        title: str,
        seconds: Sequence[float],
        threads: int = 1,
        say: Callable[[str], Any] = lambda line: print(line, file=sys.stderr, flush=True),
        now: Callable[[], float] = clock.time,
    ) -> None:
        self._path, self._seconds, self._say, self._now = path, list(seconds), say, now
        self._labels: Counter[str] = Counter()
        self._measured = 0.0  # seconds of runs computed to their end
        self._worth = 0.0  # their estimates
        self._current = 0.0  # the estimate of the present run
        self._run_started = self._written = self._said = -math.inf
        self.progress = JobProgress(
            job=job, title=title, runs=len(self._seconds), threads=threads, started=now(),
            left=sum(self._seconds), pid=os.getpid(), host=socket.gethostname(),
        )  # fmt: skip

    def __enter__(self) -> "Reporter":
        self._update(write=True)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        """Write how the job ended; an error is left to whoever catches it."""
        done = f"{self.progress.done} of {self.progress.runs} runs"
        if kind is None:
            self._update(write=True, state="done", run="")
        elif issubclass(kind, Exception):
            self._say(f"failed after {done}, in {self.progress.run or 'no run'}")
            self._update(write=True, state="failed")
        else:
            self._say(f"stopped after {done}; the same command goes on")
            self._update(write=True, state="stopped")

    def found(self, label: str) -> None:
        """Note that the next run was done before, and what it counts as."""
        self._seconds.pop(0)
        self._labels[label] += 1
        self._update(done=self.progress.done + 1, labels=dict(self._labels))

    def start(self, run: str) -> None:
        """Note that the next run begins."""
        self._current = self._seconds.pop(0)
        self._run_started = self._now()
        self._update(write=True, run=run, step=0, steps=0, time=None)
        self._line()

    def step(self, done: int, total: int, time: float) -> None:
        """Note how far the run is; the function to give as ``progress`` to `granstudy.simulate`."""
        self._update(step=done, steps=total, time=time if math.isfinite(time) else None)
        if self._now() - self._said >= LINE_EVERY:
            self._line()

    def finish(self, status: str, label: str) -> None:
        """Note that the run is done.

        Parameters
        ----------
        status : str
            How it ended: ``ok``, ``diverged``, ``failed``.
        label : str
            What it counts as: trusted, marginal, untrusted, failed.
        """
        took = self._now() - self._run_started
        self._measured += took
        self._worth += self._current
        self._current = 0.0
        self._labels[label] += 1
        number, path = self.progress.done + 1, self.progress.run
        words = " ".join(dict.fromkeys([status, label]))
        self._update(done=number, run="", step=0, steps=0, time=None, labels=dict(self._labels))
        left = f"  about {duration(self.progress.left)} left" if self._seconds else ""
        self._say(f"run {number} of {self.progress.runs}  {path}  {words}  {took:.1f} s{left}")

    def _line(self) -> None:
        """Say where the present run is."""
        now = self.progress
        parts = [f"run {now.done + 1} of {now.runs}", now.run]
        parts += [f"step {now.step} of {now.steps}"] if now.steps else []
        parts += [f"t = {now.time:.4g}"] if now.time is not None else []
        self._say("  ".join([*parts, f"about {duration(now.left)} left"]))
        self._said = self._now()

    def _update(self, write: bool = False, **changes: Any) -> None:
        """Change the progress, and write it where that was not done within `WRITE_EVERY`."""
        now = self._now()
        progress = replace(self.progress, updated=now, **changes)
        left, worth = self._estimate(progress, now)
        self.progress = replace(progress, left=left, worth=worth)
        if write or now - self._written >= WRITE_EVERY:
            write_progress(self._path, self.progress)
            self._written = now

    def _estimate(self, progress: JobProgress, now: float) -> tuple[float, float]:
        """Seconds left, and the worth of what was computed.

        Estimates of runs that wait are scaled by the measured speed. What the present run takes is guessed
        from its steps the more, the more of them are done.
        """
        part = min(1.0, progress.step / progress.steps) if progress.steps else 0.0
        spent = now - self._run_started if self._current else 0.0
        worth = self._worth + part * self._current
        known = self._measured + (spent if part else 0.0)
        speed = (known + ESTIMATES_COUNT) / (worth + ESTIMATES_COUNT)
        run = speed * self._current
        if part:
            weight = math.sqrt(part)
            run = weight * spent / part + (1.0 - weight) * run
        return max(0.0, run - spent) + speed * sum(self._seconds), worth
