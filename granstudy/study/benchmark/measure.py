"""Error, seconds and memory of one evaluation of Q for some runs, timed in turn."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from granstudy.collision.operator import collision_operator
from granstudy.collision.protocol import CollisionOperator
from granstudy.study.benchmark.timing import median_seconds, peak_memory_mb
from granstudy.study.run import Run
from granstudy.support.errors import ToleranceError
from granstudy.velocity.radial import RadialGrid

ONCE = 2
"""Transforms that an evaluation makes of f and of Q: no more of them are no sum over nodes."""


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

    @property
    def overhead(self) -> float:
        """Time of the evaluation over the bare time of its transforms, NaN where they are no sum."""
        return self.seconds / self.fft_seconds if self.fft_seconds > 0.0 else np.nan


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


def references_of(runs: Sequence[Run], threads: int) -> dict[str, Reference]:
    """The references of some runs by path; runs that share one get it once."""
    found = {}
    for reference in {run.reference.path: run.reference for run in runs}.values():
        operator = collision_operator(reference.scene, replace(reference.solver, threads=threads))
        Q = operator(reference.scene.density(operator.grid))
        found[reference.path] = Reference(operator, Q)
    return found


def measure(
    runs: Sequence[Run], threads: int, references: dict[str, Reference]
) -> list[Measurement]:
    """Measure some runs, timed in turn.

    Parameters
    ----------
    references : dict of Reference
        What errors are measured against, by the path of each run's reference; none: no errors.
    """
    rows = []
    calls: list[Callable[[], object]] = []
    for run in runs:
        try:
            operator = collision_operator(run.scene, replace(run.solver, threads=threads))
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
    return replace(row, seconds=seconds, fft_seconds=bare if row.transforms > ONCE else 0.0)


def with_memory(rows: Sequence[Measurement], together: int) -> list[Measurement]:
    """The rows with their peak memory, measured in so many processes at a time."""

    def measured(row: Measurement) -> Measurement:
        if row.reason:
            return row
        solver = replace(row.run.solver, threads=row.threads)
        return replace(row, peak_memory_mb=peak_memory_mb(row.run.scene, solver))

    with ThreadPoolExecutor(together) as pool:
        return list(pool.map(measured, rows))
