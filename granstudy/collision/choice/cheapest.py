"""The cheapest method that can do a scene, for ``method="auto"``.

Candidates are compared at equal error, so that the cheapest is no worse than `fast` with the settings given:

============  ====================================================================================
`radial`      taken wherever it can do the scene; N Cartesian points become N/1.7 speeds
              (docs/method.md §7). Densities live on a `RadialGrid`, as the dataset says
`carleman`    with more directions where its loss is in closed form (`DIRECTIONS_TOO_MANY`); not with a
              tolerance, for which only `fast` chooses directions
`direct`      without angular error; the cheapest on very small grids
============  ====================================================================================
"""

import math
from dataclasses import replace

from granstudy.collision.carleman import scenes as carleman_scenes
from granstudy.collision.choice.cost import estimate
from granstudy.collision.choice.method_costs import CARLEMAN, DIRECT, FAST
from granstudy.model.isotropy import check_isotropic
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature.sphere import sphere_sizes

CARTESIAN_PER_RADIAL = 1.7
"""Cartesian points a dimension that resolve what one radial node does (`granstudy.RadialGrid`)."""

DIRECTIONS_TOO_MANY = {2: 1.25, 3: 2.0}
"""Directions of `carleman`, variant ``separate``, over directions of `fast` at equal error, by dimension.

Measured at e = 1 and 0.9 on densities without symmetry, with 12 to 48 directions in 3D (1.5 to 2.7) and 16 to
40 in 2D."""

SIZED_RULES = ("design", "lebedev", "product")
"""Sphere rules that come in several sizes."""

WORTH_IT = 1.2
"""Factor by which another method must be cheaper than `fast` to be chosen: estimates are rough."""


def choose_method(scene: Scene, solver: SizedSolver) -> tuple[SizedSolver, str]:
    """The solver with the method for a scene, and why, in a line."""
    plain = replace(solver, dealias=False, precision="double")  # only fast has other values
    fast = replace(solver, method="fast")
    if solver.device == "gpu":
        return fast, "fast: the one method that runs on a GPU"
    obstacle = _obstacle_to_radial(scene, solver.R)
    if not obstacle:
        N = radial_nodes(solver.N)
        why = f"isotropic density, constant e: {N} speeds resolve what N={solver.N} does"
        return replace(plain, method="radial", N=N), f"radial: {why}"
    if solver.rtol is not None:
        return fast, f"fast: {obstacle}, and no other method chooses directions for a tolerance"
    chosen, shown = _cheapest(scene, fast, plain)
    return chosen, f"{chosen.method}: {obstacle}; an evaluation on one thread: {shown}"


def radial_nodes(N: int) -> int:
    """Radial nodes that resolve what N Cartesian points a dimension do."""
    return max(4, math.ceil(N / CARTESIAN_PER_RADIAL))


def _obstacle_to_radial(scene: Scene, R: float) -> str:
    """Why `radial` cannot do the scene, in a few words; "" where it can."""
    if callable(scene.restitution):
        return "restitution depends on the impact speed"
    try:
        check_isotropic(scene, R)
    except ValueError:
        return "the density is not isotropic"
    return ""


def _cheapest(scene: Scene, fast: SizedSolver, plain: SizedSolver) -> tuple[SizedSolver, str]:
    """The cheapest Cartesian method, `fast` unless another is `WORTH_IT`; and the times compared."""
    candidates = [
        (FAST, fast),
        (DIRECT, replace(plain, method="direct")),
        (CARLEMAN, _carleman(scene, plain)),
    ]
    timed = [
        (estimate(cost, scene, other, 1).each, other)
        for cost, other in candidates
        if other is not None
    ]
    timed.sort(key=lambda pair: pair[0])
    allowed = next(seconds for seconds, other in timed if other is fast) / WORTH_IT
    chosen = timed[0][1] if timed[0][0] <= allowed else fast
    return chosen, ", ".join(f"{other.method} {1e3 * seconds:.2g} ms" for seconds, other in timed)


def _carleman(scene: Scene, solver: SizedSolver) -> SizedSolver | None:
    """The solver with `carleman` at the error of `fast`; None where scene or rule exclude it."""
    try:
        carleman_scenes.check_scene(scene)
    except ValueError:
        return None
    many = 1.0 if solver.variant == "full" else DIRECTIONS_TOO_MANY[scene.dim]
    if scene.dim == 2:
        # A multiple of four: at e = 1, one of each four directions is then enough.
        return replace(solver, method="carleman", M_cir=4 * math.ceil(many * solver.M_cir / 4))
    if many == 1.0:
        return replace(solver, method="carleman")
    if not isinstance(solver.M_sph, int) or solver.sphere_rule not in SIZED_RULES:
        return None
    larger = [M for M in sphere_sizes(solver.sphere_rule) if many * solver.M_sph <= M]
    return replace(solver, method="carleman", M_sph=larger[0]) if larger else None
