"""The grid and the quadrature of a gas without isotropy: predicted, made once, and checked.

Planning an operator with a tolerance takes as long as some forty evaluations. So, before one is made,
truncation is predicted by sums over pairs, and aliasing measured with a rough rule. The rates of T and a2 by
the operator then show whether the prediction was right.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from granstudy.accuracy.grids.sources import Source
from granstudy.accuracy.grids.truncation import Truncation
from granstudy.accuracy.leg import Gas, Leg, Need, Tried, make_leg
from granstudy.collision.choice.cost import estimate
from granstudy.collision.choice.method_costs import FAST
from granstudy.collision.fast.adaptive.build import describe_plan, planned_operator
from granstudy.collision.fast.adaptive.plan import QuadraturePlan
from granstudy.collision.fast.adaptive.search import make_plan
from granstudy.collision.fast.gain import GainSum
from granstudy.evolution.frames.rescaled import Place
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.support.errors import ToleranceError
from granstudy.trust.changes import Change, change_of_moments
from granstudy.trust.error_estimate import Balance
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.symmetry import Symmetry

POINTS = {
    2: (16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128),
    3: (16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96),
}
"""Points a dimension that are tried."""

SHRINKS = (1.0, 0.94, 0.88, 0.82)
"""Radii that are tried, over the radius at which truncation alone is allowed."""

UNRESOLVED = 3e-2
"""Part of ∫f² in the upper quarter of the wavenumbers above which points are too few to try."""

TRUNCATION_PART = 0.7
"""Part of the target for truncation where the radius is chosen."""

A2_PER_RTOL, OTHER_PER_RTOL = 0.6, 0.3
"""Growth of the errors of a2 and of the shape over rtol, about. *Measured*: three Gaussians, N = 28 to 40,
rtol from 1e-2 to 3e-4: 0.1 to 1.2, and 0.07 to 0.45."""

SMALLEST_RTOL, LARGEST_RTOL = 1e-9, 2e-2
"""Tolerances of the quadrature."""

MOST_EXCHANGE, EXCHANGE_PER_A2 = 0.02, 10.0
"""Largest part of the exchange of all pairs that a radius cuts off: a number, and times the allowed growth of
a2. In a gas that cools, the rates of T and a2 ask for a larger radius; in an elastic gas they may be 0."""

HOLDING = {2: 64, 3: 40}
"""Points a dimension of the grids on which a box is tried, by dimension."""

WIDER = 1.06
"""Factor between boxes that are tried."""

ACCEPTED = 0.8
"""Growth of errors over the allowed growth with which an operator is taken: the quadrature's part falls as
the gas relaxes."""

EXTENDED = 1.1
"""Factor at least from one radius to the next."""

LARGEST_GROWTH = 1.3
"""The same at most."""

LARGEST_SLACK = 0.3
"""Growth of errors of the shape over the allowed one, up to which a quadrature becomes looser."""

CLOSER = (1.05, 1.18)
"""Points on a length over the present ones that are tried."""

SHELLS, LEVEL = 8, 2
"""Shells, and step of the ladder of rules on each, that aliasing is measured with."""

TIGHTER, LOOSER = 3.0, 10.0
"""Factors between tolerances of the quadrature that are tried."""

ATTEMPTS = 4
"""Operators that are made at most."""

REFUSED = 6
"""Quadratures that a grid refuses at most, beside."""

HELPED = 0.7
"""Growth with a tighter quadrature, over that with a looser one, above which it is not the cause."""


def _even(number: float) -> int:
    """The even number next above."""
    return 2 * int(np.ceil(number / 2))


class Search:
    """A search for a grid.

    Parameters
    ----------
    gas : Gas
    source : Source
        The density.
    place : Place
        Where the frame is.
    need : Need
        What errors are allowed.
    cut : Truncation
        What radii cut off.
    target : float
        Growth of errors over the allowed growth, on the grid to find.
    memory : float
        Bytes that an operator may take.
    """

    def __init__(
        self,
        gas: Gas,
        source: Source,
        place: Place,
        need: Need,
        cut: Truncation,
        target: float,
        memory: float,
    ) -> None:
        self._gas, self._source, self._place = gas, source, place
        self._need, self._cut, self._target, self._memory = need, cut, target, memory
        allowed = need.allowed
        growth = min(allowed.a2 / A2_PER_RTOL, allowed.other / OTHER_PER_RTOL)
        self._rtol = float(np.clip(growth, SMALLEST_RTOL, LARGEST_RTOL))
        self._wider = 1.0

    def find(self, too_coarse: SizedSolver | None = None) -> Tried:
        """The grid with the fewest points that is predicted to do, made and checked; else the best found.

        With more points, a larger radius and a tighter quadrature than one that turned out too coarse.

        Raises
        ------
        ToleranceError
            If no grid allows any quadrature.
        """
        if too_coarse is not None:
            assert too_coarse.rtol is not None
            self._rtol = max(min(self._rtol, too_coarse.rtol) / TIGHTER, SMALLEST_RTOL)
            self._wider = EXTENDED
        first = self._next(too_coarse.N if too_coarse else 0)
        if first is None:
            raise ToleranceError("no more points are tried, or fit into memory")
        return self._improve(first)

    def go_on(self, leg: Leg, now: Balance) -> Tried:
        """A grid for a gas that outgrew its own, whose errors now grow as ``now`` says.

        The first of the remedies on which errors grow slowly enough, else the best one.

        Raises
        ------
        ToleranceError
            If no remedy allows any quadrature.
        """
        best: Tried | None = None
        for solver in self._remedies(leg.solver, now):
            tried = self._try(solver)
            if tried is not None and (best is None or tried.ratio < best.ratio):
                best = tried
            if best is not None and best.ratio <= ACCEPTED:
                return best
        if best is None:
            raise ToleranceError("no remedy has a quadrature")
        return best

    def _remedies(self, solver: SizedSolver, now: Balance) -> Iterator[SizedSolver]:
        """Grids and quadratures that may do better, by the cause that is most likely.

        Where pairs are cut off, nodes are added beyond the border, and all others stay. Else the quadrature
        becomes tighter, then the spacing smaller as well: a density on a marginal spacing has noise far out,
        which the next grid must hold too.
        """
        assert solver.rtol is not None
        N, R, allowed = solver.N, solver.R, self._need.allowed
        tight = max(solver.rtol / max(2.0 * allowed.ratio(now), TIGHTER), SMALLEST_RTOL)
        if self._cut_off(R) > self._target:
            M = _even(N * np.clip(self._radius() / R, EXTENDED, LARGEST_GROWTH))
            slack = LARGEST_SLACK * allowed.other / max(now.other, 1e-300)
            loose = min(solver.rtol * float(np.clip(slack, 1.0, LOOSER)), LARGEST_RTOL)
            grids = [
                (M, R * M / N, loose),
                (M, R * M / N, tight),
                (_even(CLOSER[0] * M), R * M / N, tight),
            ]
        else:
            grids = [
                (N, R, tight),
                *((_even(n * EXTENDED * N), EXTENDED * R, tight) for n in CLOSER),
            ]
        for N, R, self._rtol in grids:
            if self._fits(N):
                yield self._solver(N, R)

    def _improve(self, solver: SizedSolver) -> Tried:
        """The operator of a solver, made and checked, and made better where it does not do."""
        best: Tried | None = None
        made = refused = 0
        while made < ATTEMPTS and refused < REFUSED:
            tried = self._try(solver)
            again: SizedSolver | None
            if tried is None:
                refused += 1
                again = self._more_points(solver)
            else:
                made += 1
                if tried.ratio <= ACCEPTED:
                    return tried
                helped = (
                    best is None
                    or best.leg.solver.N != solver.N
                    or tried.ratio <= HELPED * best.ratio
                )
                if best is None or tried.ratio < best.ratio:
                    best = tried
                again = self._tighter(solver) if helped else self._larger(solver)
            if again is None:
                break
            solver = again
        for _ in range(ATTEMPTS):
            if best is None:  # a looser quadrature than the accuracy needs, and the run will say so
                self._rtol = min(LOOSER * self._rtol, LARGEST_RTOL)
                best = self._try(self._solver(solver.N, solver.R))
        if best is None:
            raise ToleranceError(
                f"no grid up to N={solver.N} has a quadrature that meets the accuracy; ask for less"
            )
        return best

    def _next(self, above: int) -> SizedSolver | None:
        """The grid with the fewest points, more than ``above``, that is predicted to do, else the best.

        None where no more points are tried, or fit into memory.
        """
        best: tuple[float, SizedSolver] | None = None
        radius = self._radius()
        for N in POINTS[self._gas.scene.dim]:
            if above >= N or (best is not None and not self._fits(N)):
                continue
            for shrink in SHRINKS:
                solver = self._solver(N, shrink * radius)
                predicted = self._predicted(solver)
                if best is None or predicted <= best[0]:
                    best = predicted, solver
                if predicted <= self._target:
                    return solver
        return None if best is None else best[1]

    def _radius(self) -> float:
        """The radius at which truncation alone is allowed, and whose box holds the density."""
        part, allowed = TRUNCATION_PART * self._target, self._need.allowed
        R = self._wider * self._cut.radius(part * allowed.other, part * allowed.a2, self._exchange)
        dim = self._gas.scene.dim
        while self._cut.radii[-1] > R:
            grid = VelocityGrid(dim, HOLDING[dim], R)
            if self._need.lost_ratio(self._source.lost(grid)) <= self._target:
                break
            R *= WIDER
        return R

    def _cut_off(self, R: float) -> float:
        """What a radius cuts off, over what is allowed."""
        other, a2, exchange = self._cut.at(R)
        allowed = self._need.allowed
        beyond = self._target * exchange / self._exchange
        return max(other / allowed.other, a2 / allowed.a2, beyond)

    @property
    def _exchange(self) -> float:
        """Largest part of the exchange of all pairs that a radius may cut off."""
        return min(MOST_EXCHANGE, EXCHANGE_PER_A2 * self._need.allowed.a2)

    def _predicted(self, solver: SizedSolver) -> float:
        """Growth of errors by truncation and aliasing, over the allowed growth."""
        scene, allowed = self._gas.stand_in(), self._need.allowed
        grid = solver.grid(scene.dim)
        f = self._source.on(grid)
        if grid.spectral_tail(f) > UNRESOLVED:
            return np.inf
        lost = self._need.lost_ratio(self._source.lost(grid))
        cut = self._cut_off(solver.R)
        if max(cut, lost) > self._target:
            return max(cut, lost)
        aliased = aliasing_rates(scene, solver, f)
        return max(cut, lost, aliased.temperature / allowed.other, aliased.a2 / allowed.a2)

    def _try(self, solver: SizedSolver) -> Tried | None:
        """Make the operator, and measure; None where its tolerance is out of reach."""
        f = self._source.on(solver.grid(self._gas.scene.dim))

        def plan(scene: Scene) -> QuadraturePlan:
            return make_plan(scene, solver, f)

        try:
            leg = make_leg(self._gas, solver, plan)
        except ToleranceError:
            return None
        balance = leg.balance(leg.start(f, self._place))
        ratio = self._need.ratio(balance, self._source.lost(leg.grid))
        return Tried(leg, f, ratio, balance)

    def _tighter(self, solver: SizedSolver) -> SizedSolver | None:
        """A tighter quadrature on the same grid, where it can be the cause; else more points."""
        assert solver.rtol is not None
        # what aliasing and truncation were predicted to leave, the quadrature makes
        self._rtol = max(self._rtol / TIGHTER, SMALLEST_RTOL)
        if self._predicted(solver) <= self._target and self._rtol < solver.rtol:
            return self._solver(solver.N, solver.R)
        return self._more_points(solver)

    def _larger(self, solver: SizedSolver) -> SizedSolver | None:
        """A larger radius and more points: what was predicted to do does not."""
        assert solver.rtol is not None
        self._rtol, self._wider = TIGHTER * solver.rtol, self._wider * WIDER
        return self._more_points(solver)

    def _more_points(self, solver: SizedSolver) -> SizedSolver | None:
        if POINTS[self._gas.scene.dim][-1] <= solver.N or not self._fits(solver.N + 8):
            return None
        return self._next(solver.N)

    def _solver(self, N: int, R: float) -> SizedSolver:
        return Solver(N=N, R=R, rtol=self._rtol, threads=self._gas.threads).sized()

    def _fits(self, N: int) -> bool:
        """Whether memory holds an operator with so many points."""
        solver = self._solver(N, 1.0)
        return estimate(FAST, self._gas.stand_in(), solver, 1).memory_mb * 2.0**20 <= self._memory


def aliasing_rates(scene: Scene, solver: SizedSolver, f: np.ndarray) -> Change:
    """Rates of T and a2 that change with the signs of the nodes, by a rough rule: what aliasing does.

    Without aliasing g and −g would give the same (`granstudy.collision.fast.adaptive.aliasing`).
    """
    law = scene.restitution
    e = float(law(np.ones(1))[0]) if callable(law) else law
    # At a constant e: weights of a law take long to make, and aliasing is of the products.
    scene = replace(scene, restitution=e, symmetry=Symmetry.named(scene.dim, "none"))
    operator = planned_operator(scene, solver, describe_plan(scene, solver, [LEVEL] * SHELLS))
    Q = operator(f)
    flipped = replace(operator.gain.nodes, vectors=-operator.gain.nodes.vectors)
    operator.gain = GainSum(
        scene, operator.gain.grid, flipped, solver.thread_count, precision=solver.precision
    )
    change = change_of_moments(solver.grid(scene.dim), f, Q - operator(f))
    return Change(abs(change.temperature), abs(change.a2))
