"""What an evaluation of Q and its set-up cost by each method, before it starts: seconds and memory.

Measured: `granstudy.plan` was within a factor 2 of what an evaluation took in 59 of 64 cases on two quiet
cores: methods, N, dimensions, precisions, tolerances, 1 and 2 threads. Four of the others, padded
products and e of the impact speed in 2D, led to the constants that are here now; the fifth was
`direct` in 2D on two threads.

All constants are medians on one core of a 2021 server; a machine's own speed is a factor on all of them.
Estimates take no longer than a workflow can wait for before it starts.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from granstudy.collision.carleman.scenes import product_count
from granstudy.collision.fourier.spectra import serial_transforms
from granstudy.collision.rules import directions, reduce_directions
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import circle_rule, sphere_rule
from granstudy.velocity.symmetry import Symmetry

CACHED_POINTS = 2**16
"""Most points of a real transform that a core's cache holds."""

OUT_OF_CACHE = 1.4
"""Time of a point in a larger transform over its time in a cached one."""

EVEN_SIZES = (12, 20)
UNEVEN = 2.2
"""Time of a point in real transforms of other sizes than `EVEN_SIZES` and powers of two over its time there:
FFTW's estimated plans of 24 points a dimension take longer than those of 32."""

SERIES_FACTOR = {2: 5.5, 3: 5.0}
"""Time of `fast` where e depends on the impact speed, over its time at constant e, by dimension."""

SINGLE_FACTOR = 0.75
"""Time of `fast` in single precision over that in double: 0.6 at N = 64, 0.8 at N = 32 in 3D."""

SECONDS_PER_PAIR = 6.0e-9
"""One pair of modes in the direct method."""

SECONDS_PER_SHELL = 1.6e-4
"""One length |k| of modes in the direct method, which share their weights."""

SHELLS = {2: 0.14, 3: 0.62}
"""Lengths |k| over N², about: sums of two squares are rarer than sums of three."""

SECONDS_PER_WEIGHT = 1.8e-7
"""One node of the integrals in the radial method's tensor."""

SECONDS_PER_TERM = 2.0e-10
"""One of the N³ terms of the radial method's bilinear form."""

SECONDS_PER_CALL = 1.0e-4
"""One evaluation whatever its size: checks, and handing the shares to threads."""

SECONDS_PER_RADIAL_CALL = 1.0e-5
"""One evaluation by `radial`, which hands out nothing."""

NODES_PER_DIGIT2 = {2: 2.5, 3: 10.0}
"""Nodes ±g that a tolerance takes, over the square of its digits log₁₀(1/rtol): a fit to densities that
their grid resolves, within a factor 2."""

PLANNING_MEMORY = 150
"""Numbers a grid point that choosing a quadrature takes: the parts of all shells, rule by rule."""

ORBIT_POWER = 0.6
"""Power of its order that a symmetry group saves: many orbits are smaller than the group."""

PLANNING_EVALUATIONS = 40
"""Time of choosing a quadrature, in evaluations with it."""

SETUP_SECONDS = 0.02
"""Any set-up: rules, weights, plans of transforms."""

SECONDS_PER_FILTER = 1.0e-7
"""One number of the filters that `carleman` stores."""

SECONDS_PER_SPLIT = 0.013
"""Splitting a weight into several products for `carleman`, over N."""

SECONDS_PER_SERIES = 8.5e-4
"""The series of one shell and one |k| for `fast` where e depends on the impact speed."""

INTERPRETER_MB = 300
"""Python with NumPy, SciPy, Numba and xarray loaded."""


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
        """Seconds of the set-up and all evaluations."""
        return self.setup + self.evaluations * self.each


