"""Initial densities by name; each is a function of the velocity components and knows its symmetry."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from granstudy.symmetry import Symmetry, stabiliser


class InitialDensity(Protocol):
    """Anything that maps d broadcastable velocity components to density values.

    It may declare its ``symmetry``, a `granstudy.Symmetry` or the name of one.
    """

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """Density at the velocities ``v``."""


def _squared(v: Sequence[np.ndarray], centre: Sequence[float]) -> np.ndarray:
    """|v − centre|²."""
    return np.asarray(sum((vi - ci) ** 2 for vi, ci in zip(v, centre, strict=True)))


@dataclass(frozen=True)
class Bkw2D:
    """Isotropic scene of the paper's eq. 49, K = 1 − exp(−1/16)/2, T0 = 1."""

    dim: ClassVar[int] = 2
    symmetry: ClassVar[str] = "full"

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = 1/(2πK²) e^{−v²/2K} (2K − 1 + (1−K)/(2K) v²)."""
        K = 1.0 - np.exp(-1.0 / 16.0) / 2.0
        v2 = _squared(v, (0.0, 0.0))
        return np.exp(-v2 / (2 * K)) * (2 * K - 1 + (1 - K) / (2 * K) * v2) / (2 * np.pi * K**2)


@dataclass(frozen=True)
class Bkw3D:
    """Isotropic scene of the paper's eq. 51, K = 1 − exp(−6.5/6), T0 = 1."""

    dim: ClassVar[int] = 3
    symmetry: ClassVar[str] = "full"

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = 1/(2(2πK)^{3/2}) e^{−v²/2K} ((5K−3)/K + (1−K)/K² v²)."""
        K = 1.0 - np.exp(-6.5 / 6.0)
        v2 = _squared(v, (0.0, 0.0, 0.0))
        return (
            np.exp(-v2 / (2 * K))
            * ((5 * K - 3) / K + (1 - K) / K**2 * v2)
            / (2 * (2 * np.pi * K) ** 1.5)
        )


@dataclass(frozen=True)
class DoubleWell2D:
    """Two beams, the paper's eq. 50: ρ = 1, u = 0, T0 = 1.425."""

    dim: ClassVar[int] = 2
    symmetry: ClassVar[str] = "exchange"

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = (0.8/π) (e^{−4|v−(2,2)|²} + e^{−|v+(½,½)|²})."""
        return (0.8 / np.pi) * (
            np.exp(-4.0 * _squared(v, (2.0, 2.0))) + np.exp(-_squared(v, (-0.5, -0.5)))
        )


@dataclass(frozen=True)
class DoubleWell3D:
    """Two beams in 3D (published version of the paper, Tables 6 to 8)."""

    dim: ClassVar[int] = 3
    symmetry: ClassVar[str] = "exchange"

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = 4/(5π^{3/2}) (e^{−16^{1/3}|v−(2,2,2)|²} + e^{−|v+(½,½,½)|²})."""
        return (0.8 / np.pi**1.5) * (
            np.exp(-(16.0 ** (1.0 / 3.0)) * _squared(v, (2.0, 2.0, 2.0)))
            + np.exp(-_squared(v, (-0.5, -0.5, -0.5)))
        )


THREE_GAUSSIANS = (
    (0.5, (0.6, -0.3, 0.2), (0.9, 0.7, 0.6)),
    (0.3, (-0.7, 0.5, -0.6), (0.6, 0.8, 1.0)),
    (0.2, (-0.45, 0.0, 0.4), (0.7, 1.0, 0.65)),
)
"""Mass, centre and variances along the axes of each Gaussian of `ThreeGaussians3D`."""


@dataclass(frozen=True)
class ThreeGaussians3D:
    """A density without symmetry: three anisotropic Gaussians, ρ = 1, u = 0, T0 = 0.979."""

    dim: ClassVar[int] = 3
    symmetry: ClassVar[str] = "none"

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = Σ_j m_j Π_i (2πs_ji)^{−1/2} exp(−(v_i − c_ji)²/(2s_ji)), by `THREE_GAUSSIANS`."""
        f = np.zeros(np.broadcast_shapes(*(vi.shape for vi in v)))
        for mass, centre, variances in THREE_GAUSSIANS:
            scaled = [vi / np.sqrt(s) for vi, s in zip(v, variances, strict=True)]
            place = [c / np.sqrt(s) for c, s in zip(centre, variances, strict=True)]
            norm = np.sqrt(np.prod(2 * np.pi * np.array(variances)))
            f += mass / norm * np.exp(-_squared(scaled, place) / 2)
        return f


@dataclass(frozen=True)
class Maxwellian:
    """Maxwellian of unit density with bulk ``velocity`` and ``temperature``."""

    dim: int
    temperature: float = 1.0
    velocity: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.temperature) and self.temperature > 0):
            raise ValueError(f"temperature={self.temperature!r}: must be a positive number")
        velocity = (0.0,) * self.dim if self.velocity is None else tuple(self.velocity)
        if len(velocity) != self.dim or not np.all(np.isfinite(velocity)):
            raise ValueError(f"velocity={self.velocity!r}: must be {self.dim} finite numbers")
        object.__setattr__(self, "velocity", velocity)

    @property
    def symmetry(self) -> Symmetry:
        """What leaves the bulk velocity as it is."""
        assert self.velocity is not None
        return stabiliser(Symmetry.named(self.dim, "full"), self.velocity)

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """f0 = (2πT)^{−d/2} exp(−|v−u|²/(2T))."""
        T = self.temperature
        assert self.velocity is not None
        return np.exp(-_squared(v, self.velocity) / (2 * T)) / (2 * np.pi * T) ** (self.dim / 2)
