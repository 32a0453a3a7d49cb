"""Restitution e of a collision: a constant, or a law of the normal impact speed |g·ω|."""

import dataclasses
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from granstudy.support.checks import answer, is_real, plain

Restitution = float | Callable[[np.ndarray], np.ndarray]
"""A constant 0 ≤ e ≤ 1, or a function of the normal impact speed |g·ω| (the paper's Remark 2)."""

C1 = math.gamma(0.6) * math.sqrt(math.pi) / (2.0**0.2 * 5.0**0.4 * math.gamma(2.1))
"""Coefficient C₁ = Γ(3/5)√π / (2^{1/5} 5^{2/5} Γ(21/10)) = 1.15345 of viscoelastic spheres (Brilliantov &
Pöschel 2004, eq. 3.22)."""


@dataclass(frozen=True)
class Viscoelastic:
    """Restitution of viscoelastic spheres, e = 1 − C₁ A v^{1/5} + ⅗ C₁² A² v^{2/5}.

    v is the normal impact speed |g·ω|, and C₁ = 1.15345. The law is the first three terms of the series of
    Brilliantov & Pöschel, *Kinetic Theory of Granular Gases* (2004), eq. 3.22; A stands for their A κ^{2/5}.
    The law has the minimum 7/12: e stays in [0, 1] until C₁ A v^{1/5} exceeds 5/3.

    Attributes
    ----------
    A : float
        Dissipation constant of the material, at least 0; A = 0 is elastic.

    Raises
    ------
    ValueError
        If A is negative or not finite.
    """

    A: float

    def __post_init__(self) -> None:
        if not (is_real(self.A) and 0.0 <= self.A < math.inf):
            raise ValueError(f"A={self.A!r}: must be a non-negative number")
        object.__setattr__(self, "A", float(plain(self.A)))

    def __call__(self, impact_speed: np.ndarray) -> np.ndarray:
        """Restitution at the normal impact speeds."""
        s = C1 * self.A * np.asarray(impact_speed) ** 0.2
        return 1.0 - s + 0.6 * s**2


LAWS: dict[str, type[Viscoelastic]] = {"viscoelastic": Viscoelastic}
"""Restitution laws by name; a new law is a new row."""


def law_parameters(name: str) -> list[str]:
    """Names of the parameters of a named law."""
    return [field.name for field in dataclasses.fields(LAWS[name])]


@dataclass(frozen=True)
class ScaledRestitution:
    """Restitution law in velocities of the unit ``scale``: e(scale · |g·ω|)."""

    restitution: Callable[[np.ndarray], np.ndarray]
    scale: float

    def __call__(self, impact_speed: np.ndarray) -> np.ndarray:
        """Restitution at the scaled normal impact speeds."""
        return self.restitution(self.scale * np.asarray(impact_speed))


def restitution_at(law: Callable[[np.ndarray], np.ndarray], speeds: np.ndarray) -> np.ndarray:
    """A law at normal impact speeds, an array of their shape.

    Raises
    ------
    ValueError
        If the law fails there, or returns anything but real numbers of that shape.
    """
    values = answer(f"restitution={law!r}", law, speeds)
    if values.shape != np.shape(speeds):
        raise ValueError(
            f"restitution={law!r}: must return an array of the shape it is given, got {values.shape} for "
            f"{np.shape(speeds)}"
        )
    return values


def check_restitution(restitution: Restitution, largest_speed: float = 1.0) -> None:
    """Raise ValueError unless ``restitution`` lies in [0, 1].

    Parameters
    ----------
    restitution : float or callable
    largest_speed : float
        Impact speed up to which a law is checked, at 257 speeds from 0 on.
    """
    if callable(restitution):
        speeds = np.linspace(0.0, largest_speed, 257)
        values = restitution_at(restitution, speeds)
        if not np.all((values >= 0.0) & (values <= 1.0)):
            worst = speeds[np.argmax(np.abs(np.nan_to_num(values, nan=np.inf) - 0.5))]
            raise ValueError(
                f"restitution={restitution!r}: must lie between 0 and 1 for impact speeds up to "
                f"{largest_speed:g}; does not at {worst:g}"
            )
    elif not is_real(restitution):
        raise ValueError(
            f"restitution={restitution!r}: must be a number between 0 and 1 or a function of the "
            "normal impact speed"
        )
    elif not 0.0 <= restitution <= 1.0:
        raise ValueError(f"restitution={restitution!r}: must lie between 0 and 1")
