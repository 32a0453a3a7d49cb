"""The search for a plan: shells, and on each shell as many directions as its part of Q needs.

The quadrature error of Q is a sum over shells, and is measured for one density (docs/method.md §2, fact 5):

1. Every shell's part of Q is computed with rules of growing size, until it settles.
2. Rules are chosen so that the sum of the errors, and its moments, stay under rtol at least cost.
3. A finer quadrature verifies the choice.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from granstudy.collision.fast.adaptive.aliasing import (
    SIZES,
    Aliasing,
    aliasing,
    resolving_grids,
)
from granstudy.collision.fast.adaptive.allocation import allocate
from granstudy.collision.fast.adaptive.build import (
    describe_plan,
    planned_operator,
    refine,
    shell_radii,
    with_products_on,
)
from granstudy.collision.fast.adaptive.error import ErrorScale, magnitude, quadrature_error
from granstudy.collision.fast.adaptive.plan import QuadraturePlan
from granstudy.collision.fast.adaptive.shells import Shells
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature.ladder import ladder
from granstudy.support.errors import ToleranceError

TARGET = 0.5
"""Part of the tolerance that a new plan may use. The rest is kept for a density that evolves."""

RADIAL_PART = 0.15
"""Part of the tolerance that the radii may use."""

GRID_PART = 0.15
"""Part of the tolerance that a smaller grid for the products may use."""

RESOLVED = 0.1
"""Largest max|f − f_n| over max|f|, in parts of the tolerance, for f_n on a smaller grid."""

QUIET = 0.2
"""Largest aliasing, in parts of the tolerance, on a smaller grid that a plan is made on."""

SETTLED = 0.03
"""Change by the next rule, in parts of the tolerance, below which a shell's part of Q has settled."""

LARGEST_N_RHO = 80
"""Largest number of shells that is tried."""

ATTEMPTS = 5
"""Largest number of plans that are made and verified."""


def make_plan(scene: Scene, solver: SizedSolver, f: np.ndarray) -> QuadraturePlan:
    """The cheapest quadrature found whose error of Q(f,f) is under rtol, moments included (`ErrorScale`).

    It is searched on the smallest grid that resolves f with little aliasing, and on the next larger one where
    that fails, up to the solver's own.

    Raises
    ------
    ToleranceError
        If aliasing on the solver's grid keeps the sums from settling to rtol, or no rules reach it.
    """
    failed: ToleranceError | None = None
    for small, f_n, probe in _quiet_grids(scene, solver, f):
        try:
            plan = _plan_on(scene, small, f_n, probe)
        except ToleranceError as error:
            failed = error
        else:
            return _choose_grid(scene, solver, replace(plan, N=solver.N), f)
    assert failed is not None
    raise failed


def _plan_on(scene: Scene, solver: SizedSolver, f: np.ndarray, probe: Aliasing) -> QuadraturePlan:
    """The cheapest quadrature found on the solver's grid, where ``probe`` measured aliasing."""
    assert solver.rtol is not None
    noise = probe.kept
    N_rho = _radial_size(scene, solver, f, RADIAL_PART * solver.rtol + noise / 2)
    settled = (SETTLED * solver.rtol + noise / 10) * probe.scale
    bound = (TARGET - RADIAL_PART / 2) * solver.rtol
    best: QuadraturePlan | None = None
    parts, costs = _measure(scene, solver, f, N_rho, settled)
    scale = ErrorScale(solver.grid(scene.dim), probe.Q, probe.scale)
    for _ in range(ATTEMPTS):
        samples = [scale.samples(part - part[-1]) for part in parts]
        choices = allocate([errors for errors, _ in samples], costs, bound, samples[0][1])
        plan = describe_plan(scene, solver, [choice - 1 if choice else None for choice in choices])
        finer = planned_operator(scene, solver, refine(scene, solver, plan))
        error = quadrature_error(planned_operator(scene, solver, plan), finer, f)
        stuck = best is not None and error > 0.8 * best.error
        if best is None or error < best.error:
            best = replace(plan, error=error, aliasing=probe.everywhere)
        if error <= TARGET * solver.rtol:
            break
        if stuck or error > solver.rtol:  # better rules do not help: the radii are too few
            N_rho += 1
            parts, costs = _measure(scene, solver, f, N_rho, settled)
        else:
            bound *= TARGET * solver.rtol / error
    assert best is not None
    if best.error <= solver.rtol:
        return best
    raise ToleranceError(
        f"rtol={solver.rtol!r}: no rules found on N={solver.N} have an error below {best.error:.1e} of "
        f"max|Q|, though aliasing is {probe.kept:.1e}; take a larger rtol, or give N_rho and M_sph (M_cir)"
    )


