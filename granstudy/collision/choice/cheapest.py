"""The cheapest method that can do a scene, as ``method="auto"`` chooses it.

The candidates are put on an equal footing, so that the cheapest one is no worse than `fast` with what was
asked for:

- `radial`, wherever it can do the scene: N Cartesian points become N/1.7 speeds (docs/method.md §7). Its
  densities live on a `RadialGrid`: no more is modelled than the scene needs, and a dataset says so.
- `carleman`, with more directions where its loss is the closed one (`DIRECTIONS_TOO_MANY`), and not under
  a tolerance, for which only `fast` chooses directions.
- `direct`, which has no angular error, on grids so small that it is the cheapest.
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
"""Cartesian points a dimension that one radial node stands for (`granstudy.RadialGrid`)."""

DIRECTIONS_TOO_MANY = {2: 1.25, 3: 2.0}
"""Directions that `carleman` takes over those of `fast`, variant ``separate``, at equal error: measured at
e = 1 and 0.9 on densities without symmetry, 12 to 48 directions in 3D (1.5 to 2.7) and 16 to 40 in 2D."""

SIZED_RULES = ("design", "lebedev", "product")
"""Sphere rules of which there are larger ones."""

WORTH_IT = 1.2
"""How many times cheaper than `fast` another method must be expected to be."""


def choose_method(scene: Scene, solver: SizedSolver) -> tuple[SizedSolver, str]:
    """The solver with a method for the scene, and why in a line."""
    plain = replace(solver, dealias=False, precision="double")  # which is all that the others know
    fast = replace(solver, method="fast")
    if solver.device == "gpu":
        return fast, "fast: the one method that runs on a GPU"
    if callable(scene.restitution):
        obstacle = "restitution depends on the impact speed"
    else:
        try:
            check_isotropic(scene, solver.R)
        except ValueError:
            obstacle = "the density is not isotropic"
        else:
            N = radial_nodes(solver.N)
            why = f"isotropic density, constant e: {N} speeds resolve what N={solver.N} does"
            return replace(plain, method="radial", N=N), f"radial: {why}"
    if solver.rtol is not None:
        return fast, f"fast: {obstacle}, and no other method chooses directions for a tolerance"
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
    shown = ", ".join(f"{other.method} {1e3 * seconds:.2g} ms" for seconds, other in timed)
    return chosen, f"{chosen.method}: {obstacle}; an evaluation on one thread: {shown}"


def radial_nodes(N: int) -> int:
    """Radial nodes that resolve what N Cartesian points a dimension do."""
    return max(4, math.ceil(N / CARTESIAN_PER_RADIAL))


def _carleman(scene: Scene, solver: SizedSolver) -> SizedSolver | None:
    """`carleman` with an error like that of `fast`, None where it cannot do the scene or has no such rule."""
    try:
        carleman_scenes.check_scene(scene)
    except ValueError:
        return None
    many = 1.0 if solver.variant == "full" else DIRECTIONS_TOO_MANY[scene.dim]
    if scene.dim == 2:
        # In multiples of four: at e = 1 one of each four directions is then enough.
        return replace(solver, method="carleman", M_cir=4 * math.ceil(many * solver.M_cir / 4))
    if many == 1.0:
        return replace(solver, method="carleman")
    if not isinstance(solver.M_sph, int) or solver.sphere_rule not in SIZED_RULES:
        return None
    larger = [M for M in sphere_sizes(solver.sphere_rule) if many * solver.M_sph <= M]
    return replace(solver, method="carleman", M_sph=larger[0]) if larger else None