@dataclass(frozen=True)
class MethodCost:
    """How to estimate an evaluation of Q by one method.

    Attributes
    ----------
    nodes, transforms : callable
        (scene, solver) ↦ nodes of the sum and Fourier transforms of an evaluation.
    seconds : callable
        (scene, solver, transforms, n) ↦ seconds of an evaluation on one thread that makes so many
        transforms of n points a dimension.
    setup : callable
        (scene, solver, seconds of an evaluation) ↦ seconds before the first one.
    numbers : callable
        (scene, solver, transforms) ↦ double-precision numbers kept in memory.
    efficiency : float
        What each thread after the first adds, in parts of the first: Table 5 of the study `paper`, N = 16 to
        64, on two cores.
    exact : callable
        solver ↦ whether nodes and transforms are exact before the operator is made.
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
    """Seconds of a transform: per n·log₂ n of its points, with the loops around it, and whatever its size."""

    point: float
    each: float
    real: bool = True

    def seconds(self, scene: Scene, solver: SizedSolver, transforms: int, n: int) -> float:
        """Seconds of an evaluation that makes so many transforms of n points a dimension."""
        points = n**scene.dim
        slower = 1.0
        if self.real:
            slower *= OUT_OF_CACHE if points > CACHED_POINTS else 1.0
            slower *= 1.0 if n in EVEN_SIZES or n.bit_count() == 1 else UNEVEN
        each = self.each + self.point * slower * points * math.log2(points)
        return SECONDS_PER_CALL + transforms * each


def estimate(cost: MethodCost, scene: Scene, solver: SizedSolver, evaluations: int) -> Cost:
    """Cost of so many evaluations of Q by the solver's method."""
    transforms = cost.transforms(scene, solver)
    each = cost.seconds(scene, solver, transforms, solver.product_points)
    memory = memory_mb(cost.numbers(scene, solver, transforms))
    return Cost(cost.setup(scene, solver, each), each, evaluations, memory)


def memory_mb(numbers: float) -> int:
    """Megabytes of a process that keeps so many double-precision numbers."""
    return INTERPRETER_MB + math.ceil(numbers * 8 / 2**20)


def on_threads(seconds: float, efficiency: float, threads: int) -> float:
    """What seconds on one thread become on so many."""
    return seconds / (1.0 + efficiency * (threads - 1))


def _grid_points(scene: Scene, solver: SizedSolver) -> int:
    return solver.product_points**scene.dim


# literal: every node of the rule


def _literal_nodes(scene: Scene, solver: SizedSolver) -> int:
    assert solver.N_rho is not None
    return solver.N_rho * len(directions(scene, solver))


def _literal_numbers(scene: Scene, solver: SizedSolver, transforms: int) -> float:
    assert solver.N_rho is not None
    return (40.0 + solver.N_rho) * _grid_points(scene, solver)


LITERAL = MethodCost(
    nodes=_literal_nodes,
    transforms=lambda scene, solver: (
        2 * _literal_nodes(scene, solver) + (2 if solver.variant == "full" else 3)
    ),
    seconds=TransformTimes(8.5e-10, 1.0e-6, real=False).seconds,
    setup=lambda scene, solver, each: SETUP_SECONDS,
    numbers=_literal_numbers,
    efficiency=0.7,
)

# direct: all pairs of modes


def _direct_seconds(scene: Scene, solver: SizedSolver, transforms: int, n: int) -> float:
    shells = SHELLS[scene.dim] * solver.N**2
    pairs = (n**scene.dim) ** 2
    return SECONDS_PER_CALL + shells * SECONDS_PER_SHELL + pairs * SECONDS_PER_PAIR


DIRECT = MethodCost(
    nodes=lambda scene, solver: 0,
    transforms=lambda scene, solver: 2,
    seconds=_direct_seconds,
    setup=lambda scene, solver, each: SETUP_SECONDS,
    numbers=lambda scene, solver, transforms: 40.0 * _grid_points(scene, solver),
    efficiency=0.9,
)

# fast: one node of each orbit, or what a tolerance takes


def _fast_nodes(scene: Scene, solver: SizedSolver) -> int:
    if solver.rtol is None:
        assert solver.N_rho is not None
        return solver.N_rho * _reduced_count(scene, solver)
    pairs = NODES_PER_DIGIT2[scene.dim] * math.log10(1.0 / solver.rtol) ** 2
    return math.ceil(pairs / len(scene.symmetry) ** ORBIT_POWER)


def _reduced_count(scene: Scene, solver: SizedSolver) -> int:
    """Directions that `fast` evaluates: one of each orbit of the scene's symmetry."""
    if scene.dim == 2:
        return _reduced_circle(solver.M_cir, scene.symmetry)
    size = tuple(solver.M_sph) if isinstance(solver.M_sph, list) else solver.M_sph
    return _reduced_sphere(size, solver.sphere_rule, scene.symmetry)