def _quiet_grids(
    scene: Scene, solver: SizedSolver, f: np.ndarray
) -> Iterator[tuple[SizedSolver, np.ndarray, Aliasing]]:
    """The solver on grids that resolve f with little aliasing (`QUIET`), smallest first, and on its own grid.

    Each with f on that grid, and the aliasing there.

    Raises
    ------
    ToleranceError
        If aliasing exceeds rtol on the solver's own grid.
    """
    assert solver.rtol is not None
    for n, f_n in resolving_grids(solver.grid(scene.dim), f, RESOLVED * solver.rtol):
        small = replace(solver, N=n)
        probe = aliasing(scene, small, f_n)
        if probe.kept <= QUIET * solver.rtol:
            yield small, f_n, probe
    if probe.kept > solver.rtol:
        cause = "round-off" if solver.dealias else "aliasing"
        remedy = "" if solver.dealias else ", or dealias=True"
        raise ToleranceError(
            f"rtol={solver.rtol!r}: on N={solver.N} {cause} keeps the sums over directions from settling "
            f"below {probe.kept:.1e} of max|Q|; take a larger N or a larger rtol{remedy}"
        )
    if probe.kept > QUIET * solver.rtol:
        yield small, f_n, probe


def _radial_size(scene: Scene, solver: SizedSolver, f: np.ndarray, tolerance: float) -> int:
    """Fewest shells whose radii are good to a relative tolerance.

    All shells take the ladder's second rule. The parts of Q by that rule are as smooth in ρ as the parts by a
    better one.
    """
    before = None
    for N_rho in range(4, LARGEST_N_RHO + 1, 2):
        plan = describe_plan(scene, solver, [1] * N_rho)
        operator = planned_operator(scene, solver, plan)
        Q = operator(f)
        if before is not None and (
            ErrorScale(operator.grid, Q, magnitude(operator, f, Q)).error(Q - before) <= tolerance
        ):
            return N_rho - 2
        before = Q
    raise ToleranceError(
        f"rtol={solver.rtol!r}: {LARGEST_N_RHO} shells do not reach the tolerance on N={solver.N}; "
        "take a larger N or a larger rtol"
    )


def _measure(
    scene: Scene, solver: SizedSolver, f: np.ndarray, N_rho: int, settled: float
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Every shell's part of Q: without nodes (zero), and with the ladder's rules up to where it settles.

    Returns
    -------
    tuple of lists
        For every shell the parts, shape (choices, points), and their costs in nodes, shape (choices,).
    """
    rules = ladder(scene.dim, scene.symmetry)
    shells = Shells(scene, solver, rules, f)
    radial = shell_radii(scene, solver, N_rho)
    measured = [[np.zeros(f.size)] for _ in range(N_rho)]
    active = set(range(N_rho))
    for level in range(len(rules)):
        levels = [level if shell in active else None for shell in range(N_rho)]
        parts = shells.contributions(radial, levels)
        for shell in sorted(active):
            change = np.max(np.abs(parts[shell] - measured[shell][-1]))
            measured[shell].append(parts[shell])
            if change <= settled and level > 0:
                active.remove(shell)
        if not active:
            break
    costs = np.array([0, *(len(step.reduced) for step in rules.steps)])
    return [np.array(m) for m in measured], [costs[: len(m)] for m in measured]


def _choose_grid(
    scene: Scene, solver: SizedSolver, plan: QuadraturePlan, f: np.ndarray
) -> QuadraturePlan:
    """The plan with its products on the smallest grid that changes Q by at most `GRID_PART` of rtol."""
    assert solver.rtol is not None
    if solver.dealias:  # products wrap around on every smaller grid
        return with_products_on(plan, solver.product_points)
    sizes = [n for n in SIZES if plan.n <= n < solver.N]
    if sizes:
        operator = planned_operator(scene, solver, replace(plan, n=solver.N))
        Q = operator(f)
        scale = magnitude(operator, f, Q)
        for n in sizes:
            smaller = planned_operator(scene, solver, replace(plan, n=n))
            change = float(np.max(np.abs(smaller(f) - Q))) / scale
            if change <= GRID_PART * solver.rtol:
                return replace(with_products_on(plan, n), error=plan.error + change)
    return with_products_on(plan, solver.N)
