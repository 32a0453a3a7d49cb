"""What an evaluation of Q costs by each method that has an operator (`granstudy.collision.choice.cost`)."""

import math
from functools import cache, lru_cache

from granstudy.collision.carleman.scenes import product_count
from granstudy.collision.choice.cost import (
    SECONDS_PER_CALL,
    SETUP_SECONDS,
    MethodCost,
    TransformTimes,
)
from granstudy.collision.fast.adaptive.aliasing import resolving_grids
from granstudy.collision.fast.adaptive.search import RESOLVED
from granstudy.collision.fourier.spectra import serial_transforms
from granstudy.collision.radial.operator import tensor_name
from granstudy.collision.rules import directions, reduce_directions
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import circle_rule, sphere_rule
from granstudy.support.cache import is_kept
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.symmetry import Symmetry

SECONDS_PER_PAIR = 6.0e-9
"""Seconds of one pair of modes, by `direct`."""

SECONDS_PER_SHELL = 1.6e-4
"""Seconds of one length |k| of modes, by `direct`: modes of one length share their weights."""

SHELLS = {2: 0.14, 3: 0.62}
"""Lengths |k| over N², about, by dimension: sums of two squares are rarer than sums of three."""

NODES_PER_DIGIT2 = {2: 2.5, 3: 10.0}
"""Nodes ±g that a tolerance takes by `fast`, over the square of its digits log₁₀(1/rtol): a fit, by
dimension, to densities that their grid resolves, within a factor 2."""

ORBIT_POWER = 0.6
"""Power of a group's order that divides the number of nodes: many orbits are smaller than the group."""

TABLE_CELLS = 20.0
"""Cells of the table of `direct`, over the largest phase R|m−αk|."""

NUMBERS_PER_NODE = 8.0
"""Numbers that `fast` keeps of a node."""

SERIES_FACTOR = {2: 5.5, 3: 5.0}
"""Time of `fast` with a restitution law, over its time at constant e, by dimension."""

SINGLE_FACTOR = 0.75
"""Time of `fast` in single precision, over its time in double: 0.6 at N = 64, 0.8 at N = 32 in 3D."""

SECONDS_PER_SERIES = 8.5e-4
"""Seconds of the series of one shell and one |k|, which `fast` needs for a restitution law."""

WHOLE_TRANSFORMS = 6
"""Transforms on the grid of f, and passes that take as long, where products are on a smaller one."""

PLANNED_N = {2: 30, 3: 32}
"""Points a dimension of the products of densities that `NODES_PER_DIGIT2` fits; a density that needs more
points needs more nodes, as many more as points."""

PLANNING_EVALUATIONS = 25
"""Time of choosing a quadrature for a tolerance, in evaluations with that quadrature."""

PLANNING_SECONDS, PLANNING_SECONDS_PER_POINT = 0.08, 4.0e-7
"""Further seconds of it: whatever the density; for each point of the products and each squared digit."""

LARGEST_LOOK = 2**21
"""Most points of a grid on which a density is looked at for an estimate."""

PLANNED_SHELLS = 36
"""Shells of all operators that choosing a quadrature makes; each has its series for a restitution law."""

PLANNING_MEMORY = 150
"""Numbers for each grid point that choosing a quadrature keeps: the parts of all shells, rule by rule."""

SECONDS_PER_WEIGHT, SECONDS_PER_INTERPOLATION = 2.4e-7, 1.35e-9
"""Seconds of the tensor of `radial`: of one value of its tables, and of each of N⁴ interpolated ones."""

SECONDS_PER_TERM = 2.0e-10
"""Seconds of one of the N³ terms in the bilinear form of `radial`."""

SECONDS_PER_RADIAL_CALL = 1.0e-5
"""Seconds of one evaluation by `radial`, whatever its size: nothing is handed to threads."""

SECONDS_PER_FILTER = 1.0e-7
"""Seconds of one number of the filters that `carleman` stores."""

SECONDS_PER_SPLIT = 0.013
"""Seconds of splitting a weight into several products for `carleman`, over N."""


