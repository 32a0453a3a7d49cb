"""What a run will cost, before it starts: seconds and memory.

`granstudy.plan` was within a factor 2 of what an evaluation took in 59 of 64 cases on two quiet
cores: methods, N, dimensions, precisions, tolerances, 1 and 2 threads. Four of the others, padded
products and e of the impact speed in 2D, led to the constants that are here now; the fifth was
`direct` in 2D on two threads.

The constants are medians on one machine, and a machine's own speed is a factor on
all of them. Estimates take no longer than a workflow can wait for before it starts; `granstudy.plan`
counts transforms exactly.
"""

import math
from dataclasses import dataclass
from functools import cache

from granstudy.collision.carleman.scenes import product_count
from granstudy.collision.fourier.spectra import serial_transforms
from granstudy.collision.rules import directions, reduce_directions
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.quadrature import circle_rule, sphere_rule
from granstudy.velocity.symmetry import Symmetry

SECONDS_PER_POINT = {"literal": 8.5e-10, "fast": 1.5e-10, "carleman": 1.8e-10}
"""Of one transform of n points with the loops around it, per n·log2 n, on one core of a 2021 server."""

SECONDS_PER_TRANSFORM = {"literal": 1.0e-6, "fast": 5.0e-7, "carleman": 5.0e-7}
"""Of one transform whatever its size, the calls themselves."""

CACHED_POINTS = 2**16
OUT_OF_CACHE = 1.4
"""How much longer a point takes in real transforms of more points than a core's cache holds."""

FAST_SIZES = (12, 20)
UNEVEN = 2.2
"""How much longer a point takes in real transforms of other sizes than these and powers of two: FFTW's
estimated plans of 24 points a dimension take longer than those of 32."""

SERIES_FACTOR = {2: 5.5, 3: 5.0}
"""How much longer `fast` takes where e depends on the impact speed."""

SINGLE_FACTOR = 0.75
"""How much of the time `fast` takes in single precision: 0.6 at N = 64, 0.8 at N = 32 in 3D."""

SECONDS_PER_PAIR = 6.0e-9
"""Of one pair of modes in the direct method."""

SECONDS_PER_SHELL = 1.6e-4
"""Of one length |k| of modes in the direct method, which shares its weights."""

SHELLS = {2: 0.14, 3: 0.62}
"""About how many lengths |k| there are, over N²: sums of two squares are rarer than those of three."""

SECONDS_PER_WEIGHT = 1.8e-7
"""Of one node of the integrals in the radial method's tensor."""

SECONDS_PER_TERM = 2.0e-10
"""Of one of the N³ terms of the radial method's bilinear form."""

SECONDS_PER_CALL = {
    "literal": 1.0e-4, "direct": 1.0e-4, "fast": 1.0e-4, "radial": 1.0e-5, "carleman": 1.0e-4
}  # fmt: skip
"""Of one evaluation whatever its size: checks, and handing the shares to threads."""


NODES_PER_DIGIT2 = {2: 2.5, 3: 10.0}
"""Nodes ±g that a tolerance comes to, over the square of its digits log₁₀(1/rtol): a fit to densities that
their grid resolves, within a factor 2."""

PLANNING_MEMORY = 150
"""Numbers a grid point that choosing a quadrature takes: the parts of all shells, rule by rule."""

ORBIT_POWER = 0.6
"""A symmetry group saves this power of its order: many orbits are smaller than the group."""

PLANNING_EVALUATIONS = 40
"""What choosing a quadrature costs, in evaluations with it."""

SETUP_SECONDS = 0.02
"""Of any set-up: rules, weights, plans of transforms."""

SECONDS_PER_FILTER = 1.0e-7
"""Of one number of the filters that `carleman` stores."""

SECONDS_PER_SPLIT = 0.013
"""Of splitting a weight into several products for `carleman`, over N."""

SECONDS_PER_SERIES = 8.5e-4
"""Of the series of one shell and one |k| for `fast` where e depends on the impact speed."""

EFFICIENCY = {
    "literal": 0.7,
    "direct": 0.9,
    "fast": 0.7,
    "radial": 0.0,
    "carleman": 0.7,
    "dsmc": 0.9,
}
"""What each thread after the first adds, in parts of the first: Table 5 of the study `paper`, N = 16 to 64,
on two cores; `carleman`, of transforms like those of `fast`, is taken to be like it. The batches of `dsmc`
share nothing but memory."""

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


def estimate(scene: Scene, solver: Solver, evaluations: int) -> Cost:
    """Cost of so many evaluations of Q by a solver that leaves nothing open."""
    transforms = transform_count(scene, solver)
    each = evaluation_seconds(scene, solver, transforms)
    setup = setup_seconds(scene, solver, each)
    return Cost(setup, each, evaluations, memory_mb(scene, solver, transforms))


