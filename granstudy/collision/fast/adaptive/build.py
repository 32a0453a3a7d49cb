"""Plans of given rules, the operator of a plan, and finer plans to check a plan with."""

from dataclasses import replace

import numpy as np

from granstudy.collision.fast.adaptive.plan import QuadraturePlan
from granstudy.collision.fast.nodes import place_nodes
from granstudy.collision.fast.operator import (
    GainLossOperator,
    MakeOperator,
    nodal_loss,
    nodal_operator,
    spectrum_axes,
)
from granstudy.collision.fourier.spectra import serial_transforms
from granstudy.collision.rules import converged_radial
from granstudy.collision.weights import loss_weight
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import Rule, radial_rule
from granstudy.quadrature.ladder import ladder
from granstudy.velocity.cartesian import VelocityGrid

FINER_SHELLS = 3
"""Number of shells that the finer quadrature has more."""

FINER_LEVELS = 2
"""Number of steps up the ladder of rules that the finer quadrature takes."""


def shell_radii(scene: Scene, solver: SizedSolver, N_rho: int) -> Rule:
    """Radii of the shells by Gauss–Jacobi in ρ²: spectral for every λ, with the fewest shells."""
    return radial_rule(N_rho, solver.R, "jacobi", scene.dim - 1 + scene.kernel.exponent)


def planned_operator(
    scene: Scene,
    solver: SizedSolver,
    plan: QuadraturePlan,
    make: MakeOperator = nodal_operator,
) -> GainLossOperator:
    """The operator with the quadrature of a plan, on the solver's grid.

    In the variant ``separate`` the loss is integrated by a radial rule that has converged, at no cost.
    """
    grid = solver.grid(scene.dim)
    rules = ladder(scene.dim, scene.symmetry)
    radial = shell_radii(scene, solver, plan.N_rho)
    steps = [rules.steps[rules.level(size)] if size else None for size in plan.sizes]
    if solver.variant == "separate":
        fine = converged_radial(scene, grid)
        loss = loss_weight(scene.kernel, grid, fine.points, fine.weights, half=True)
    else:
        pairs = [None if step is None else step.pairs for step in steps]
        loss = nodal_loss(grid, place_nodes(scene, grid, radial, pairs))
    products = VelocityGrid(scene.dim, plan.n, solver.R)
    reduced = [None if step is None else step.reduced for step in steps]
    nodes = place_nodes(scene, products, radial, reduced)
    return make(scene, solver, products, nodes, rules.group, spectrum_axes(grid, loss))


def describe_plan(scene: Scene, solver: SizedSolver, levels: list[int | None]) -> QuadraturePlan:
    """The plan with a step of the ladder on each shell, or None for no nodes. Its errors are not known."""
    assert solver.rtol is not None
    rules = ladder(scene.dim, scene.symmetry)
    steps = [rules.steps[level] for level in levels if level is not None]
    nodes = sum(len(step.reduced) for step in steps)
    return QuadraturePlan(
        dim=scene.dim,
        rtol=solver.rtol,
        N=solver.N,
        n=solver.product_points,
        rule=rules.rule,
        radii=tuple(map(float, shell_radii(scene, solver, len(levels)).points)),
        sizes=tuple(0 if level is None else rules.steps[level].size for level in levels),
        symmetry=rules.group.name,
        nodes=nodes,
        transforms=2 * nodes + serial_transforms(solver.N, solver.product_points),
        error=float("nan"),
        aliasing=float("nan"),
    )


def with_products_on(plan: QuadraturePlan, n: int) -> QuadraturePlan:
    """The plan with its products formed on n points per dimension."""
    return replace(plan, n=n, transforms=2 * plan.nodes + serial_transforms(plan.N, n))


def refine(scene: Scene, solver: SizedSolver, plan: QuadraturePlan) -> QuadraturePlan:
    """A finer plan: more shells, with rules well above the rules of ``plan`` at neighbouring radii."""
    rules = ladder(scene.dim, scene.symmetry)
    N_rho = plan.N_rho + FINER_SHELLS
    levels: list[int | None] = []
    for rho in shell_radii(scene, solver, N_rho).points:
        i = int(np.searchsorted(plan.radii, rho))
        near = max(plan.sizes[max(i - 1, 0) : i + 1])
        level = rules.level(near) if near else -1
        levels.append(min(level + FINER_LEVELS, len(rules) - 1))
    return with_products_on(describe_plan(scene, solver, levels), plan.n)
