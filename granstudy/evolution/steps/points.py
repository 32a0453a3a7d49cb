"""What steps yield, where they stand between two of them, and what they need of an equation."""

from typing import NamedTuple, Protocol

import numpy as np

from granstudy.evolution.schemes import Equation
from granstudy.evolution.steps.interpolation import End


class MeasuredEquation(Equation, Protocol):
    """An equation that measures changes of its state."""

    def relative_size(self, change: np.ndarray, state: np.ndarray) -> float:
        """Size of a change of the state, relative to the state itself."""

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The state with the symmetry restored that round-off disturbs."""


class Point(NamedTuple):
    """The state at the end of a step, or at an output inside it.

    Attributes
    ----------
    step : int
        Number of the step, 0 at the start.
    time : float
    state : ndarray
    is_output : bool
        Whether the state is an output.
    difference : ndarray or None
        Difference of the step from one of lower order, a change of the state; None at the start.
    rate : ndarray or None
        Rate of change at the state, where the scheme has it; else None.
    inside : bool
        Whether the state lies inside the step, by interpolation.
    share : float
        Estimated error that was made since the point before, over ``difference``.
    passing : float
        Estimated error of the interpolation over ``difference``; the states that follow do not have it.
    """

    step: int
    time: float
    state: np.ndarray
    is_output: bool
    difference: np.ndarray | None = None
    rate: np.ndarray | None = None
    inside: bool = False
    share: float = 0.0
    passing: float = 0.0


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
        As of `granstudy.evolution.steps.adaptive.AdaptiveSteps`.
    start : End or None
        The start of the last step, where the next one interpolates from it.
    """

    step: int
    time: float
    state: np.ndarray
    next_step: float | None = None
    first: np.ndarray | None = None
    error_before: float = 1.0
    rejected: int = 0
    evaluations: int = 0
    start: End | None = None


class StoppedError(Exception):
    """A run cannot go on; the message says when and why."""

    def __init__(self, step: int, time: float, reason: str) -> None:
        super().__init__(f"step {step}, t = {time:g}: {reason}")