def _grid_points(scene: Scene, solver: SizedSolver) -> int:
    """Points of the grid that products are formed on."""
    return solver.product_points**scene.dim


# literal: every node of the rule


def _literal_nodes(scene: Scene, solver: SizedSolver) -> int:
    """All nodes of the rule."""
    assert solver.N_rho is not None
    return solver.N_rho * len(directions(scene, solver))


def _literal_numbers(scene: Scene, solver: SizedSolver, transforms: int) -> float:
    assert solver.N_rho is not None
    nodes, points = _literal_nodes(scene, solver), _grid_points(scene, solver)
    phases = 4.0 * nodes * scene.dim * solver.N  # of the shifts and of the gain
    weights = 2.0 * nodes * points if callable(scene.restitution) else phases
    return (40.0 + solver.N_rho) * points + phases + weights


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


def _direct_numbers(scene: Scene, solver: SizedSolver, transforms: int) -> float:
    """The spectra, and a table of the weight over magnitudes and radii; for a law over degrees as well."""
    phase = math.pi * math.sqrt(scene.dim) * solver.N * solver.R / solver.grid(scene.dim).L
    radii = solver.N_rho or 32 + 0.6 * phase
    table = 6.0 * TABLE_CELLS * phase * radii
    if callable(scene.restitution):
        table = SHELLS[scene.dim] * solver.N**2 * radii * (40.0 + phase / 2)
    return 40.0 * _grid_points(scene, solver) + table


DIRECT = MethodCost(
    nodes=lambda scene, solver: 0,
    transforms=lambda scene, solver: 2,
    seconds=_direct_seconds,
    setup=lambda scene, solver, each: SETUP_SECONDS,
    numbers=_direct_numbers,
    efficiency=0.9,
)

# fast: one node of each orbit, or what a tolerance takes


def _fast_nodes(scene: Scene, solver: SizedSolver) -> int:
    """Nodes of all shells, one of each orbit; for a tolerance, by the fit `NODES_PER_DIGIT2`."""
    if solver.rtol is None:
        assert solver.N_rho is not None
        return solver.N_rho * _reduced_count(scene, solver)
    pairs = NODES_PER_DIGIT2[scene.dim] * math.log10(1.0 / solver.rtol) ** 2
    pairs *= max(1.0, _fast_points(scene, solver) / PLANNED_N[scene.dim]) ** scene.dim
    return math.ceil(pairs / len(scene.symmetry) ** ORBIT_POWER)


def _fast_points(scene: Scene, solver: SizedSolver) -> int:
    """Points of the products; for a tolerance, those of the smallest grid that resolves the density."""
    if solver.rtol is None or solver.dealias or solver.N**scene.dim > LARGEST_LOOK:
        return solver.product_points
    try:
        return _resolving(scene, solver.N, solver.R, solver.rtol)
    except (TypeError, ValueError):  # densities that cannot be compared are not remembered
        return _resolving.__wrapped__(scene, solver.N, solver.R, solver.rtol)


@lru_cache(maxsize=1000)
def _resolving(scene: Scene, N: int, R: float, rtol: float) -> int:
    grid = VelocityGrid(scene.dim, N, R)
    n, _ = next(resolving_grids(grid, scene.density(grid), RESOLVED * rtol))
    return n


def _reduced_count(scene: Scene, solver: SizedSolver) -> int:
    """Directions that `fast` evaluates: one of each orbit under the scene's symmetry."""
    if scene.dim == 2:
        return _reduced_circle(solver.M_cir, scene.symmetry)
    size = tuple(solver.M_sph) if isinstance(solver.M_sph, list) else solver.M_sph
    return _reduced_sphere(size, solver.sphere_rule, solver.sphere_rule_sha256, scene.symmetry)


@cache
def _reduced_circle(M_cir: int, group: Symmetry) -> int:
    return len(reduce_directions(circle_rule(M_cir), group)[1])


@cache
def _reduced_sphere(
    M_sph: int | tuple[int, int], name: str, content: str | None, group: Symmetry
) -> int:
    """The count for a rule; ``content`` tells files of one name apart."""
    return len(reduce_directions(sphere_rule(M_sph, name), group)[1])


