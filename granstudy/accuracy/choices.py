"""What a run computes with: chosen at the start, and again where its errors ask for it."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.budget import MOVE_SHARE, Allowed, allowed_growth
from granstudy.accuracy.grids.cartesian import Search
from granstudy.accuracy.grids.isotropy import anisotropy, isotropic_part, switching_error
from granstudy.accuracy.grids.radial import larger_grid, radial_grid, try_radial
from granstudy.accuracy.grids.sources import Initial, Present, Source, shape_error
from granstudy.accuracy.grids.truncation import Truncation, truncation, without_noise
from granstudy.accuracy.leg import Gas, Leg, Need, Tried
from granstudy.evolution.frames.closed import is_closed
from granstudy.evolution.frames.rescaled import Place
from granstudy.model.solver import SizedSolver
from granstudy.support.errors import ToleranceError
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import Balance
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.radial import BALL_RATIO

TARGET = 0.3
"""Growth of errors on a new grid, over the allowed growth; the rest is kept for a density that evolves."""

WORTH_IT = 0.7
"""Growth of errors on another grid, over that on the present one, above which the present one is kept."""

FIRST_RADIUS = 7.0
"""First radius that is tried for an isotropic gas, in units of √T."""

SQUARES = 30.0
"""Square of the anisotropy of the pressure, over the error allowed to a switch, below which the switch is
tried: the error is of second order."""


class Origin(NamedTuple):
    """Where a run can begin again on another radial grid: density, frame, and the error made on the way."""

    source: Source
    place: Place
    error: Change


class Chosen(NamedTuple):
    """A leg, the state that it begins from, and the error that beginning makes.

    ``needed`` says what is missing where no grid is good enough; "" where one is. ``origin`` is that of a
    radial leg.
    """

    leg: Leg
    state: np.ndarray
    balance: Balance
    error: Change
    reason: str
    needed: str = ""
    origin: Origin | None = None


class Chooser:
    """Chooses grids for one run.

    Parameters
    ----------
    gas : Gas
    asked : Accuracy
    start : Initial
        The initial density.
    at_start : Balance
        Rates at which errors are forgotten at the start.
    cut : Truncation or None
        What radii cut off the initial density; None for an isotropic gas that `radial` can model.
    left : float
        Collisions' time of the whole run.
    memory : float
        Bytes that an operator may take.
    """

    def __init__(
        self,
        gas: Gas,
        asked: Accuracy,
        start: Initial,
        at_start: Balance,
        cut: Truncation | None,
        left: float,
        memory: float,
    ) -> None:
        self._gas, self._asked, self._start = gas, asked, start
        self._at_start, self._cut = at_start, cut
        self.left, self._memory = left, memory

    def first(self, too_coarse: SizedSolver | None = None) -> Chosen:
        """The grid to start on, with more points than a Cartesian one that turned out too coarse.

        Raises
        ------
        ToleranceError
            If no grid allows any quadrature, or none with more points is tried.
        """
        place = Place(0.0, 0.0, self._gas.velocity)
        radius = FIRST_RADIUS * float(np.sqrt(self._start.true.temperature))
        allowed = allowed_growth(
            self._asked,
            self._at_start,
            Change(0.0, 0.0),
            self.left,
            self._cut is None and is_closed(self._gas.scene),
        )
        tried = self._search(self._start, place, allowed, radius, self._cut, too_coarse)
        chosen = self._chosen(tried, place, self._lost(self._start, tried), "the start")
        if self._cut is None:
            chosen = chosen._replace(origin=Origin(self._start, place, Change(0.0, 0.0)))
        return chosen

    def again(
        self, leg: Leg, state: np.ndarray, time: float, allowed: Allowed, reason: str
    ) -> Chosen:
        """Another Cartesian grid for a state; the present one where no other is much better."""
        f, place, grid = leg.frame.density(state), leg.place(state, time), leg.grid
        assert isinstance(grid, VelocityGrid)
        source, now = Present(f, grid), leg.balance(state)
        need, ratio = Need(allowed, self._most), allowed.ratio(now)
        scene = replace(self._gas.scene, restitution=leg.frame.restitution(state))
        cut = truncation(scene, grid, without_noise(f, grid))
        search = Search(self._gas, source, place, need, cut, TARGET, self._memory)
        try:
            tried = search.go_on(leg, now)
        except ToleranceError:
            tried = Tried(leg, f, ratio, now)
        if tried.ratio > WORTH_IT * ratio:
            kept = Tried(leg, f, ratio, now)
            return self._chosen(kept, place, Change(0.0, 0.0), reason, state)
        return self._chosen(tried, place, self._lost(source, tried), reason)

    def begin_again(
        self, origin: Origin, leg: Leg, allowed: Allowed, larger: bool, reason: str
    ) -> Chosen | None:
        """Begin the radial part again, on a larger grid or on the same; None where there is no larger one."""
        need, solver = Need(allowed, self._most), leg.solver
        if larger:
            tried = larger_grid(self._gas, origin.source, origin.place, need, solver, TARGET)
        else:
            tried = try_radial(self._gas, origin.source, origin.place, need, solver.N, solver.R)
        if tried is None:
            return None
        total = origin.error.plus(self._lost(origin.source, tried))
        return self._chosen(tried, origin.place, total, reason)._replace(origin=origin)

    def may_switch(self, leg: Leg, values: dict[str, Any]) -> bool:
        """Whether it is worth while to try the isotropic part alone."""
        if leg.solver.method == "radial" or callable(self._gas.scene.restitution):
            return False
        most = self._most
        return anisotropy(values["pressure"]) ** 2 < SQUARES * min(most.temperature, most.a2)

    def isotropic(
        self, leg: Leg, state: np.ndarray, time: float, allowed: Allowed
    ) -> Chosen | None:
        """The isotropic part alone; None where the rest of the density still counts."""
        grid, f = leg.grid, leg.frame.density(state)
        assert isinstance(grid, VelocityGrid)
        mean, fine = isotropic_part(f, grid)
        error = switching_error(self._gas.scene, f, grid, mean, fine)
        most = self._most
        if error.temperature > most.temperature or error.a2 > most.a2:
            return None
        place, source = leg.place(state, time), Present(mean, fine)

        tried = self._search(source, place, allowed, grid.L / BALL_RATIO, None)
        total = error.plus(self._lost(source, tried))
        reason = f"isotropic to {max(total):.1e}: goes on as its mean over directions"
        chosen = self._chosen(tried, place, total, reason)
        return chosen._replace(origin=Origin(source, place, error))

    @property
    def _most(self) -> Change:
        """Largest errors by a change of grid."""
        return Change(MOVE_SHARE * self._asked.temperature, MOVE_SHARE * self._asked.a2)

    def _search(
        self,
        source: Source,
        place: Place,
        allowed: Allowed,
        radius: float,
        cut: Truncation | None,
        too_coarse: SizedSolver | None = None,
    ) -> Tried:
        """A grid for a density: Cartesian where ``cut`` says what radii cut off, else radial."""
        need = Need(allowed, self._most)
        if cut is None:
            return radial_grid(self._gas, source, place, need, radius, TARGET)
        search = Search(self._gas, source, place, need, cut, TARGET, self._memory)
        return search.find(too_coarse)

    def _lost(self, source: Source, tried: Tried) -> Change:
        """The error that putting a density on a grid makes.

        Of a present density: the difference of the exact rates, until it relaxes.
        """
        if not isinstance(source, Present):
            return source.lost(tried.leg.grid)
        if source.grid == tried.leg.grid:
            return Change(0.0, 0.0)
        before, after = (source.f, source.grid), (tried.f, tried.leg.grid)
        return shape_error(self._gas, before, after).scaled(1.0 / tried.balance.relaxing)

    def _chosen(
        self, tried: Tried, place: Place, error: Change, reason: str, state: Any = None
    ) -> Chosen:
        """A choice, and what it lacks."""
        solver, needed = tried.leg.solver, ""
        if tried.ratio > 1.0:
            needed = (
                f"errors grow at {tried.ratio:.2g} times the rate that the accuracy allows on the best grid "
                f"found ({solver.method}, N={solver.N}, R={solver.R:.3g})"
            )
        if state is None:
            state = tried.leg.start(tried.f, place)
        return Chosen(tried.leg, state, tried.balance, error, reason, needed)
