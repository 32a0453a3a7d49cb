"""The quadrature in the relative velocity g = ρĝ that a solver asks for."""

from granstudy.quadrature import Rule, circle_rule, radial_rule, sphere_rule
from granstudy.scene import Scene
from granstudy.solver import Solver


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