def _fast_seconds(scene: Scene, solver: SizedSolver, transforms: int, n: int) -> float:
    times = TransformTimes(1.5e-10, 5.0e-7)
    seconds = times.seconds(scene, solver, transforms, n)
    if n < solver.N:  # f and Q are on the whole grid
        seconds += times.seconds(scene, solver, WHOLE_TRANSFORMS, solver.N)
    factor = SERIES_FACTOR[scene.dim] if callable(scene.restitution) else 1.0
    factor *= SINGLE_FACTOR if solver.precision == "single" else 1.0
    return SECONDS_PER_CALL + factor * (seconds - SECONDS_PER_CALL)


def _fast_setup(scene: Scene, solver: SizedSolver, each: float) -> float:
    shells = solver.N_rho or 0
    seconds = SETUP_SECONDS
    if solver.rtol is not None:
        n = _fast_points(scene, solver)
        whole = _fast_seconds(scene, solver, FAST.transforms(scene, solver), solver.N)
        seconds += PLANNING_EVALUATIONS * each + (2.0 * whole if n < solver.N else 0.0)
        digits = math.log10(1.0 / solver.rtol)
        seconds += PLANNING_SECONDS + PLANNING_SECONDS_PER_POINT * digits**2 * n**scene.dim
        shells = PLANNED_SHELLS
    if not callable(scene.restitution):
        return seconds
    return seconds + shells * SHELLS[scene.dim] * solver.N**2 * SECONDS_PER_SERIES


def _fast_numbers(scene: Scene, solver: SizedSolver, transforms: int) -> float:
    points = _grid_points(scene, solver)
    numbers = 40.0 * points + NUMBERS_PER_NODE * _fast_nodes(scene, solver)
    if solver.rtol is not None:
        return numbers + PLANNING_MEMORY * _fast_points(scene, solver) ** scene.dim
    if callable(scene.restitution):
        assert solver.N_rho is not None
        phase = math.pi * math.sqrt(scene.dim) / 2 * solver.N * solver.R / solver.grid(scene.dim).L
        numbers += 3.0 * solver.N_rho * SHELLS[scene.dim] * solver.N**2 * (12.0 + 0.3 * phase)
    return numbers


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
    points=_fast_points,
)

# radial: a bilinear form, its tensor computed once


def _tensor(scene: Scene, solver: SizedSolver) -> tuple[tuple[str, float], ...]:
    """The tensor where none is in the cache: tables for N²/2 pairs of modes at about 24 + N values each."""
    if callable(scene.restitution):
        return ()  # `radial` refuses it
    name = tensor_name(scene.dim, solver.N, float(scene.kernel.exponent), float(scene.restitution))
    if is_kept(name):
        return ()
    tables = solver.N**2 / 2 * (24 + solver.N)
    seconds = tables * SECONDS_PER_WEIGHT + solver.N**4 * SECONDS_PER_INTERPOLATION
    return ((name, seconds),)


RADIAL = MethodCost(
    nodes=lambda scene, solver: 0,
    transforms=lambda scene, solver: 0,
    seconds=lambda scene, solver, transforms, n: (
        SECONDS_PER_RADIAL_CALL + solver.N**3 * SECONDS_PER_TERM
    ),
    setup=lambda scene, solver, each: SETUP_SECONDS,
    numbers=lambda scene, solver, transforms: 20 * solver.N**3,
    efficiency=0.0,
    kept=_tensor,
)

# carleman: products of filtered densities, two transforms for each product of a pair of directions


def _carleman_nodes(scene: Scene, solver: SizedSolver) -> int:
    """Products of all pairs of directions; in 2D at e = 1, one of each four directions is enough."""
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
    # one filter for each transform, on the ball of modes
    numbers=lambda scene, solver, transforms: (
        (40.0 + 0.3 * transforms) * _grid_points(scene, solver)
    ),
    efficiency=0.7,  # not measured: transforms are like those of fast
    exact=lambda solver: False,
)
