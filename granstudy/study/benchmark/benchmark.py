"""Error, seconds and memory of one evaluation of Q, all methods in one process and taken in turn."""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granstudy.collision.operator import collision_operator
from granstudy.collision.protocol import CollisionOperator
from granstudy.datasets.run_dataset import CONVENTIONS
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.study.benchmark.front import on_front
from granstudy.study.benchmark.timing import median_seconds, peak_memory_mb
from granstudy.study.run import Run
from granstudy.support.errors import ToleranceError
from granstudy.trust.flags import Status
from granstudy.velocity.radial import RadialGrid

WITHOUT_TRANSFORMS = ("direct", "radial")

UNUSED = {
    "direct": ("M_sph", "M_cir", "sphere_rule"),
    "radial": ("N_rho", "M_sph", "M_cir", "sphere_rule", "radial_rule", "variant"),
    "carleman": ("N_rho", "radial_rule"),
}
"""Parameters that play no part in a method."""

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


@dataclass(frozen=True)
class Measurement:
    """One run on so many threads; the numbers are NaN where its operator could not be planned."""

    run: Run
    threads: int
    seconds: float = np.nan
    fft_seconds: float = np.nan
    transforms: int = 0
    error: float = np.nan
    peak_memory_mb: float = np.nan
    reason: str = ""


@dataclass(frozen=True)
class Reference:
    """Q(f0,f0) that errors are measured against, on its own velocity nodes."""

    operator: CollisionOperator
    Q: np.ndarray

    def error(self, operator: CollisionOperator, Q: np.ndarray) -> float:
        """max|Q − Q_reference| / max|Q_reference| on the operator's nodes.

        A reference on a radial grid is evaluated there by its Fourier–Bessel series.
        """
        grid = operator.grid
        Q_reference = self.Q
        if isinstance(grid, RadialGrid):
            assert isinstance(self.operator.grid, RadialGrid)
            Q_reference = self.operator.grid.evaluate(self.Q, grid.nodes)
        return float(np.max(np.abs(Q - Q_reference)) / np.max(np.abs(self.Q)))


def benchmark(runs: list[Run], threads: int) -> xr.Dataset:
    """Time one evaluation of Q on the initial density for every run of a study's experiment.

    Each is timed on one thread and on ``threads``. The runs of one grid (with a reference, all runs: their
    errors are compared, whatever the grid) are timed in turn, round after round, so that a drift of the
    machine's speed hits all alike; medians are reported, and every ratio is taken within one such series.

    Returns
    -------
    xarray.Dataset
        Over ``run``; along it N, method, threads and the swept parameters, −1 or "" where one plays no
        part; all others scalar coordinates. `error` is max|Q − Q_reference|/max|Q_reference| against the
        reference of the experiment (of `radial` against `radial` with more nodes, at the run's nodes).
        `seconds` (median), `speedup` (seconds of the baseline on as many threads over seconds),
        `transforms`, `fft_seconds` (the bare FFTW time of those transforms), `overhead` (seconds /
        fft_seconds; NaN for `direct` and `radial`, which make none), `peak_memory_mb` (of one evaluation
        in a process of its own, beyond what the interpreter with the package and all its libraries takes),
        `front`, `baseline`, `status` and `reason`: a tolerance that the grid cannot reach is a run that
        failed.
    """
    timing, with_errors = runs[0].timing, runs[0].model.reference is not None
    rows: list[Measurement] = []
    for group in [runs] if with_errors else _by_grid(runs):
        references = _references(group, threads) if with_errors else {}
        for count in sorted({1, threads}) if timing.single_thread else [threads]:
            rows += _measure(group, count, references)
    if timing.memory:
        rows = _with_memory(rows, threads)
    values: dict[str, Any] = {
        name: np.array([getattr(row, name) for row in rows])
        for name in ("seconds", "fft_seconds", "transforms", "reason")
    }
    values["status"] = np.array([_status(row) for row in rows], dtype=np.int8)
    values["overhead"] = np.divide(
        values["seconds"],
        values["fft_seconds"],
        out=np.full(len(rows), np.nan),
        where=values["fft_seconds"] > 0,
    )
    baselines = [_baseline(row, rows) for row in rows]
    values["speedup"] = (
        np.array([b.seconds if b else np.nan for b in baselines]) / values["seconds"]
    )
    if timing.memory:
        values["peak_memory_mb"] = np.array([row.peak_memory_mb for row in rows])
    if with_errors:
        values["error"] = np.array([row.error for row in rows])
        values["baseline"] = np.array(
            [row is other for row, other in zip(rows, baselines, strict=True)]
        )
        values["front"] = _front(rows)
    return _dataset(rows, values)


def _by_grid(runs: list[Run]) -> list[list[Run]]:
    sizes = sorted({run.solver.N for run in runs})
    return [[run for run in runs if run.solver.N == N] for N in sizes]


