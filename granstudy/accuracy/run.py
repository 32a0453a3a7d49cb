"""A run to an accuracy: legs, each on a grid of its own, chosen where the budget of errors asks for it."""

import time as wall
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.budget import Allowed, allowed_growth, clock_left
from granstudy.accuracy.choices import Chooser, Chosen, Origin
from granstudy.accuracy.ledger import SOURCES, Ledger
from granstudy.accuracy.leg import Leg
from granstudy.datasets.run_dataset import Record
from granstudy.evolution.frames.physical import physical_moments
from granstudy.evolution.schemes import SCHEMES
from granstudy.evolution.steps.adaptive import AdaptiveSteps
from granstudy.evolution.steps.points import Point, StoppedError
from granstudy.support.errors import RAN_AWAY, ToleranceError
from granstudy.trust import health
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import NOTHING
from granstudy.trust.flags import Status
from granstudy.velocity.moments import moment_values

BALANCES = 0.05
"""Time between balances at least, in relaxation times of a2."""

RELAXED = 0.5
"""Time before a grid is chosen again that could not be chosen well enough, or a switch is tried again, in
relaxation times of a2."""

EASY = 0.02
"""Growth of errors by steps over the allowed one, below which steps may be larger."""

LOOSEST, TIGHTEST = 1e-3, 1e-12
"""Tolerances of a step."""

MOST = 0.9
"""Errors by the grid over those asked for, above which a run begins again."""

EARLY, RESTARTS = 0.3, 2
"""Part of the collisions' time of a run up to which it begins again, and how often, where no other grid helps
a density that a coarse one has spoilt."""

STEP_TOLERANCE = 0.1
"""First tolerance of a step, over the smaller of the asked errors."""


@dataclass
class Stretch:
    """What is recorded of a leg."""

    start: float
    solver: Any
    time_rtol: float
    reason: str
    evaluations: int = 0


@dataclass
class Outcome:
    """All that a run leaves.

    Attributes
    ----------
    record : Record
        Moments and signs over the outputs.
    sources : dict of list
        Estimated errors at each output, by source.
    legs : list of Stretch
    needed : str
        What the asked accuracy would have taken; "" where it was kept.
    steps : dict
        Numbers of steps and evaluations.
    """

    record: Record = field(default_factory=Record)
    sources: dict[str, list[Change]] = field(default_factory=lambda: {name: [] for name in SOURCES})
    legs: list[Stretch] = field(default_factory=list)
    needed: str = ""
    steps: dict[str, int] = field(
        default_factory=lambda: {"accepted": 0, "rejected": 0, "evaluations": 0}
    )


class Beginning(NamedTuple):
    """The start of the radial part of a run, with all that was recorded and estimated until then."""

    origin: Origin
    time: float
    ledger: Ledger
    outcome: Outcome


class Wish(NamedTuple):
    """Why a leg ends: a new grid, a new tolerance of steps, the isotropic part alone."""

    kind: str
    reason: str


class At(NamedTuple):
    """Where a run goes on: leg, state, time."""

    leg: Leg
    state: np.ndarray
    time: float


