"""Estimates of what an evaluation of Q and its set-up cost, before they start: seconds and memory.

All constants are medians on one core of a 2021 server; another machine is faster or slower by one factor.
Estimates are quick, as a workflow waits for them before it starts.

Measured on two quiet cores, over methods, N, dimensions, precisions, tolerances, 1 and 2 threads: in 59 of 64
cases `granstudy.plan` was within a factor 2 of the seconds of an evaluation. Four of the other five (padded
products; a restitution law in 2D) led to the constants of today. The fifth is `direct` in 2D on two threads.
"""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from granstudy.collision.fourier.wisdom import planner
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver

CACHED_POINTS = 2**16
"""Most points of a real transform that a core's cache holds."""

OUT_OF_CACHE = 1.4
"""Time of a point in a larger transform, over its time in a cached one."""

EVEN_SIZES = (12, 20)
"""Points a dimension of fast real transforms, beside powers of two."""

UNEVEN = 2.2
"""Time of a point in real transforms of other sizes, over its time in fast ones: FFTW's estimated plans of 24
points a dimension take longer than plans of 32."""

UNEVEN_TUNED = 1.4
"""The same with the plans of `granstudy tune`."""

SECONDS_PER_CALL = 1.0e-4
"""Seconds of one evaluation, whatever its size: checks, and handing shares to threads."""

SETUP_SECONDS = 0.02
"""Seconds of any set-up: rules, weights, plans of transforms."""

INTERPRETER_MB = 300
"""Megabytes of Python with NumPy, SciPy, Numba and xarray loaded."""


@dataclass(frozen=True)
class Cost:
    """Estimate for one run on one thread.

    Attributes
    ----------
    setup : float
        Seconds beside the evaluations: before the first of them, and between them.
    each : float
        Seconds of an evaluation.
    evaluations : int
    memory_mb : int
    kept : tuple of (str, float)
        What the run computes and keeps for all runs that need it: names in the cache, and seconds. What is
        kept already is left out.
    """

    setup: float
    each: float
    evaluations: int
    memory_mb: int
    kept: tuple[tuple[str, float], ...] = ()

    @property
    def seconds(self) -> float:
        """Seconds of all, what is kept included."""
        return self.own_seconds + sum(seconds for _, seconds in self.kept)

    @property
    def own_seconds(self) -> float:
        """Seconds of all but what is kept."""
        return self.setup + self.evaluations * self.each


def one_after_the_other(costs: Iterable[Cost]) -> list[float]:
    """Seconds of runs of which the first that needs a thing computes it, and the others find it."""
    there: set[str] = set()
    found = []
    for cost in costs:
        missing = {name: seconds for name, seconds in cost.kept if name not in there}
        there |= set(missing)
        found.append(cost.own_seconds + sum(missing.values()))
    return found


@dataclass(frozen=True)
class MethodCost:
    """How to estimate an evaluation of Q by one method.

    Attributes
    ----------
    nodes, transforms : callable
        (scene, solver) ↦ nodes of the sum, and Fourier transforms, of an evaluation.
    seconds : callable
        (scene, solver, transforms, n) ↦ seconds of an evaluation on one thread, with so many transforms of
        n points a dimension.
    setup : callable
        (scene, solver, seconds of an evaluation) ↦ seconds before the first evaluation.
    numbers : callable
        (scene, solver, transforms) ↦ double-precision numbers kept in memory.
    efficiency : float
        Speed that each thread after the first adds, in parts of the first: Table 5 of the study `paper`,
        N = 16 to 64, on two cores.
    exact : callable
        solver ↦ whether ``nodes`` and ``transforms`` are exact, known before the operator is made.
    kept : callable
        (scene, solver) ↦ what the set-up computes and keeps, as of `Cost`; what is kept already is left out.
    points : callable
        (scene, solver) ↦ points a dimension of most transforms.
    """

    nodes: Callable[[Scene, SizedSolver], int]
    transforms: Callable[[Scene, SizedSolver], int]
    seconds: Callable[[Scene, SizedSolver, int, int], float]
    setup: Callable[[Scene, SizedSolver, float], float]
    numbers: Callable[[Scene, SizedSolver, int], float]
    efficiency: float
    exact: Callable[[SizedSolver], bool] = lambda solver: True
    kept: Callable[[Scene, SizedSolver], tuple[tuple[str, float], ...]] = lambda scene, solver: ()
    points: Callable[[Scene, SizedSolver], int] = lambda scene, solver: solver.product_points


@dataclass(frozen=True)
class TransformTimes:
    """Times of an evaluation that is a sum over Fourier transforms.

    Attributes
    ----------
    point : float
        Seconds of a transform and the loops around it, per p log₂ p of its p points.
    each : float
        Seconds of a transform, whatever its size.
    real : bool
        Whether the transforms are real, which depend on cache and size.
    """

    point: float
    each: float
    real: bool = True

    def seconds(self, scene: Scene, solver: SizedSolver, transforms: int, n: int) -> float:
        """Seconds of an evaluation with ``transforms`` transforms of n points a dimension."""
        points = n**scene.dim
        slower = 1.0
        if self.real:
            slower *= OUT_OF_CACHE if points > CACHED_POINTS else 1.0
            even = n in EVEN_SIZES or n.bit_count() == 1
            slower *= 1.0 if even else UNEVEN_TUNED if _is_tuned(scene.dim, n) else UNEVEN
        each = self.each + self.point * slower * points * math.log2(points)
        return SECONDS_PER_CALL + transforms * each


def _is_tuned(dim: int, n: int) -> bool:
    """Whether this machine has wisdom for transforms of n points a dimension."""
    shape = (n, n if dim == 3 else 1, n)
    return f"double {'x'.join(map(str, shape))}" in planner().wisdom.texts


def estimate(cost: MethodCost, scene: Scene, solver: SizedSolver, evaluations: int) -> Cost:
    """Cost of a number of evaluations of Q by the solver's method, whose row is ``cost``."""
    transforms = cost.transforms(scene, solver)
    each = cost.seconds(scene, solver, transforms, cost.points(scene, solver))
    memory = memory_mb(cost.numbers(scene, solver, transforms))
    kept = cost.kept(scene, solver)
    return Cost(cost.setup(scene, solver, each), each, evaluations, memory, kept)


def memory_mb(numbers: float) -> int:
    """Megabytes of a process that keeps so many double-precision numbers."""
    return INTERPRETER_MB + math.ceil(numbers * 8 / 2**20)


def on_threads(seconds: float, efficiency: float, threads: int) -> float:
    """Seconds on several threads, from the seconds on one."""
    return seconds / (1.0 + efficiency * (threads - 1))
