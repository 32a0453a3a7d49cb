"""Collision kernels B(|g|): variable hard spheres, from Maxwell molecules to hard spheres."""

from dataclasses import dataclass

from granstudy.support.checks import check_positive, is_real, plain
from granstudy.velocity.space import check_dim
from granstudy.velocity.sphere import sphere_area


@dataclass(frozen=True)
class VHS:
    """Variable hard spheres, B = strength · |g|^exponent (paper eq. 18).

    Attributes
    ----------
    exponent : float
        λ, from 0 (Maxwell molecules) to 1 (hard spheres).
    strength : float
        C_λ > 0.

    Raises
    ------
    ValueError
        If a field has another value.
    """

    exponent: float
    strength: float

    def __post_init__(self) -> None:
        if not (is_real(self.exponent) and 0.0 <= self.exponent <= 1.0):
            raise ValueError(f"exponent={self.exponent!r}: must be a number between 0 and 1")
        check_positive("strength", self.strength)
        for field in ("exponent", "strength"):
            object.__setattr__(self, field, float(plain(getattr(self, field))))


def maxwell(dim: int) -> VHS:
    """Maxwell molecules of unit total cross-section: B = 1/(2π) in 2D, 1/(4π) in 3D."""
    check_dim(dim)
    return VHS(exponent=0.0, strength=1.0 / sphere_area(dim))


def hard_spheres(dim: int) -> VHS:
    """Hard spheres: B = |g|/(2π) in 2D, |g|/(4π) in 3D."""
    check_dim(dim)
    return VHS(exponent=1.0, strength=1.0 / sphere_area(dim))