class Run:
    """One run, from choice to choice.

    Parameters
    ----------
    chooser : Chooser
        Chooses grids.
    asked : Accuracy
    times : ndarray
        Times of the outputs, from 0 on.
    scheme : str
        Time scheme.
    seconds : float
        Wall time after which the run stops.
    report : callable
        Called with outputs done and time.
    """

    def __init__(
        self,
        chooser: Chooser,
        asked: Accuracy,
        times: np.ndarray,
        scheme: str,
        seconds: float,
        report: Callable[[int, float], None],
    ) -> None:
        self._chooser, self._asked, self._times = chooser, asked, times
        self._scheme, self._report = SCHEMES[scheme], report
        self._deadline = wall.monotonic() + seconds
        self.ledger = Ledger()
        self.outcome = Outcome()
        smallest = min(asked.temperature, asked.a2)
        self._time_rtol = float(np.clip(STEP_TOLERANCE * smallest, TIGHTEST, LOOSEST))
        self._first: health.Moments = {}
        self._not_before = self._no_switch_before = -np.inf
        self._beginning: Beginning | None = None
        self._reached, self._grown, self._on_the_last = 0.0, False, False
        self._restarts = 0

    def go(self) -> Outcome:
        """Run to the end, or to where it cannot go on."""
        status, reason = Status.OK, ""
        try:
            at = self._enter(self._chooser.first(), 0.0)
            while True:
                state, time, wish = self._march(*at)
                if wish is None:
                    break
                at = self._follow(at.leg, state, time, wish)
        except StoppedError as stopped:
            status, reason = Status.DIVERGED, str(stopped)
        except TimeoutError as stopped:
            status, reason = Status.STOPPED, str(stopped)
        record = self.outcome.record
        record.status, record.reason = status, reason
        return self.outcome

    def _enter(self, chosen: Chosen, time: float) -> At:
        """Go on with a choice; its start makes an error of its own."""
        if chosen.origin is not None and self._beginning is None:
            past = deepcopy((self.ledger, self.outcome))
            self._beginning = Beginning(chosen.origin, time, *past)
        self.ledger.restart(chosen.balance, chosen.error)
        self.outcome.legs.append(Stretch(time, chosen.leg.solver, self._time_rtol, chosen.reason))
        if chosen.needed:
            self.outcome.needed = chosen.needed
            self._not_before = self.ledger.clock + RELAXED / chosen.balance.relaxing
        return At(chosen.leg, chosen.state, time)

    def _enter_again(self, beginning: Beginning, chosen: Chosen) -> At:
        """Begin the radial part again; what was recorded of it goes, the work is counted."""
        steps = self.outcome.steps
        self.ledger, self.outcome = deepcopy((beginning.ledger, beginning.outcome))
        self.outcome.steps = steps
        self._not_before = -np.inf
        return self._enter(chosen, beginning.time)

    def _from_the_start(self, leg: Leg, wish: Wish, time: float) -> At | None:
        """Begin again on a finer Cartesian grid; None where there is none, or this was done often enough.

        What a coarse grid does to the shape, no other grid undoes.
        """
        if self._restarts == RESTARTS:
            return None
        try:
            chosen = self._chooser.first(leg.solver)
        except ToleranceError:
            return None
        self._restarts += 1
        reason = _begun_again(leg, wish, time)
        steps = self.outcome.steps
        self.ledger, self.outcome = Ledger(), Outcome(steps=steps)
        self._first, self._not_before = {}, -np.inf
        return self._enter(chosen._replace(reason=reason), 0.0)

    def _march(
        self, leg: Leg, state: np.ndarray, start: float
    ) -> tuple[np.ndarray, float, Wish | None]:
        """March until the end, or to where something is to be chosen anew."""
        ahead = self._times[self._times > start]
        times = np.array([start, *ahead])
        if not len(ahead):
            return state, start, None
        steps = AdaptiveSteps(leg.frame, self._scheme, times, self._time_rtol)
        try:
            for point in steps.march(state):
                if point.step == 0 and self.outcome.record.times:
                    continue
                wish = self._see(leg, point)
                self._report(len(self.outcome.record.times) - 1, point.time)
                if wish is not None:
                    return point.state, point.time, wish
                if wall.monotonic() > self._deadline and point.time < self._times[-1]:
                    raise TimeoutError(f"t = {point.time:g}: max_seconds have passed")
        except RAN_AWAY:
            raise StoppedError(steps.accepted, start, health.NOT_FINITE) from None
        finally:
            for name, count in steps.describe().items():
                self.outcome.steps[name] += count
            self.outcome.legs[-1].evaluations += steps.evaluations
        return point.state, point.time, None

    def _see(self, leg: Leg, point: Point) -> Wish | None:
        """Look at the state after a step; returns what it asks for."""
        frame, state, ledger = leg.frame, point.state, self.ledger
        f = frame.density(state)
        values = moment_values(f, leg.grid)
        failed = health.failure(values)
        if failed:
            raise StoppedError(point.step, point.time, failed)
        passing = NOTHING
        if point.difference is not None:
            change = frame.moment_change(state, point.difference)
            ledger.step(frame.clock(state, point.time), change.scaled(point.share))
            passing = change.scaled(point.passing)
        balance = ledger.balance
        assert balance is not None
        pace = max(balance.relaxing, 1.0 / self._chooser.left)
        due = ledger.since_balance * pace >= BALANCES or point.is_output
        due = due and not point.inside
        if due and point.step > 0:
            ledger.weigh(leg.balance(state, point.rate))
        if point.is_output:
            self._output(leg, point, f, values, passing)
        if not due or point.step == 0:
            return None
        return self._too_much() or (
            self._wish(leg, point, values) if point.time < self._times[-1] else None
        )

    def _too_much(self) -> Wish | None:
        """The wish to begin again where errors by the grid came to more than was asked."""
        if self._beginning is None or self._on_the_last:
            return None
        grid, asked = self.ledger.by_grid, self._asked
        ratio = max(grid.temperature / asked.temperature, grid.a2 / asked.a2)
        return (
            Wish("grid", f"errors came to {ratio:.2g} times those asked") if ratio > MOST else None
        )

    def _wish(self, leg: Leg, point: Point, values: dict[str, Any]) -> Wish | None:
        """What the state of the accounts asks for."""
        allowed = self.allowed(leg, point.state, point.time)
        balance = self.ledger.balance
        assert balance is not None
        ratio, clock = allowed.ratio(balance), self.ledger.clock
        if ratio > 1.0 and clock >= self._not_before and not self._on_the_last:
            return Wish("grid", f"errors grew at {ratio:.2g} times the allowed rate")
        if clock >= self._no_switch_before and self._chooser.may_switch(leg, values):
            return Wish("isotropic", "")
        made = allowed.step_ratio(self.ledger.step_rate())
        if made > 1.0 and self._time_rtol > TIGHTEST:
            return Wish("tighter", f"steps made {made:.2g} times the allowed error")
        return None

    def allowed(self, leg: Leg, state: np.ndarray, time: float) -> Allowed:
        """How fast errors may grow at a state."""
        balance = self.ledger.balance
        assert balance is not None
        left = self._left(leg, state, time)
        return allowed_growth(self._asked, balance, self.ledger.by_grid, left, leg.closed)

    def _left(self, leg: Leg, state: np.ndarray, time: float) -> float:
        """Collisions' time left."""
        return left_of(leg, state, self._times[-1] - time)

    def _follow(self, leg: Leg, state: np.ndarray, time: float, wish: Wish) -> At:
        """Do what a state asks for."""
        relaxing = self.ledger.balance.relaxing if self.ledger.balance else 1.0
        here = At(leg, state, time)
        if wish.kind == "tighter":
            self._time_rtol = max(self._time_rtol / 10, TIGHTEST)
            last = self.outcome.legs[-1]
            self.outcome.legs.append(
                Stretch(time, last.solver, self._time_rtol, f"smaller steps: {wish.reason}")
            )
            return here
        allowed = self.allowed(leg, state, time)
        if wish.kind == "isotropic":
            switched = self._chooser.isotropic(leg, state, time, allowed)
            if switched is None:
                self._no_switch_before = self.ledger.clock + RELAXED / 2 / relaxing
                return here
            return self._enter(switched, time)
        if self._beginning is None:
            other = self._chooser.again(leg, state, time, allowed, wish.reason)
            early = self.ledger.clock <= EARLY * self._chooser.left
            again = self._from_the_start(leg, wish, time) if other.needed and early else None
            return again or self._enter(other, time)
        reason = _begun_again(leg, wish, time)
        further = time > self._reached or not self._grown
        self._reached, self._grown = max(time, self._reached), further
        if not further:
            self._time_rtol = max(self._time_rtol / 10, TIGHTEST)
        chosen = self._chooser.begin_again(self._beginning.origin, leg, allowed, further, reason)
        if chosen is None:
            self._on_the_last = True
            self.outcome.needed = wish.reason
            return here
        return self._enter_again(self._beginning, chosen)

    def _output(
        self, leg: Leg, point: Point, f: np.ndarray, values: dict[str, Any], passing: Change
    ) -> None:
        """Record an output."""
        record, place = self.outcome.record, leg.place(point.state, point.time)
        if not self._first:
            self._first = values
        total = self.ledger.total(passing)
        signs = health.state_of_health(f, values, self._first, leg.grid)
        signs |= {"temperature": total.temperature, "a2": total.a2}
        record.health.append(signs)
        record.warn(point.time, health.warnings(signs))
        for name, error in self.ledger.estimates(passing).items():
            self.outcome.sources[name].append(error)
        if leg.gas.rescaled:
            moments = leg.frame.record(values, point.state)
        else:
            moments = physical_moments(values, 1.0, place.velocity + values["velocity"])
        record.times.append(point.time)
        record.moments.append(moments)


def _begun_again(leg: Leg, wish: Wish, time: float) -> str:
    """The reason of a leg that begins again, from what went wrong on another."""
    solver = leg.solver
    return f"begun again: on N={solver.N}, R={solver.R:.3g} {wish.reason} at t = {time:.3g}"


def left_of(leg: Leg, state: np.ndarray, time_left: float) -> float:
    """Collisions' time left at a state, as if its temperature stayed."""
    frame = leg.frame
    f = frame.density(state)
    T = float(moment_values(f, leg.grid)["temperature"])
    exponent = leg.gas.scene.kernel.exponent
    rates = leg.rates(frame.restitution(state))
    m = leg.grid.velocity_moments(f)
    cooling = -2.0 * rates.energy(f) / float(np.trace(m.pressure))
    unit = frame.scale(state) ** exponent
    heating = frame.heating(state, T)
    return unit * clock_left(max(cooling, 0.0) * unit, heating * unit, exponent, time_left)
