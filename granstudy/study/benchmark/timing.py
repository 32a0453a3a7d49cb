"""Seconds of calls taken in turn, and the peak memory of one evaluation of Q."""

import math
import pickle
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import psutil

from granstudy.collision.operator import collision_operator
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver

try:
    from resource import RUSAGE_SELF, getrusage
except ImportError:  # Windows
    HAS_RUSAGE = False
else:
    HAS_RUSAGE = True

STATUS = Path("/proc/self/status")

LEAST_SECONDS = 2.0
"""Turns go on for so long, however fast the calls."""

TURN_SECONDS = 5.0e-3
LARGEST_REPEATS = 200
"""A call that takes less is repeated in its turn, so often at most."""


def median_seconds(calls: Sequence[Callable[[], object]], rounds: int) -> list[float]:
    """Median time of each call, all taken in turn, round after round, for at least so many rounds."""
    times: list[list[float]] = [[] for _ in calls]
    start = time.perf_counter()
    done = 0
    while done < rounds or time.perf_counter() - start < LEAST_SECONDS:
        for call, taken in zip(calls, times, strict=True):
            for _ in range(_repeats(taken)):
                begin = time.perf_counter()
                call()
                taken.append(time.perf_counter() - begin)
        done += 1
    return [statistics.median(taken) for taken in times]


def _repeats(taken: Sequence[float]) -> int:
    """How often a call of which these times are known is made in its turn."""
    if not taken:
        return 1
    return min(LARGEST_REPEATS, math.ceil(TURN_SECONDS / max(min(taken), 1e-9)))


def peak_memory_mb(scene: Scene, solver: Solver) -> float:
    """Peak memory of planning and one evaluation in a process of its own, in MB.

    What that process held after one evaluation at N = 4 does not count: the interpreter, the libraries and
    the compiled loops.
    """
    # A plain command: multiprocessing would import the calling script again.
    command = [
        sys.executable,
        "-c",
        "from granstudy.study.benchmark.timing import report_peak; report_peak()",
    ]
    answer = subprocess.run(
        command, input=pickle.dumps((scene, solver)), stdout=subprocess.PIPE, check=True
    )
    return float(answer.stdout)


def report_peak() -> None:
    """Print `peak_memory_mb` of the scene and solver pickled on standard input."""
    scene, solver = pickle.load(sys.stdin.buffer)

    def evaluate(solver: Solver) -> int:
        operator = collision_operator(scene, solver)
        operator(scene.density(operator.grid))
        return _peak_kilobytes()

    small = replace(solver, N=4, rtol=None)  # which a tolerance could not be reached with
    before = evaluate(small)
    print((evaluate(solver) - before) / 1024)


def _peak_kilobytes() -> int:
    """Most memory that this process has held at a time, in kB."""
    # Linux's ru_maxrss starts at what the parent held when it started this process; VmHWM does not.
    if STATUS.is_file():
        lines = STATUS.read_text().splitlines()
        return int(next(line for line in lines if line.startswith("VmHWM")).split()[1])
    if HAS_RUSAGE:
        return getrusage(RUSAGE_SELF).ru_maxrss // 1024  # macOS says bytes
    return psutil.Process().memory_info().peak_wset // 1024
