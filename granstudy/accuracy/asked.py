"""The accuracy of an answer, as it is asked for, and the times beside it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.evolution.times import TimeSettings
from granstudy.model.solver import Solver

DEFAULT = 1e-3
"""Accuracy of the temperature where nothing is asked for."""

STAND_IN = 1e-3
"""Tolerance of steps that stands for the run's own."""

CHOSEN = ("dt", "time_rtol", "frame", "scheme", "conserve")
"""Settings of time that the run chooses."""

QUANTITIES = ("temperature", "a2")
"""What an accuracy can be asked of."""


@dataclass(frozen=True)
class Accuracy:
    """Largest errors that a run, or a state, may have at any of its outputs.

    Attributes
    ----------
    temperature : float
        Error of T relative to T.
    a2 : float
        Error of the kurtosis excess a2.
    """

    temperature: float
    a2: float

    @classmethod
    def of(cls, asked: Any = None) -> "Accuracy":
        """The accuracy asked for: a number (that of T), a mapping, an `Accuracy`, or None (`DEFAULT`).

        Where only one of T and a2 is named, a2's is 10 times T's.

        Raises
        ------
        ValueError
            For any other value.
        """
        if isinstance(asked, cls):
            return asked
        if asked is None:
            asked = DEFAULT
        if not isinstance(asked, Mapping):
            asked = {"temperature": asked}
        unknown = sorted(set(asked) - set(QUANTITIES))
        if unknown or not asked:
            raise ValueError(
                f"accuracy={dict(asked)!r}: must be a number, or a mapping with the keys "
                f"{' and '.join(QUANTITIES)}"
            )
        solver = Solver(accuracy=asked.get("temperature"), a2_accuracy=asked.get("a2"))
        return cls.of_solver(solver)

    @classmethod
    def of_solver(cls, solver: Solver) -> "Accuracy":
        """The accuracy that a solver asks for."""
        assert solver.accuracy is not None
        assert solver.a2_accuracy is not None
        return cls(solver.accuracy, solver.a2_accuracy)

    @property
    def solver(self) -> Solver:
        """The solver that asks for it."""
        return Solver(accuracy=self.temperature, a2_accuracy=self.a2)

    def describe(self) -> dict[str, float]:
        """The accuracy as plain data."""
        return {"temperature": self.temperature, "a2": self.a2}

    def coordinates(self) -> dict[str, float]:
        """The parameters of a run that it is, by name (`granstudy.datasets.parameters`)."""
        return {"accuracy": self.temperature, "a2_accuracy": self.a2}


def accurate_times(
    t_final: float,
    times: Sequence[float] | np.ndarray | None = None,
    save_every: int | None = None,
    **chosen: Any,
) -> TimeSettings:
    """The times of a run to an accuracy, checked.

    Raises
    ------
    ValueError
        For a setting that the run chooses itself, and for densities to be kept, whose grid would change.
    """
    for name, value in chosen.items():
        if name not in CHOSEN:
            raise TypeError(f"unexpected setting of time {name!r}")
        if value is not None and value != () and not (name == "frame" and value == "fixed"):
            raise ValueError(
                f"{name}={value!r}: not beside accuracy, which chooses it; leave one of them out"
            )
    if save_every is not None:
        raise ValueError(
            f"save_every={save_every!r}: not beside accuracy, as the grid changes on the way; give a solver"
        )
    return TimeSettings(t_final, time_rtol=STAND_IN, times=times)
