"""Steps of one size (docs/method.md §3)."""

from collections.abc import Iterator

import numpy as np

from granstudy.evolution.schemes import Scheme
from granstudy.evolution.steps.points import MeasuredEquation, Point, Position, StoppedError
from granstudy.support.errors import RAN_AWAY
from granstudy.trust import health


class FixedSteps:
    """Steps of one size; each is an output.

    Attributes
    ----------
    outputs : int
        Number of outputs, the start included.
    outputs_inside : bool
        Whether outputs lie inside steps: no.
    position : Position
        Where the steps stand, once they march.
    """

    outputs_inside = False

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
                size = self._equation.relative_size(made.difference, state)
                share, state = self._scheme.error(size), made.state
            except RAN_AWAY as away:
                raise StoppedError(step, step * self._dt, health.ran_away(away)) from None
            self.position = Position(step, step * self._dt, state)
            yield Point(step, step * self._dt, state, True, made.difference, share=share)

    def equation_changed(self) -> None:
        """Note that rates have changed; no rate is kept here."""
