"""Estimates of what an evaluation of Q and its set-up cost, before they start: seconds and memory.

All constants are medians on one core of a 2021 server; another machine is faster or slower by one factor.
Estimates are quick, as a workflow waits for them before it starts.

Measured on two quiet cores, over methods, N, dimensions, precisions, tolerances, 1 and 2 threads: in 59 of 64
cases `granstudy.plan` was within a factor 2 of the seconds of an evaluation. Four of the other five (padded
products; a restitution law in 2D) led to the constants of today. The fifth is `direct` in 2D on two threads.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

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
        Seconds before the first evaluation of Q.
    each : float
        Seconds of an evaluation.
    evaluations : int
    memory_mb : int
    """

    setup: float
    each: float
    evaluations: int
    memory_mb: int

    @property
    def seconds(self) -> float:
        """Seconds of the set-up and of all evaluations."""
        return self.setup + self.evaluations * self.each


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
    """

    nodes: Callable[[Scene, SizedSolver], int]
    transforms: Callable[[Scene, SizedSolver], int]
    seconds: Callable[[Scene, SizedSolver, int, int], float]
    setup: Callable[[Scene, SizedSolver, float], float]
    numbers: Callable[[Scene, SizedSolver, int], float]
    efficiency: float
    exact: Callable[[SizedSolver], bool] = lambda solver: True


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
            slower *= 1.0 if n in EVEN_SIZES or n.bit_count() == 1 else UNEVEN
        each = self.each + self.point * slower * points * math.log2(points)
        return SECONDS_PER_CALL + transforms * each


def estimate(cost: MethodCost, scene: Scene, solver: SizedSolver, evaluations: int) -> Cost:
    """Cost of a number of evaluations of Q by the solver's method, whose row is ``cost``."""
    transforms = cost.transforms(scene, solver)
    each = cost.seconds(scene, solver, transforms, solver.product_points)
    memory = memory_mb(cost.numbers(scene, solver, transforms))
    return Cost(cost.setup(scene, solver, each), each, evaluations, memory)


def memory_mb(numbers: float) -> int:
    """Megabytes of a process that keeps so many double-precision numbers."""
    return INTERPRETER_MB + math.ceil(numbers * 8 / 2**20)


def on_threads(seconds: float, efficiency: float, threads: int) -> float:
    """Seconds on several threads, from the seconds on one."""
    return seconds / (1.0 + efficiency * (threads - 1))