def transform_count(scene: Scene, solver: Solver) -> int:
    """Transforms an evaluation makes: about as many by `carleman` and under a tolerance, else exactly."""
    beside = serial_transforms(solver.N, solver.product_points)
    if solver.method == "radial":
        return 0
    if solver.method == "direct":
        return 2
    if solver.rtol is not None:
        return 2 * planned_nodes(scene, solver.rtol) + beside
    if solver.method == "carleman":
        # Two a product and pair of directions.
        pairs = len(directions(scene, solver)) // 2
        if scene.dim == 2 and scene.restitution == 1.0 and solver.M_cir % 4 == 0:
            pairs //= 2
        return 2 * pairs * product_count(scene, solver.grid(scene.dim)) + 2
    assert solver.N_rho is not None
    if solver.method == "literal":
        full = solver.variant == "full"
        return 2 * solver.N_rho * len(directions(scene, solver)) + (2 if full else 3)
    return 2 * solver.N_rho * reduced_count(scene, solver) + beside


def reduced_count(scene: Scene, solver: Solver) -> int:
    """Directions that `fast` evaluates: one of each orbit of the scene's symmetry."""
    M = solver.M_cir if scene.dim == 2 else solver.M_sph
    size = tuple(M) if isinstance(M, (tuple, list)) else M
    return _reduced(scene.dim, size, solver.sphere_rule, scene.symmetry)


@cache
def _reduced(dim: int, size: int | tuple[int, ...], name: str, group: Symmetry) -> int:
    rule = circle_rule(size) if dim == 2 else sphere_rule(size, name)  # type: ignore[arg-type]
    return len(reduce_directions(rule, group)[1])


def planned_nodes(scene: Scene, rtol: float) -> int:
    """Nodes that a tolerance is expected to come to; the plan itself is made when the run starts."""
    pairs = NODES_PER_DIGIT2[scene.dim] * math.log10(1.0 / rtol) ** 2
    return math.ceil(pairs / len(scene.symmetry) ** ORBIT_POWER)


def evaluation_seconds(
    scene: Scene, solver: Solver, transforms: int, n: int | None = None
) -> float:
    """Seconds of one evaluation that makes so many transforms, of n points a dimension.

    By default those of the solver's products.
    """
    call = SECONDS_PER_CALL[solver.method]
    if solver.method == "radial":
        return call + solver.N**3 * SECONDS_PER_TERM
    n = solver.product_points if n is None else n
    points = n**scene.dim
    if solver.method == "direct":
        shells = SHELLS[scene.dim] * solver.N**2
        return call + shells * SECONDS_PER_SHELL + points**2 * SECONDS_PER_PAIR
    each = SECONDS_PER_TRANSFORM[solver.method]
    slower = 1.0
    if solver.method != "literal":
        slower *= OUT_OF_CACHE if points > CACHED_POINTS else 1.0
        slower *= 1.0 if n in FAST_SIZES or n.bit_count() == 1 else UNEVEN
    each += SECONDS_PER_POINT[solver.method] * slower * points * math.log2(points)
    if solver.method == "fast" and callable(scene.restitution):
        each *= SERIES_FACTOR[scene.dim]
    if solver.precision == "single":
        each *= SINGLE_FACTOR
    return call + transforms * each


def setup_seconds(scene: Scene, solver: Solver, each: float) -> float:
    """Seconds before the first evaluation."""
    if solver.method == "radial":
        # N²/2 pairs of modes, about 24 + N angles, 24 + 4N/3 shells; nothing where it is in the cache.
        nodes = solver.N**2 / 2 * (24 + solver.N) * (24 + 4 * solver.N / 3)
        return SETUP_SECONDS + nodes * SECONDS_PER_WEIGHT
    if solver.rtol is not None:
        return SETUP_SECONDS + PLANNING_EVALUATIONS * each
    if solver.method == "carleman":
        entries = 0.3 * solver.N**scene.dim * transform_count(scene, solver)
        several = product_count(scene, solver.grid(scene.dim)) > 1
        return entries * SECONDS_PER_FILTER + several * solver.N * SECONDS_PER_SPLIT
    if solver.method == "fast" and callable(scene.restitution):
        assert solver.N_rho is not None
        lengths = SHELLS[scene.dim] * solver.N**2
        return SETUP_SECONDS + solver.N_rho * lengths * SECONDS_PER_SERIES
    return SETUP_SECONDS


def on_threads(seconds: float, method: str, threads: int) -> float:
    """What seconds on one thread become on so many."""
    return seconds / (1.0 + EFFICIENCY[method] * (threads - 1))


def memory_mb(scene: Scene, solver: Solver, transforms: int) -> int:
    """Megabytes of the process: the interpreter, and what the method stores."""
    if solver.method == "radial":
        return INTERPRETER_MB + _megabytes(20 * solver.N**3)
    stored = 40.0
    if solver.rtol is not None:
        stored += PLANNING_MEMORY
    elif solver.method == "literal":
        assert solver.N_rho is not None
        stored += solver.N_rho
    elif solver.method == "carleman":  # a filter a transform, on the ball of modes
        stored += 0.3 * transforms
    return INTERPRETER_MB + _megabytes(stored * solver.product_points**scene.dim)


def _megabytes(numbers: float) -> int:
    """Megabytes of so many double-precision numbers."""
    return math.ceil(numbers * 8 / 2**20)
