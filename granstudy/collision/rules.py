"""The solver's quadrature rules for the relative velocity g = ρĝ: radii ρ and directions ĝ."""

import numpy as np

from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import Rule, circle_rule, half, radial_rule, sphere_rule
from granstudy.quadrature.orbits import invariance, representatives
from granstudy.quadrature.sphere import SPHERE_RULES
from granstudy.support.files import file_digest
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.symmetry import Symmetry


def radial_nodes(scene: Scene, solver: SizedSolver) -> Rule:
    """The solver's nodes ρ and weights on [0, R], for integrands ρ^{d−1+λ} × (even function of ρ)."""
    assert solver.N_rho is not None
    exponent = scene.dim - 1 + scene.kernel.exponent
    return radial_rule(solver.N_rho, solver.R, solver.radial_rule, exponent)


def directions(scene: Scene, solver: SizedSolver) -> Rule:
    """The solver's unit vectors ĝ, with weights that sum to 2π (2D) or 4π (3D).

    Raises
    ------
    ValueError
        If there is no such rule; or if its file has changed since the solver was made, which describes it.
    """
    if scene.dim == 2:
        return circle_rule(solver.M_cir)
    rule = sphere_rule(solver.M_sph, solver.sphere_rule)
    named = solver.sphere_rule in SPHERE_RULES
    if not named and file_digest(solver.sphere_rule) != solver.sphere_rule_sha256:
        raise ValueError(
            f"sphere_rule={solver.sphere_rule!r}: the file has changed since the solver was made; make the "
            "solver anew"
        )
    return rule


def reduce_directions(rule: Rule, group: Symmetry) -> tuple[Symmetry, Rule]:
    """The largest subgroup that leaves the rule as it is, and one direction of each orbit under it.

    The subgroup is {1} where orbits are no fewer than pairs ±ĝ.
    """
    pairs = half(rule)
    kept = invariance(rule, group)
    reduced = representatives(rule, kept)
    if len(reduced) < len(pairs):
        return kept, reduced
    return Symmetry.named(group.dim, "none"), pairs


def converged_radial(scene: Scene, grid: VelocityGrid) -> Rule:
    """A radial rule so fine that the integrals over ρ in all weights are exact to round-off.

    The integrand's phase reaches R·(α|k| + |m−αk|)π/L ≤ 2π√d·N/2·R/L. A Gauss rule resolves a phase x with
    about x/2 nodes, and from there on converges at once.
    """
    phase = 2.0 * np.pi * np.sqrt(grid.dim) * grid.N / 2 * grid.R / grid.L
    exponent = grid.dim - 1 + scene.kernel.exponent
    return radial_rule(32 + int(0.6 * phase), grid.R, "jacobi", exponent)
