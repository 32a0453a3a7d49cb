"""What a run will cost, before it starts: seconds and memory."""

import math
from dataclasses import dataclass

from granstudy.collision.carleman_scenes import product_count
from granstudy.collision.rules import directions
from granstudy.scene import Scene
from granstudy.solver import Solver

SECONDS_PER_POINT = {"literal": 8.5e-10, "fast": 2.0e-10, "carleman": 1.9e-10}
"""Of one transform of n points with the loops around it, per n·log2 n, on one core of a 2021 server."""

SECONDS_PER_TRANSFORM = {"literal": 1.0e-6, "fast": 1.5e-6, "carleman": 1.5e-6}
"""Of one transform whatever its size, the calls themselves."""

SECONDS_PER_PAIR = 6.0e-9
"""Of one pair of modes in the direct method."""

SECONDS_PER_WEIGHT = 1.8e-7
"""Of one node of the integrals in the radial method's tensor."""

SECONDS_PER_TERM = 2.0e-10
"""Of one of the N³ terms of the radial method's bilinear form."""

SECONDS_PER_CALL = 1.0e-4
"""Of one evaluation by the radial method whatever its size, with its share of a step's moments and checks."""

NODES_PER_DIGIT2 = {2: 2.5, 3: 10.0}
"""Nodes ±g that a tolerance comes to, over the square of its digits log₁₀(1/rtol): a fit to densities that
their grid resolves, within a factor 2."""

PLANNING_MEMORY = 150
"""Numbers a grid point that choosing a quadrature takes: the parts of all shells, rule by rule."""

ORBIT_POWER = 0.6
"""A symmetry group saves this power of its order: many orbits are smaller than the group."""

PLANNING_EVALUATIONS = 12
"""What choosing a quadrature costs, in evaluations with it."""

INTERPRETER_MB = 300
"""Python with NumPy, SciPy, Numba and xarray loaded."""


@dataclass(frozen=True)
class Cost:
    """Estimate for one run on one thread."""

    seconds: float
    memory_mb: int


def estimate(scene: Scene, solver: Solver, evaluations: int) -> Cost:
    """Cost of so many evaluations of Q."""
    if solver.method == "radial":
        # N²/2 pairs of modes, about 24 + N angles, 24 + 4N/3 shells; nothing where it is in the cache.
        nodes = solver.N**2 / 2 * (24 + solver.N) * (24 + 4 * solver.N / 3)
        tensor = nodes * SECONDS_PER_WEIGHT
        each = SECONDS_PER_CALL + solver.N**3 * SECONDS_PER_TERM
        memory = 20 * solver.N**3
        return Cost(tensor + evaluations * each, INTERPRETER_MB + _megabytes(memory))
    n = solver.N**scene.dim
    if solver.method == "direct":
        return Cost(evaluations * n**2 * SECONDS_PER_PAIR, INTERPRETER_MB + _megabytes(40 * n))
    if solver.method == "carleman":
        return _carleman(scene, solver, evaluations)
    if solver.rtol is not None:
        transforms = 2 * planned_nodes(scene, solver.rtol)
        evaluations += PLANNING_EVALUATIONS
        stored = PLANNING_MEMORY
    else:
        assert solver.N_rho is not None
        nodes = solver.N_rho * len(directions(scene, solver))
        transforms = 2 * nodes if solver.method == "literal" else nodes
        stored = solver.N_rho if solver.method == "literal" else 0
    seconds = evaluations * transforms * _seconds_per_transform(solver.method, n)
    return Cost(seconds, INTERPRETER_MB + _megabytes((40 + stored) * n))


def planned_nodes(scene: Scene, rtol: float) -> int:
    """Nodes that a tolerance is expected to come to; the plan itself is made when the run starts."""
    pairs = NODES_PER_DIGIT2[scene.dim] * math.log10(1.0 / rtol) ** 2
    return math.ceil(pairs / len(scene.symmetry) ** ORBIT_POWER)


def _carleman(scene: Scene, solver: Solver, evaluations: int) -> Cost:
    """Two transforms a product and pair of directions; a filter each on the ball of modes is stored."""
    n = solver.N**scene.dim
    transforms = len(directions(scene, solver)) * product_count(scene, solver.grid(scene.dim))
    seconds = evaluations * transforms * _seconds_per_transform(solver.method, n)
    return Cost(seconds, INTERPRETER_MB + _megabytes(40 * n + 0.3 * n * transforms))


def _seconds_per_transform(method: str, n: int) -> float:
    """Seconds of one transform of n points, with its share of the loops around it."""
    return SECONDS_PER_TRANSFORM[method] + SECONDS_PER_POINT[method] * n * math.log2(n)


def _megabytes(numbers: float) -> int:
    """Megabytes of so many double-precision numbers."""
    return math.ceil(numbers * 8 / 2**20)
