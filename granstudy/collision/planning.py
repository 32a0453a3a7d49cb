"""From a tolerance to a quadrature: shells, and on each as many directions as its part of Q needs.

The quadrature error of Q is a sum over shells. For one density it is measured: every shell's part of Q is
computed with rules of growing size until it settles, and the rules are chosen so that the sum of the
errors stays under rtol·max|Q| (docs/method.md §2, fact 5). A finer quadrature then verifies the choice.
"""

from dataclasses import replace

import numpy as np
import scipy.fft

from granstudy.collision.allocation import allocate, sampled
from granstudy.collision.plan import QuadraturePlan
from granstudy.collision.planned import (
    describe_plan,
    difference,
    planned_operator,
    quadrature_error,
    refine,
    shell_radii,
)
from granstudy.collision.shells import Shells
from granstudy.collision.transforms import resize
from granstudy.grid import VelocityGrid
from granstudy.quadrature.ladder import ladder
from granstudy.scene import Scene
from granstudy.solver import Solver

TARGET = 0.5
"""Part of the tolerance that a new plan may use: the rest is for a density that evolves."""

RADIAL_PART = 0.15
"""Part of the tolerance for the radii."""

GRID_PART = 0.15
"""Part of the tolerance for forming the products on a smaller grid."""

RESOLVED = 0.1
"""max|f − f_n| over max|f|, in parts of the tolerance, on a smaller grid that may hold f."""

SETTLED = 0.03
"""A shell's part has settled where the next rule changes it by this part of the tolerance."""

LARGEST_N_RHO = 80

SIZES = (8, 12, 16, 20, 32, 40, 48, 64, 96, 128)
"""Grids on which products may be formed. FFTW's real transforms of 32³ points take less time than those
of 22³ to 30³."""

ATTEMPTS = 5


class ToleranceError(ValueError):
    """The tolerance cannot be reached on the solver's grid."""


def make_plan(scene: Scene, solver: Solver, f: np.ndarray) -> QuadraturePlan:
    """The cheapest quadrature found with an error of Q(f,f) under rtol·max|Q|.

    Raises
    ------
    ToleranceError
        If the sums do not settle so far, as aliasing on the solver's grid keeps them from it.
    """
    assert solver.rtol is not None
    n, f_n = resolving_grid(solver.grid(scene.dim), f, RESOLVED * solver.rtol)
    small = replace(solver, N=n)
    N_rho, scale = _radial_size(scene, small, f_n)
    bound = (TARGET - RADIAL_PART) * solver.rtol * scale
    error = np.inf
    for _ in range(ATTEMPTS):
        parts, costs = _measure(scene, small, f_n, N_rho, SETTLED * solver.rtol * scale)
        choices = allocate([sampled(part - part[-1]) for part in parts], costs, bound)
        assert choices is not None  # the last choice has no error against itself
        levels = [choice - 1 if choice else None for choice in choices]
        plan = describe_plan(scene, small, n, N_rho, levels, error)
        finer = planned_operator(scene, small, refine(scene, small, plan))
        error = quadrature_error(planned_operator(scene, small, plan), finer, f_n)
        if error <= TARGET * solver.rtol * 1.2:
            return _choose_grid(scene, solver, replace(plan, N=solver.N, error=error), f)
        if error > 3 * solver.rtol:
            N_rho += 1
        bound *= min(0.7, TARGET * solver.rtol / error)
    raise ToleranceError(
        f"rtol={solver.rtol!r}: the sums over directions on N={solver.N} settle to {error:.1e} of "
        "max|Q| only, as aliasing is as large; take a larger N or rtol"
    )


def resolving_grid(grid: VelocityGrid, f: np.ndarray, tolerance: float) -> tuple[int, np.ndarray]:
    """The smallest of `SIZES` on which f is max|f|·tolerance near itself, and f there; else the grid."""
    axes = (0, 1, 2) if grid.dim == 3 else (0, 2)
    wide = f if grid.dim == 3 else f[:, None, :]
    f_hat = scipy.fft.rfftn(wide, axes=axes, norm="forward")

    def values(spectrum: np.ndarray) -> np.ndarray:
        shape = (len(spectrum),) * grid.dim
        return scipy.fft.irfftn(spectrum, s=shape, axes=axes, norm="forward").reshape(shape)

    for n in SIZES:
        if n >= grid.N:
            break
        small = resize(f_hat, n)
        lost = values(f_hat - resize(small, grid.N))
        if np.max(np.abs(lost)) <= tolerance * np.max(np.abs(f)):
            return n, values(small)
    return grid.N, f


def _radial_size(scene: Scene, solver: Solver, f: np.ndarray) -> tuple[int, float]:
    """Fewest shells whose radii are good to their part of the tolerance, and max|Q|.

    Judged with the ladder's second rule, the same on all shells: its parts are as smooth in ρ as those of
    a better one.
    """
    assert solver.rtol is not None
    before = None
    for N_rho in range(4, LARGEST_N_RHO, 2):
        plan = describe_plan(scene, solver, solver.N, N_rho, [1] * N_rho, np.nan)
        Q = planned_operator(scene, solver, plan)(f)
        scale = float(np.max(np.abs(Q)))
        if before is not None and difference(Q, before) <= RADIAL_PART * solver.rtol * scale:
            return N_rho - 2, scale
        before = Q
    raise ToleranceError(
        f"rtol={solver.rtol!r}: {LARGEST_N_RHO} shells do not reach it on N={solver.N}; "
        "take a larger N or rtol"
    )


def _measure(
    scene: Scene, solver: Solver, f: np.ndarray, N_rho: int, settled: float
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Every shell's part of Q without nodes, and with the ladder's rules up to where it settles.

    Returns, a shell each, arrays (choices, points) and the choices' costs in nodes.
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
    scene: Scene, solver: Solver, plan: QuadraturePlan, f: np.ndarray
) -> QuadraturePlan:
    """The plan on the smallest grid for its products that changes Q by little enough."""
    assert solver.rtol is not None
    sizes = [n for n in SIZES if plan.n <= n < solver.N]
    if sizes:
        Q = planned_operator(scene, solver, replace(plan, n=solver.N))(f)
        for n in sizes:
            smaller = planned_operator(scene, solver, replace(plan, n=n))
            change = float(np.max(np.abs(smaller(f) - Q)) / np.max(np.abs(Q)))
            if change <= GRID_PART * solver.rtol:
                return replace(
                    plan, n=n, transforms=smaller.transforms, error=plan.error + change
                )
    return replace(plan, n=solver.N, transforms=2 * plan.nodes + 3)