def _references(runs: list[Run], threads: int) -> dict[str, Reference]:
    """The references of some runs by path; runs that share one get it once."""
    found = {}
    for reference in {run.reference.path: run.reference for run in runs}.values():
        operator = collision_operator(reference.scene, replace(reference.solver, threads=threads))
        Q = operator(reference.scene.density(operator.grid))
        found[reference.path] = Reference(operator, Q)
    return found


def _measure(runs: list[Run], threads: int, references: dict[str, Reference]) -> list[Measurement]:
    """Measure some runs, timed in turn."""
    rows = []
    calls: list[Callable[[], object]] = []
    for run in runs:
        solver = replace(run.solver, threads=threads)
        try:
            operator = collision_operator(run.scene, solver)
        except ToleranceError as error:
            rows.append(Measurement(run, threads, reason=str(error)))
            continue
        f = run.scene.density(operator.grid)
        Q = operator(f)  # compiles, and fills caches
        calls += [partial(operator, f), operator.transform]
        row = Measurement(run, threads, transforms=operator.transforms)
        if references:
            row = replace(row, error=references[run.reference.path].error(operator, Q))
        rows.append(row)
    medians = iter(median_seconds(calls, runs[0].timing.rounds))
    return [_with_seconds(row, medians) for row in rows]


def _with_seconds(row: Measurement, medians: Iterator[float]) -> Measurement:
    """The row with the next two medians: of its evaluation, and of its transforms alone."""
    if row.reason:
        return row
    seconds, bare = next(medians), next(medians)
    if row.run.solver.method in WITHOUT_TRANSFORMS:
        bare = 0.0
    return replace(row, seconds=seconds, fft_seconds=bare)


def _with_memory(rows: list[Measurement], together: int) -> list[Measurement]:
    """The rows with their peak memory, which is measured in so many processes at a time."""

    def measured(row: Measurement) -> Measurement:
        if row.reason:
            return row
        solver = replace(row.run.solver, threads=row.threads)
        return replace(row, peak_memory_mb=peak_memory_mb(row.run.scene, solver))

    with ThreadPoolExecutor(together) as pool:
        return list(pool.map(measured, rows))


def _baseline(row: Measurement, rows: list[Measurement]) -> Measurement | None:
    """The row that a row's speedup is taken over."""
    wanted = row.run.timing.baseline or {"method": "literal", "N": row.run.solver.N}
    for other in rows:
        if other.threads == row.threads and other.run.has(wanted):
            return other
    return None


def _front(rows: list[Measurement]) -> np.ndarray:
    """Rows on the front of those on as many threads."""
    front = np.zeros(len(rows), dtype=bool)
    threads = np.array([row.threads for row in rows])
    seconds, error = (
        np.array([getattr(row, name) for row in rows]) for name in ("seconds", "error")
    )
    for count in np.unique(threads):
        same = threads == count
        front[same] = on_front(seconds[same], error[same])
    return front


def _status(row: Measurement) -> Status:
    return Status.FAILED if row.reason else Status.OK


def _dataset(rows: list[Measurement], values: dict[str, Any]) -> xr.Dataset:
    """The variables with their names and units, and every parameter as a coordinate."""
    coordinates = [
        _parameters(row.run.scene, row.run.solver, [key for key, _ in row.run.values])
        | {"threads": row.threads}
        for row in rows
    ]
    along = {"N", "method", "threads"} | {key for row in rows for key, _ in row.run.values}
    coords: dict[str, Any] = {}
    for name in dict.fromkeys(name for row in coordinates for name in row):
        known = [row[name] for row in coordinates if name in row]
        if name in along or len(set(known)) > 1:
            absent: Any = "" if isinstance(known[0], str) else type(known[0])(-1)
            coords[name] = ("run", [row.get(name, absent) for row in coordinates])
        else:
            coords[name] = known[0]
    ds = xr.Dataset(
        {
            name: ("run", values[name], {"long_name": long_name, "units": units})
            for name, (long_name, units) in VARIABLES.items()
            if name in values
        },
        coords=coords,
    )
    ds.attrs = {
        "title": "granstudy benchmark",
        "Conventions": CONVENTIONS,
        "dim": rows[0].run.scene.dim,
    }
    return ds


def _parameters(scene: Scene, solver: Solver, swept: list[str]) -> dict[str, Any]:
    """A run's parameters without those that play no part in its method."""
    parameters = {**scene.coordinates(), **solver.coordinates(scene.dim)}
    if "symmetry" in swept:
        parameters["symmetry"] = scene.symmetry.name
    if "device" in swept:
        parameters["device"] = solver.device
    unused = UNUSED.get(solver.method, ())
    return {name: value for name, value in parameters.items() if name not in unused}
