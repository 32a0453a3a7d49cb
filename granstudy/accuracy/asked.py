"""The accuracy of an answer, as it is asked for."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from granstudy.support.checks import is_real

DEFAULT = 1e-3
"""Accuracy of the temperature where nothing is asked for."""

A2_OVER_TEMPERATURE = 10.0
"""Accuracy of a2 over that of the temperature, where only the latter is given."""

FINEST, COARSEST = 1e-10, 0.1
"""Accuracies that can be asked for: estimates of errors are of first order, and see ten digits at most."""

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

    Raises
    ------
    ValueError
        If a value is not a number between `FINEST` and `COARSEST`.
    """

    temperature: float
    a2: float

    def __post_init__(self) -> None:
        for name in QUANTITIES:
            value = getattr(self, name)
            if not is_real(value) or not FINEST <= value <= COARSEST:
                raise ValueError(
                    f"accuracy.{name}={value!r}: must be a number between {FINEST:g} and {COARSEST:g}"
                )
            object.__setattr__(self, name, float(value))

    @classmethod
    def of(cls, asked: Any = None) -> "Accuracy":
        """The accuracy asked for: a number (that of T), a mapping, an `Accuracy`, or None (`DEFAULT`).

        Where only one of T and a2 is named, a2's is `A2_OVER_TEMPERATURE` times T's, at most `COARSEST`.

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
        named = dict(asked)
        for name, value in named.items():
            if not is_real(value):
                raise ValueError(f"accuracy.{name}={value!r}: must be a number")
        if "a2" not in named:
            named["a2"] = min(A2_OVER_TEMPERATURE * named["temperature"], COARSEST)
        if "temperature" not in named:
            named["temperature"] = max(named["a2"] / A2_OVER_TEMPERATURE, FINEST)
        return cls(**named)

    def describe(self) -> dict[str, float]:
        """The accuracy as plain data."""
        return {"temperature": self.temperature, "a2": self.a2}

    def coordinates(self) -> dict[str, float]:
        """The parameters of a run that it is, by name (`granstudy.datasets.parameters`)."""
        return {"accuracy": self.temperature, "a2_accuracy": self.a2}
