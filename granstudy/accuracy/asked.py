"""The accuracy of an answer, as it is asked for."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from granstudy.model.solver import Solver

DEFAULT = 1e-3
"""Accuracy of the temperature where nothing is asked for."""

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
