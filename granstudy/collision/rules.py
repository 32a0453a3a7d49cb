"""The quadrature in the relative velocity g = ρĝ that a solver asks for."""

import numpy as np

from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.quadrature import Rule, circle_rule, half, radial_rule, sphere_rule
from granstudy.quadrature.orbits import invariance, representatives
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.symmetry import Symmetry


def radial_nodes(scene: Scene, solver: Solver) -> Rule:
    """Nodes and weights on [0, R] for integrands ρ^{d−1+λ} × (even function of ρ)."""
    assert solver.N_rho is not None
    exponent = scene.dim - 1 + scene.kernel.exponent
    return radial_rule(solver.N_rho, solver.R, solver.radial_rule, exponent)


def directions(scene: Scene, solver: Solver) -> Rule:
    """Unit vectors ĝ and weights that sum to 2π (2D) or 4π (3D)."""
    if scene.dim == 2:
        return circle_rule(solver.M_cir)
    return sphere_rule(solver.M_sph, solver.sphere_rule)


def reduce_directions(rule: Rule, group: Symmetry) -> tuple[Symmetry, Rule]:
    """The largest part of a group that the rule has too, and one direction of each orbit.

    The group is {1} where it saves nothing over pairs ±ĝ.
    """
    pairs = half(rule)
    kept = invariance(rule, group)
    reduced = representatives(rule, kept)
    if len(reduced) < len(pairs):
        return kept, reduced
    return Symmetry.named(group.dim, "none"), pairs


def converged_radial(scene: Scene, grid: VelocityGrid) -> Rule:
    """A radial rule so fine that the weights' integrals over ρ are exact to round-off.

    The integrand's phase reaches R·(α|k| + |m−αk|)π/L ≤ 2π√d·N/2·R/L; a Gauss rule resolves a phase x with
    about x/2 nodes and then converges at once.
    """
    phase = 2.0 * np.pi * np.sqrt(grid.dim) * grid.N / 2 * grid.R / grid.L
    exponent = grid.dim - 1 + scene.kernel.exponent
    return radial_rule(32 + int(0.6 * phase), grid.R, "jacobi", exponent)
