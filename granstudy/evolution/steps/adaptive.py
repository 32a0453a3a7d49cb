"""Steps of sizes that adapt to their error, with outputs at their ends or inside them (docs/method.md §3)."""

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from granstudy.evolution.schemes import Scheme, Step
from granstudy.evolution.steps.interpolation import End, hermite, hermite_error
from granstudy.evolution.steps.points import MeasuredEquation, Point, Position, StoppedError
from granstudy.support.errors import RAN_AWAY

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

FIRST_PART = 0.3
"""First step of a scheme with an interpolant, in parts of the one that would just keep the tolerance."""

FASTEST = 1.8
"""Step at most, over the time of the fastest part that the step has excited (`AdaptiveSteps._largest`). Steps
of `dopri54` that only their error limits settle at about 2.2, where noise neither grows nor fades."""

TOO_SMALL = (
    "the step fell to {h:.1e} and its error is still above time_rtol: take a larger time_rtol, or a "
    "larger N and R"
)
"""Reason of a run that stopped because no step was small enough."""


class AdaptiveSteps:
    """Steps whose estimated relative error is at most ``rtol``, with outputs at given ``times``.

    The first of the times is that of the first state; a step ends at the last one. A scheme with an
    interpolant gives the others inside its steps. The steps of other schemes end there.

    Attributes
    ----------
    outputs : int
        Number of outputs, the start included.
    outputs_inside : bool
        Whether outputs lie inside steps: where the scheme has an interpolant.
    accepted, rejected : int
        Steps made, and steps taken back, so far.
    evaluations : int
        Rates computed so far.
    position : Position
        Where the steps stand, once they march; to be asked for at the end of a step.
    """

    def __init__(
        self, equation: MeasuredEquation, scheme: Scheme, times: np.ndarray, rtol: float
    ) -> None:
        self._equation, self._scheme = equation, scheme
        self._times, self._rtol = times, rtol
        self.outputs_inside = scheme.interpolation_error > 0.0
        self._ends = times[-1:] if self.outputs_inside else times[1:]
        self.outputs = len(times)
        self.accepted = self.rejected = self.evaluations = 0
        self._first: np.ndarray | None = None
        self._before = 1.0
        self._start: End | None = None
        self._at: tuple[float, np.ndarray, float | None]

    def march(self, state: np.ndarray) -> Iterator[Point]:
        """Every state, from the first one on.

        Raises
        ------
        StoppedError
            If no step is small enough.
        """
        self._at = float(self._times[0]), state, None
        if self.outputs_inside:
            # Whoever sees a state that runs away stops.
            with suppress(*RAN_AWAY):
                self._first = self._rate(state)
        yield Point(0, self._at[0], state, True, rate=self._first)
        yield from self.resume(self.position)

    @property
    def position(self) -> Position:
        """Where the steps stand."""
        t, state, h = self._at
        kept = self._first, self._before, self.rejected, self.evaluations
        return Position(self.accepted, t, state, h, *kept, self._start)

    def resume(self, position: Position) -> Iterator[Point]:
        """Every state after a position; raises as `march`."""
        self.accepted, t, state, h, self._first, self._before = position[:6]
        self.rejected, self.evaluations = position.rejected, position.evaluations
        self._start = position.start
        if h is None:
            h = self._first_step(state)
        for target in self._ends[self._ends > t]:
            while t < target:
                rest = target - t
                # Two equal steps, where one would end little before an output.
                tried = rest if h >= rest else min(h, rest / 2)
                made, error = self._try(state, tried)
                following = self._next_step(tried, error)
                largest = self._largest(made, state, error)
                if made is None or error > 1.0:
                    self.rejected += 1
                    h = min(following, largest)
                    if h < SMALLEST_STEP * max(t, self._times[1]):
                        raise StoppedError(self.accepted + 1, t, TOO_SMALL.format(h=h))
                    continue
                h = min(max(following, h) if tried < h else following, largest)
                self.accepted += 1
                # Where steps are as large as their error allows, an unstable part grows to the tolerance.
                new = self._equation.symmetrise(made.state)
                end = float(target) if tried == rest else t + tried
                error_made = self._scheme.error(error * self._rtol)
                outputs = self._times[(self._times > t) & (self._times < end)]
                if len(outputs):
                    yield from self._inside(outputs, (t, state), (end, new), made, error_made)
                if self.outputs_inside:
                    assert self._first is not None
                    self._start = End(t, state, self._first)
                error_made *= (end - outputs[-1]) / (end - t) if len(outputs) else 1.0
                difference, t, state, self._first = made.difference, end, new, made.last
                made = None  # its rates are not kept beside those of the next step
                self._at = t, state, h
                is_output = bool(np.any(self._times == t))
                yield Point(
                    self.accepted, t, state, is_output, difference, self._first, share=error_made
                )

    def _inside(
        self,
        times: np.ndarray,
        start: tuple[float, np.ndarray],
        end: tuple[float, np.ndarray],
        made: Step,
        error_made: float,
    ) -> Iterator[Point]:
        """The outputs inside a step, whose error is taken to grow evenly.

        They are found from the ends of two steps; in the first step, by the scheme's interpolant.
        """
        scheme, h = self._scheme, end[0] - start[0]
        assert self._first is not None and made.last is not None and made.inside is not None
        ends = [End(*start, self._first), End(*end, made.last)]
        if self._start is not None:
            ends.insert(0, self._start)
        before = start[0]
        for time in map(float, times):
            theta = (time - start[0]) / h
            if self._start is None:
                state = made.inside(theta)
                passing = scheme.interpolation_error * 16.0 * (theta * (1.0 - theta)) ** 2
            else:
                state = hermite(ends, time)
                passing = error_made * hermite_error(ends, time) / scheme.remainder
            yield Point(
                self.accepted,
                time,
                self._equation.symmetrise(state),
                True,
                made.difference,
                inside=True,
                share=error_made * (time - before) / h,
                passing=passing,
            )
            before = time

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
                self._first = self._rate(state)
            self.evaluations += self._scheme.evaluations - 1
            made = self._scheme.step(self._equation, state, h, self._first)
            error = self._equation.relative_size(made.difference, state) / self._rtol
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

    def _largest(self, made: Step | None, state: np.ndarray, error: float) -> float:
        """Largest step after a step, with whose fastest part noise fades.

        The rate of that part is |k − k'|/|y − y'| of two states y and y' for the end of the step (E. Hairer &
        G. Wanner, Solving Ordinary Differential Equations II, §IV.2). Their difference is where the solution
        is rough, and more so once there is noise: without this limit, noise would grow to the tolerance.
        """
        if made is None or made.twins is None or error < LEAST_ERROR:
            return np.inf
        apart, rate = (self._equation.relative_size(change, state) for change in made.twins)
        return FASTEST * apart / rate if rate > 0.0 else np.inf

    def _first_step(self, state: np.ndarray) -> float:
        """The first step to try, at most the time to where it has to end."""
        if self._first is None:
            self._first = self._rate(state)
        change = self._equation.relative_size(self._first, state)
        part, order = FIRST_CHANGE, self._scheme.error_order + 1
        if self.outputs_inside:
            part = FIRST_PART * (self._rtol / self._scheme.difference) ** (1.0 / order)
        return float(part / max(change, part / (self._ends[0] - self._times[0])))

    def _rate(self, state: np.ndarray) -> np.ndarray:
        """The rate with which every step from a state begins."""
        self.evaluations += 1
        return self._scheme.first(self._equation, state)
