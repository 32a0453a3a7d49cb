"""The Cartesian velocity grid: nodes, wavenumbers, box and truncation radius (docs/method.md §2)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.fft

from granstudy.velocity.differences import central_differences
from granstudy.velocity.space import (
    Term,
    VelocityMoments,
    check_dim,
    check_node_memory,
    check_point_count,
    check_radius,
)

BOX_RATIO = (3.0 + np.sqrt(2.0)) / 4.0
"""L/R of the smallest box in which truncated collisions within a ball of radius R/2 do not overlap."""


@dataclass(frozen=True)
class VelocityGrid:
    """Cell-centred nodes v_j = −L + (j + ½)·2L/N, j = 0..N−1, in each of ``dim`` directions.

    Attributes
    ----------
    dim : int
        Velocity dimension d, 2 or 3.
    N : int
        Points in each dimension, even, at least 4.
    R : float
        Truncation radius of the relative velocity. The density is supported in a ball of radius R/2.

    Raises
    ------
    ValueError
        If a field is outside what is stated above.
    """

    dim: int
    N: int
    R: float

    def __post_init__(self) -> None:
        check_dim(self.dim)
        check_point_count(self.N)
        check_radius(self.R)
        check_node_memory(self.N, int(self.N) ** self.dim)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape (N,)*dim of a density on this grid."""
        return (self.N,) * self.dim

    @property
    def three_axis_shape(self) -> tuple[int, int, int]:
        """Shape (N, N', N) of a density with three axes in both dimensions: N' = N in 3D, 1 in 2D."""
        return (self.N, self.N if self.dim == 3 else 1, self.N)

    @property
    def half_spectrum_shape(self) -> tuple[int, int, int]:
        """Shape (N, N', N/2+1) of what a real transform makes of `three_axis_shape`."""
        return (*self.three_axis_shape[:2], self.N // 2 + 1)

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of a density's axes: vx, vy[, vz]."""
        return ("vx", "vy", "vz")[: self.dim]

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
        """Volume of a cell, the weight of a node in the integral over velocity."""
        return self.spacing**self.dim

    @property
    def measure(self) -> float:
        """Weight of every node in the integral over velocity: the volume of a cell."""
        return self.cell

    @cached_property
    def nodes(self) -> np.ndarray:
        """The N nodes of one dimension."""
        return -self.L + (np.arange(self.N) + 0.5) * self.spacing

    @cached_property
    def wavenumbers(self) -> np.ndarray:
        """The N integer wavenumbers of one dimension in FFT order. The mode −N/2 is unpaired."""
        return np.fft.fftfreq(self.N, 1.0 / self.N).round().astype(np.int64)

    @property
    def largest_laplacian(self) -> float:
        """Largest |eigenvalue| of the Laplacian, d (πN/2L)²."""
        return float(self.dim * (np.pi / self.spacing) ** 2)

    @cached_property
    def largest_dilation(self) -> float:
        """Largest |eigenvalue| of `dilation`: d times the largest one of one dimension."""
        return float(self.dim * np.max(np.abs(np.linalg.eigvals(self._dilation))))

    def velocities(self) -> tuple[np.ndarray, ...]:
        """Velocity components as ``dim`` arrays that broadcast to `shape`."""
        return tuple(np.meshgrid(*(self.nodes,) * self.dim, indexing="ij", sparse=True))

    def coordinates(self) -> dict[str, Any]:
        """The nodes of every axis, labelled for xarray."""
        return {
            axis: (axis, self.nodes, {"long_name": f"velocity {axis[1]}", "units": "1"})
            for axis in self.axes
        }

    def wavenumber_squared(self, half: bool = False) -> np.ndarray:
        """|k|² as integers, on the full spectrum or on the half that a real transform stores."""
        k = self.wavenumbers
        axes = [k] * (self.dim - 1) + [k[: self.N // 2 + 1] if half else k]
        return sum(np.square(m) for m in np.meshgrid(*axes, indexing="ij", sparse=True))

    def velocity_moments(self, f: np.ndarray) -> VelocityMoments:
        """Moments of a density by the midpoint rule (paper eqs. 19 to 21)."""
        v = self.velocities()
        density = f.sum() * self.cell
        momentum = np.array([(vi * f).sum() for vi in v]) * self.cell
        c = [vi - ui for vi, ui in zip(v, momentum / density, strict=True)]
        return VelocityMoments(
            density=density,
            momentum=momentum,
            energy=0.5 * sum((vi**2 * f).sum() for vi in v) * self.cell,
            pressure=np.array([[(ci * cj * f).sum() for cj in c] for ci in c]) * self.cell,
            fourth=(sum(ci**2 for ci in c) ** 2 * f).sum() * self.cell,
        )

    def invariants(self) -> dict[str, np.ndarray]:
        """1, the d components of v, and ½|v|² at the nodes: shapes (n, *shape) with n = 1, d, 1."""
        v = np.array(np.broadcast_arrays(*self.velocities()))
        return {
            "mass": np.ones((1, *self.shape)),
            "momentum": v,
            "energy": 0.5 * np.square(v).sum(axis=0, keepdims=True),
        }

    def edge(self, f: np.ndarray) -> float:
        """Largest |f| on the box's faces."""
        return max(float(np.max(np.abs(np.take(f, [0, -1], axis=i)))) for i in range(self.dim))

    def spectral_tail(self, f: np.ndarray) -> float:
        """Part of ∫f² in the modes of which a |k_i| lies in the upper quarter of the wavenumbers."""
        power = np.abs(scipy.fft.rfftn(f)) ** 2
        power[..., 1:-1] *= 2.0
        high = np.abs(self.wavenumbers) > 3 * self.N / 8
        low = power[np.ix_(*(~high,) * (self.dim - 1), ~high[: self.N // 2 + 1])]
        return float(1.0 - low.sum() / power.sum())

    def laplacian(self, f: np.ndarray) -> np.ndarray:
        """Δv f of a real density, by the multiplier −(π|k|/L)² (docs/method.md §3)."""
        return scipy.fft.irfftn(self._laplacian * scipy.fft.rfftn(f), s=self.shape)

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) f over the ``terms`` (φ, f) for real densities f."""
        spectrum = sum(phi(x * self._laplacian) * scipy.fft.rfftn(f) for phi, f in terms)
        return scipy.fft.irfftn(spectrum, s=self.shape)

    def gradient(self, f: np.ndarray) -> list[np.ndarray]:
        """∂f/∂v_i for every i, by local differences (`granstudy.velocity.differences`)."""
        return [_along(self._difference, f, axis) for axis in range(self.dim)]

    def dilation(self, f: np.ndarray) -> np.ndarray:
        """∇v·(v f), by local differences in conservative form (docs/method.md §5)."""
        return np.asarray(sum(_along(self._dilation, f, axis) for axis in range(self.dim)))

    @cached_property
    def _laplacian(self) -> np.ndarray:
        return -((np.pi / self.L) ** 2) * self.wavenumber_squared(half=True)

    @cached_property
    def _difference(self) -> np.ndarray:
        """Matrix of d/dv on the nodes of one dimension."""
        return central_differences(self.N, self.spacing)

    @cached_property
    def _dilation(self) -> np.ndarray:
        """Matrix of d/dv v·."""
        return self._difference * self.nodes


def _along(matrix: np.ndarray, f: np.ndarray, axis: int) -> np.ndarray:
    """``matrix`` times ``f`` along one axis.

    One product for each plane: BLAS hands a single larger one to threads of its own, which wait for each
    other wherever the cores are busy. *Measured*: 24 ms for 0.2 ms at N = 48, six processes on two cores.
    """
    if axis == f.ndim - 1:
        return f @ matrix.T
    if axis == f.ndim - 2:
        return matrix @ f
    return np.moveaxis(matrix @ np.moveaxis(f, 0, -2), -2, 0)