@cache
def _reduced_circle(M_cir: int, group: Symmetry) -> int:
    return len(reduce_directions(circle_rule(M_cir), group)[1])


@cache
def _reduced_sphere(M_sph: int | tuple[int, int], name: str, group: Symmetry) -> int:
    return len(reduce_directions(sphere_rule(M_sph, name), group)[1])


def _fast_seconds(scene: Scene, solver: SizedSolver, transforms: int, n: int) -> float:
    seconds = TransformTimes(1.5e-10, 5.0e-7).seconds(scene, solver, transforms, n)
    factor = SERIES_FACTOR[scene.dim] if callable(scene.restitution) else 1.0
    factor *= SINGLE_FACTOR if solver.precision == "single" else 1.0
    return SECONDS_PER_CALL + factor * (seconds - SECONDS_PER_CALL)


def _fast_setup(scene: Scene, solver: SizedSolver, each: float) -> float:
    if solver.rtol is not None:
        return SETUP_SECONDS + PLANNING_EVALUATIONS * each
    if not callable(scene.restitution):
        return SETUP_SECONDS
    assert solver.N_rho is not None
    return SETUP_SECONDS + solver.N_rho * SHELLS[scene.dim] * solver.N**2 * SECONDS_PER_SERIES


def _fast_numbers(scene: Scene, solver: SizedSolver, transforms: int) -> float:
    planning = 0.0 if solver.rtol is None else PLANNING_MEMORY
    return (40.0 + planning) * _grid_points(scene, solver)


FAST = MethodCost(
    nodes=_fast_nodes,
    transforms=lambda scene, solver: (
        2 * _fast_nodes(scene, solver) + serial_transforms(solver.N, solver.product_points)
    ),
    seconds=_fast_seconds,
    setup=_fast_setup,
    numbers=_fast_numbers,
    efficiency=0.7,
    exact=lambda solver: solver.rtol is None,
)

# radial: a bilinear form, its tensor computed once


def _radial_setup(scene: Scene, solver: SizedSolver, each: float) -> float:
    """N²/2 pairs of modes, about 24 + N angles, 24 + 4N/3 shells; nothing where it is in the cache."""
    nodes = solver.N**2 / 2 * (24 + solver.N) * (24 + 4 * solver.N / 3)
    return SETUP_SECONDS + nodes * SECONDS_PER_WEIGHT


RADIAL = MethodCost(
    nodes=lambda scene, solver: 0,
    transforms=lambda scene, solver: 0,
    seconds=lambda scene, solver, transforms, n: (
        SECONDS_PER_RADIAL_CALL + solver.N**3 * SECONDS_PER_TERM
    ),
    setup=_radial_setup,
    numbers=lambda scene, solver, transforms: 20 * solver.N**3,
    efficiency=0.0,
)

# carleman: products of filtered densities, two transforms a product and pair of directions


def _carleman_nodes(scene: Scene, solver: SizedSolver) -> int:
    pairs = len(directions(scene, solver)) // 2
    if scene.dim == 2 and scene.restitution == 1.0 and solver.M_cir % 4 == 0:
        pairs //= 2
    return pairs * product_count(scene, solver.grid(scene.dim))


def _carleman_setup(scene: Scene, solver: SizedSolver, each: float) -> float:
    entries = 0.3 * solver.N**scene.dim * CARLEMAN.transforms(scene, solver)
    several = product_count(scene, solver.grid(scene.dim)) > 1
    return entries * SECONDS_PER_FILTER + several * solver.N * SECONDS_PER_SPLIT


CARLEMAN = MethodCost(
    nodes=_carleman_nodes,
    transforms=lambda scene, solver: 2 * _carleman_nodes(scene, solver) + 2,
    seconds=TransformTimes(1.8e-10, 5.0e-7).seconds,
    setup=_carleman_setup,
    # a filter a transform, on the ball of modes
    numbers=lambda scene, solver, transforms: (
        (40.0 + 0.3 * transforms) * _grid_points(scene, solver)
    ),
    # its transforms are like those of fast
    efficiency=0.7,
    exact=lambda solver: False,
)
