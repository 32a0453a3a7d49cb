"""The velocity grid: nodes, wavenumbers, box and truncation radius (docs/method.md §2)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

BOX_RATIO = (3.0 + np.sqrt(2.0)) / 4.0
"""L / R: the smallest box in which the truncated collisions of a ball of radius R/2 do not overlap."""


@dataclass(frozen=True)
class VelocityGrid:
    """Cell-centred nodes v_j = −L + (j + ½)·2L/N in each of ``dim`` directions.

    Attributes
    ----------
    dim : int
        Velocity dimension d, 2 or 3.
    N : int
        Points in each dimension, even, at least 4.
    R : float
        Truncation radius of the relative velocity; the density's support ball has radius R/2.

    Raises
    ------
    ValueError
        If a field is outside what is stated above.
    """

    dim: int
    N: int
    R: float

    def __post_init__(self) -> None:
        if self.dim not in (2, 3):
            raise ValueError(f"dim={self.dim!r}: allowed are 2 and 3")
        if isinstance(self.N, bool) or not isinstance(self.N, (int, np.integer)):
            raise ValueError(f"N={self.N!r}: must be an even integer of at least 4")
        if self.N < 4 or self.N % 2:
            raise ValueError(f"N={self.N}: must be an even integer of at least 4")
        if not (np.isfinite(self.R) and self.R > 0):
            raise ValueError(f"R={self.R!r}: must be a positive number")

    @property
    def L(self) -> float:
        """Half-width of the box D_L = [−L, L]^d."""
        return float(BOX_RATIO * self.R)

    @property
    def spacing(self) -> float:
        """Distance 2L/N of neighbouring nodes."""
        return 2.0 * self.L / self.N

    @property
    def cell(self) -> float:
        """Volume of a cell, the weight of the discrete velocity integral."""
        return self.spacing**self.dim

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape (N,)*dim of a density on this grid."""
        return (self.N,) * self.dim

    @cached_property
    def nodes(self) -> np.ndarray:
        """The N nodes of one dimension."""
        return -self.L + (np.arange(self.N) + 0.5) * self.spacing

    @cached_property
    def wavenumbers(self) -> np.ndarray:
        """The N integer wavenumbers of one dimension in FFT order, −N/2 unpaired."""
        return np.fft.fftfreq(self.N, 1.0 / self.N).round().astype(np.int64)

    def velocities(self) -> tuple[np.ndarray, ...]:
        """Velocity components as ``dim`` arrays that broadcast to `shape`."""
        return tuple(np.meshgrid(*(self.nodes,) * self.dim, indexing="ij", sparse=True))

    def wavenumber_squared(self, half: bool = False) -> np.ndarray:
        """|k|² as integers, on the full spectrum or on the half a real transform stores."""
        k = self.wavenumbers
        axes = [k] * (self.dim - 1) + [k[: self.N // 2 + 1] if half else k]
        return sum(np.square(m) for m in np.meshgrid(*axes, indexing="ij", sparse=True))
