"""Error, seconds and memory of one evaluation of Q, all runs of an experiment in one process."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.parameters import ABSENT
from granstudy.datasets.run_dataset import CONVENTIONS
from granstudy.model.methods import YARDSTICK
from granstudy.study.benchmark.front import on_front
from granstudy.study.benchmark.measure import Measurement, measure, references_of, with_memory
from granstudy.study.run import Run
from granstudy.trust.flags import Status

VARIABLES = {
    "error": ("max|Q − Q_reference| / max|Q_reference| on the velocity nodes", "1"),
    "seconds": ("median time of one evaluation of Q", "s"),
    "speedup": ("time of the baseline over this run's, same number of threads", "1"),
    "transforms": ("Fourier transforms on the grid in one evaluation", "1"),
    "fft_seconds": ("bare FFTW time of the transforms made", "s"),
    "overhead": ("time over bare FFTW time", "1"),
    "peak_memory_mb": ("peak memory beyond the interpreter and its libraries", "MB"),
    "front": ("no other run on as many threads has both a smaller error and a smaller time", "1"),
    "baseline": ("the run that speedups are taken over", "1"),
    "status": ("how the run ended", "1"),
    "reason": ("why it did not end well", "1"),
}
"""Long name and units of every variable, in a table's order."""


def benchmark(runs: Sequence[Run], threads: int) -> xr.Dataset:
    """Time one evaluation of Q on the initial density for every run of a study's experiment.

    Each run is timed on one thread and on ``threads``. The runs of one grid are timed in turn, round after
    round, so that a drift of the machine's speed hits all alike; with a reference, all runs are, as their
    errors are compared whatever the grid. Medians are reported, and every ratio is taken within one series.

    Returns
    -------
    xarray.Dataset
        Over ``run``, the variables of `VARIABLES`; `peak_memory_mb` where the timing asks for it, `error`,
        `front` and `baseline` where there is a reference. N, method, threads and the swept parameters are
        coordinates along ``run``, −1 or "" where one plays no part; all others are scalar coordinates.

        - `error` is taken against the experiment's reference; of a radial run against a radial run with more
          nodes, at the run's own.
        - `fft_seconds` is the time of the bare transforms, 0 for methods that are no sum over transforms;
          `overhead` is then NaN.
        - `peak_memory_mb` is that of one evaluation in a process of its own; what the interpreter takes with
          the package and all its libraries does not count.
        - `status`: a run whose tolerance the grid cannot reach has failed, `reason` says why.
    """
    timing, with_errors = runs[0].timing, runs[0].has_reference
    rows: list[Measurement] = []
    for group in [list(runs)] if with_errors else _by_grid(runs):
        references = references_of(group, threads) if with_errors else {}
        for count in sorted({1, threads}) if timing.single_thread else [threads]:
            rows += measure(group, count, references)
    if timing.memory:
        rows = with_memory(rows, threads)
    return benchmark_dataset(rows)


def benchmark_dataset(rows: Sequence[Measurement]) -> xr.Dataset:
    """The dataset of a benchmark out of what was measured; as of `benchmark`."""
    timing, with_errors = rows[0].run.timing, rows[0].run.has_reference
    left_out = {"error", "front", "baseline"} if not with_errors else set()
    left_out |= {"peak_memory_mb"} if not timing.memory else set()
    values = {name: value for name, value in _values(rows).items() if name not in left_out}
    return _dataset(rows, values)


def _by_grid(runs: Sequence[Run]) -> list[list[Run]]:
    sizes = sorted({run.solver.sized().N for run in runs})
    return [[run for run in runs if run.solver.N == N] for N in sizes]


def _values(rows: Sequence[Measurement]) -> dict[str, np.ndarray]:
    """Every variable over the rows."""
    measured = ("error", "seconds", "transforms", "fft_seconds", "overhead", "peak_memory_mb")
    values = {
        name: np.array([getattr(row, name) for row in rows]) for name in (*measured, "reason")
    }
    baselines = [_baseline(row, rows) for row in rows]
    over = np.array([np.nan if other is None else other.seconds for other in baselines])
    is_baseline = [row is other for row, other in zip(rows, baselines, strict=True)]
    status = [Status.FAILED if row.reason else Status.OK for row in rows]
    return values | {
        "speedup": over / values["seconds"],
        "front": _front(rows),
        "baseline": np.array(is_baseline),
        "status": np.array(status, dtype=np.int8),
    }


def _baseline(row: Measurement, rows: Sequence[Measurement]) -> Measurement | None:
    """The row that a row's speedup is taken over."""
    wanted = row.run.timing.baseline or {"method": YARDSTICK, "N": row.run.solver.N}
    for other in rows:
        if other.threads == row.threads and other.run.has(wanted):
            return other
    return None


def _front(rows: Sequence[Measurement]) -> np.ndarray:
    """Rows on the front of those on as many threads."""
    front = np.zeros(len(rows), dtype=bool)
    threads, seconds, error = (
        np.array([getattr(row, name) for row in rows]) for name in ("threads", "seconds", "error")
    )
    for count in np.unique(threads):
        same = threads == count
        front[same] = on_front(seconds[same], error[same])
    return front


def _dataset(rows: Sequence[Measurement], values: dict[str, np.ndarray]) -> xr.Dataset:
    """The variables with their names and units, and every parameter as a coordinate."""
    variables = {
        name: ("run", values[name], {"long_name": long_name, "units": units})
        for name, (long_name, units) in VARIABLES.items()
        if name in values
    }
    attributes = {
        "title": "granstudy benchmark",
        "Conventions": CONVENTIONS,
        "dim": rows[0].run.scene.dim,
    }
    return xr.Dataset(variables, _coordinates(rows), attributes)


def _coordinates(rows: Sequence[Measurement]) -> dict[str, Any]:
    """Parameters that are swept or differ between runs along ``run``, all others as scalars."""
    parameters = [_parameters(row.run) | {"threads": row.threads} for row in rows]
    along = {"N", "method", "threads"} | {key for row in rows for key, _ in row.run.values}
    coords: dict[str, Any] = {}
    for name in dict.fromkeys(name for row in parameters for name in row):
        known = [row[name] for row in parameters if name in row]
        if name in along or len(set(known)) > 1:
            coords[name] = ("run", [row.get(name, ABSENT.get(name, "")) for row in parameters])
        else:
            coords[name] = known[0]
    return coords


def _parameters(run: Run) -> dict[str, Any]:
    """A run's parameters without those that play no part in its method."""
    scene, solver = run.scene, run.solver
    more = {"symmetry": scene.symmetry.name, "device": solver.device}
    swept = {name: more[name] for name, _ in run.values if name in more}
    parameters = {**scene.coordinates(), **solver.coordinates(scene.dim), **swept}
    unused = solver.traits.unused
    return {name: value for name, value in parameters.items() if name not in unused}
