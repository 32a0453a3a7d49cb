"""Steps through time: all of one size, or of sizes that adapt to their error (docs/method.md §3)."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol

import numpy as np

from granstudy.evolution.schemes import Equation, Scheme, Step
from granstudy.support.errors import RAN_AWAY
from granstudy.trust import health

SAFETY = 0.9
"""Factor on every proposed step, so that few steps are rejected."""

LEAST_CHANGE, LARGEST_CHANGE = 0.2, 5.0
"""Smallest and largest factor from one step to the next."""

INTEGRAL, PROPORTIONAL = 0.7, 0.4
"""Exponents of the PI control of E. Hairer & G. Wanner, Solving Ordinary Differential Equations II, §IV.2.
The step after h is h · SAFETY · error^{−0.7/k} · (error before)^{0.4/k}, k the order of the error."""

LEAST_ERROR = 1e-4
"""Least error over the tolerance that the control reckons with."""

SMALLEST_STEP = 1e-12
"""Smallest step over the time reached, or over the time of the first output where this is later."""

FIRST_CHANGE = 0.01
"""First step tried, in parts of the time in which the state changes by its own size."""

TOO_SMALL = (
    "the step fell to {h:.1e} and its error is still above time_rtol: take a larger time_rtol, or a "
    "larger N and R"
)
"""Reason of a run that stopped because no step was small enough."""


class MeasuredEquation(Equation, Protocol):
    """An equation that measures changes of its state."""

    def relative_size(self, change: np.ndarray, state: np.ndarray) -> float:
        """Size of a change of the state, relative to the state itself."""

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The state with the symmetry restored that round-off disturbs."""


class Point(NamedTuple):
    """The state after a step.

    Attributes
    ----------
    step : int
        Number of the step, 0 at the start.
    time : float
    state : ndarray
    is_output : bool
        Whether the state is an output.
    error : ndarray or None
        Estimated error of the step, a change of the state; None at the start.
    rate : ndarray or None
        Rate of change at the state, where the scheme has it; else None.
    """

    step: int
    time: float
    state: np.ndarray
    is_output: bool
    error: np.ndarray | None = None
    rate: np.ndarray | None = None


class Position(NamedTuple):
    """Where steps stand between two of them: all that the steps to come depend on.

    Attributes
    ----------
    step : int
    time : float
    state : ndarray
    next_step : float or None
        Of steps that adapt: the size to try next; None where none was chosen yet.
    first : ndarray or None
        The first rate of the next step, where it is kept.
    error_before : float
        Error over the tolerance of the step before, for the PI control.
    rejected, evaluations : int
        As of `AdaptiveSteps`.
    """

    step: int
    time: float
    state: np.ndarray
    next_step: float | None = None
    first: np.ndarray | None = None
    error_before: float = 1.0
    rejected: int = 0
    evaluations: int = 0


class StoppedError(Exception):
    """A run cannot go on; the message says when and why."""

    def __init__(self, step: int, time: float, reason: str) -> None:
        super().__init__(f"step {step}, t = {time:g}: {reason}")


class FixedSteps:
    """Steps of one size; each is an output.

    Attributes
    ----------
    outputs : int
        Number of outputs, the start included.
    position : Position
        Where the steps stand, once they march.
    """

    def __init__(self, equation: MeasuredEquation, scheme: Scheme, dt: float, steps: int) -> None:
        self._equation, self._scheme = equation, scheme
        self._dt, self._steps = dt, steps
        self.outputs = steps + 1
        self.position: Position

    def march(self, state: np.ndarray) -> Iterator[Point]:
        """Every state, from the first one at t = 0 on.

        Raises
        ------
        StoppedError
            If a state is not finite.
        """
        self.position = Position(0, 0.0, state)
        yield Point(0, 0.0, state, True)
        yield from self.resume(self.position)

    def resume(self, position: Position) -> Iterator[Point]:
        """Every state after a position; raises as `march`."""
        state = position.state
        for step in range(position.step + 1, self._steps + 1):
            try:
                first = self._scheme.first(self._equation, state)
                made = self._scheme.step(self._equation, state, self._dt, first)
                size = self._equation.relative_size(made.error, state)
                error, state = self._scheme.error(size) * made.error, made.state
            except RAN_AWAY as away:
                raise StoppedError(step, step * self._dt, health.ran_away(away)) from None
            self.position = Position(step, step * self._dt, state)
            yield Point(step, step * self._dt, state, True, error)

    def equation_changed(self) -> None:
        """Note that rates have changed; no rate is kept here."""


