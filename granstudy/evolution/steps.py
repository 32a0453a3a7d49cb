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
    """

    def __init__(self, equation: MeasuredEquation, scheme: Scheme, dt: float, steps: int) -> None:
        self._equation, self._scheme = equation, scheme
        self._dt, self._steps = dt, steps
        self.outputs = steps + 1

    def march(self, state: np.ndarray) -> Iterator[Point]:
        """Every state, from the first one at t = 0 on.

        Raises
        ------
        StoppedError
            If a state is not finite.
        """
        yield Point(0, 0.0, state, True)
        for step in range(1, self._steps + 1):
            try:
                first = self._scheme.first(self._equation, state)
                made = self._scheme.step(self._equation, state, self._dt, first)
                size = self._equation.relative_size(made.error, state)
                error, state = self._scheme.error(size) * made.error, made.state
            except RAN_AWAY:
                raise StoppedError(step, step * self._dt, health.NOT_FINITE) from None
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

    def march(self, state: np.ndarray) -> Iterator[Point]:
        """Every state, from the first one on.

        Raises
        ------
        StoppedError
            If no step is small enough.
        """
        t = float(self._times[0])
        yield Point(0, t, state, True)
        h = self._first_step(state)
        for target in self._times[1:]:
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
