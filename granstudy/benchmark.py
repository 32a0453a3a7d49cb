"""Seconds and memory of one evaluation of Q, all methods in one process and taken in turn."""

import pickle
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.collision import collision_operator
from granstudy.run import Run
from granstudy.scene import Scene
from granstudy.solver import Solver

LEAST_ROUNDS = 3
LEAST_SECONDS = 2.0
PROCESS_STATUS = Path("/proc/self/status")
WITHOUT_TRANSFORMS = ("direct", "radial")


def benchmark(runs: list[Run], threads: int) -> xr.Dataset:
    """Time one evaluation of Q on the initial density for every run of a study's experiment.

    Each is timed on one thread and on ``threads``. The methods of one grid are timed in turn, round
    after round, so that a drift of the machine's speed hits all alike; medians are reported, and every
    ratio is taken within one such series.

    Returns
    -------
    xarray.Dataset
        Over ``run`` with coordinates N, method, threads: `seconds` (median), `speedup` (seconds of
        `literal` at the same N and threads over seconds), `transforms`, `fft_seconds` (the bare
        FFTW time of those transforms), `overhead` (seconds / fft_seconds; NaN for `direct` and
        `radial`, which make none), `peak_memory_mb` (of one evaluation in a process of its own,
        beyond what the interpreter with the package and all its libraries takes).
    """
    rows = []
    for N in sorted({run.solver.N for run in runs}):
        for count in sorted({1, threads}):
            group = [
                (run.scene, replace(run.solver, threads=count)) for run in runs if run.solver.N == N
            ]
            rows += _time_group(group)
    dims = ["run"]
    seconds = np.array([row["seconds"] for row in rows])
    keys = [(row["N"], row["threads"]) for row in rows]
    literal = {
        key: row["seconds"]
        for key, row in zip(keys, rows, strict=True)
        if row["method"] == "literal"
    }
    fft_seconds = np.array([row["fft_seconds"] for row in rows])
    overhead = np.divide(
        seconds, fft_seconds, out=np.full(len(rows), np.nan), where=fft_seconds > 0
    )
    units = {"seconds": "s", "fft_seconds": "s", "peak_memory_mb": "MB"}
    long_names = {
        "seconds": "median time of one evaluation of Q",
        "fft_seconds": "bare FFTW time of the transforms made",
        "transforms": "Fourier transforms on the grid in one evaluation",
        "peak_memory_mb": "peak memory beyond the interpreter and its libraries",
        "speedup": "time of literal over this method's, same N and threads",
        "overhead": "time over bare FFTW time",
    }
    values = {
        "seconds": seconds,
        "speedup": np.array([literal.get(key, np.nan) for key in keys]) / seconds,
        "transforms": np.array([row["transforms"] for row in rows]),
        "fft_seconds": fft_seconds,
        "overhead": overhead,
        "peak_memory_mb": np.array([row["peak_memory_mb"] for row in rows]),
        "status": np.zeros(len(rows), dtype=np.int8),
    }
    ds = xr.Dataset(
        {
            name: (
                dims,
                value,
                {"long_name": long_names.get(name, name), "units": units.get(name, "1")},
            )
            for name, value in values.items()
        },
        coords={name: (dims, [row[name] for row in rows]) for name in ("N", "method", "threads")},
    )
    ds.attrs = {"title": "granstudy benchmark", "Conventions": "CF-1.11"}
    return ds


def _time_group(group: list[tuple[Scene, Solver]]) -> list[dict[str, object]]:
    """Time the methods of one grid in turn."""
    operators = [collision_operator(scene, solver) for scene, solver in group]
    densities = [scene.density(op.grid) for (scene, _), op in zip(group, operators, strict=True)]
    calls: list[Callable[[], object]] = []
    for operator, f in zip(operators, densities, strict=True):
        calls.append(partial(operator, f))
        calls.append(operator.transform)
    times: list[list[float]] = [[] for _ in calls]
    for call in calls:
        call()  # compiles, and fills caches
    start = time.perf_counter()
    while len(times[0]) < LEAST_ROUNDS or time.perf_counter() - start < LEAST_SECONDS:
        for call, taken in zip(calls, times, strict=True):
            begin = time.perf_counter()
            call()
            taken.append(time.perf_counter() - begin)
    medians = [statistics.median(taken) for taken in times]
    return [
        {
            "N": solver.N,
            "method": solver.method,
            "threads": solver.threads,
            "seconds": medians[2 * i],
            "fft_seconds": 0.0 if solver.method in WITHOUT_TRANSFORMS else medians[2 * i + 1],
            "transforms": operators[i].transforms,
            "peak_memory_mb": peak_memory_mb(scene, solver),
        }
        for i, (scene, solver) in enumerate(group)
    ]


def peak_memory_mb(scene: Scene, solver: Solver) -> float:
    """Peak memory of planning and one evaluation in a process of its own, in MB.

    Beyond what that process held after one evaluation at N = 4: the interpreter, the libraries and the
    compiled loops.
    """
    # A plain command: multiprocessing would import the calling script again.
    command = [sys.executable, "-c", "from granstudy.benchmark import report_peak; report_peak()"]
    answer = subprocess.run(
        command, input=pickle.dumps((scene, solver)), stdout=subprocess.PIPE, check=True
    )
    return float(answer.stdout)


def report_peak() -> None:
    """Print `peak_memory_mb` of the scene and solver pickled on standard input."""
    scene, solver = pickle.load(sys.stdin.buffer)

    def evaluate(solver: Solver) -> float:
        operator = collision_operator(scene, solver)
        operator(scene.density(operator.grid))
        return _peak_kb()

    before = evaluate(replace(solver, N=4))
    print((evaluate(solver) - before) / 1024)


def _peak_kb() -> float:
    """Peak memory of this process's own, where the system tells (Linux), else NaN.

    Not `resource.getrusage`: that of a child starts at its parent's.
    """
    if not PROCESS_STATUS.is_file():
        return float("nan")
    (line,) = (row for row in PROCESS_STATUS.read_text().splitlines() if row.startswith("VmHWM"))
    return float(line.split()[1])