class AdaptiveSteps:
    """Steps whose estimated relative error is at most ``rtol``; they hit the ``times`` of outputs.

    The first of the times is that of the first state.

    Attributes
    ----------
    outputs : int
        Number of outputs, the start included.
    accepted, rejected : int
        Steps made, and steps taken back, so far.
    evaluations : int
        Rates computed so far.
    position : Position
        Where the steps stand, once they march.
    """

    def __init__(
        self, equation: MeasuredEquation, scheme: Scheme, times: np.ndarray, rtol: float
    ) -> None:
        self._equation, self._scheme = equation, scheme
        self._times, self._rtol = times, rtol
        self.outputs = len(times)
        self.accepted = self.rejected = self.evaluations = 0
        self._first: np.ndarray | None = None
        self._before = 1.0
        self._at: tuple[float, np.ndarray, float | None]

    def march(self, state: np.ndarray) -> Iterator[Point]:
        """Every state, from the first one on.

        Raises
        ------
        StoppedError
            If no step is small enough.
        """
        self._at = float(self._times[0]), state, None
        yield Point(0, self._at[0], state, True)
        yield from self.resume(self.position)

    @property
    def position(self) -> Position:
        """Where the steps stand."""
        t, state, h = self._at
        kept = self._first, self._before, self.rejected, self.evaluations
        return Position(self.accepted, t, state, h, *kept)

    def resume(self, position: Position) -> Iterator[Point]:
        """Every state after a position; raises as `march`."""
        self.accepted, t, state, h, self._first, self._before = position[:6]
        self.rejected, self.evaluations = position.rejected, position.evaluations
        if h is None:
            h = self._first_step(state)
        for target in self._times[self._times > t]:
            while t < target:
                rest = target - t
                # Two equal steps, where one would end little before an output.
                tried = rest if h >= rest else min(h, rest / 2)
                made, error = self._try(state, tried)
                following = self._next_step(tried, error)
                if made is None or error > 1.0:
                    self.rejected += 1
                    h = following
                    if h < SMALLEST_STEP * max(t, self._times[1]):
                        raise StoppedError(self.accepted + 1, t, TOO_SMALL.format(h=h))
                    continue
                h = max(following, h) if tried < h else following
                hit = tried == rest
                t = float(target) if hit else t + tried
                # Steps are as large as their error allows: an unstable part would grow to the tolerance.
                size = error * self._rtol
                state = self._equation.symmetrise(made.state)
                self.accepted += 1
                self._first = made.last
                self._at = t, state, h
                made_error = self._scheme.error(size) * made.error
                yield Point(self.accepted, t, state, hit, made_error, made.last)

    def equation_changed(self) -> None:
        """Note that rates have changed: the first rate of the next step is computed anew."""
        self._first = None

    def describe(self) -> dict[str, int]:
        """The counts as plain data."""
        return {
            "accepted": self.accepted,
            "rejected": self.rejected,
            "evaluations": self.evaluations,
        }

    def _try(self, state: np.ndarray, h: float) -> tuple[Step | None, float]:
        """A step and its error over the tolerance; None and ∞ where a state was not finite."""
        try:
            if self._first is None:
                self._first = self._scheme.first(self._equation, state)
                self.evaluations += 1
            self.evaluations += self._scheme.evaluations - 1
            made = self._scheme.step(self._equation, state, h, self._first)
            error = self._equation.relative_size(made.error, state) / self._rtol
        except RAN_AWAY:
            return None, np.inf
        return made, error if np.isfinite(error) else np.inf

    def _next_step(self, h: float, error: float) -> float:
        """The step to try next, after a step ``h`` with the given error over the tolerance."""
        k = self._scheme.error_order + 1
        error = max(error, LEAST_ERROR)
        factor = SAFETY * error ** (-INTEGRAL / k) * self._before ** (PROPORTIONAL / k)
        if error > 1.0:
            return h * max(LEAST_CHANGE, min(SAFETY, factor))
        self._before = error
        return h * min(LARGEST_CHANGE, max(LEAST_CHANGE, factor))

    def _first_step(self, state: np.ndarray) -> float:
        """The first step to try, at most the time of the first output."""
        self._first = self._scheme.first(self._equation, state)
        self.evaluations += 1
        change = self._equation.relative_size(self._first, state)
        return FIRST_CHANGE / max(change, FIRST_CHANGE / (self._times[1] - self._times[0]))
