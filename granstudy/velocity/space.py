"""The protocol of a velocity grid, Cartesian or radial, and checks of its parameters.

Moments, health checks, time integration and datasets know a grid by this protocol alone.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from granstudy.support.checks import check_positive, is_count
from granstudy.support.machine import check_memory

INVARIANTS = ("mass", "momentum", "energy")
"""Quantities that elastic collisions conserve, the keys of `VelocitySpace.invariants`."""

MANY = 10**7
"""Numbers up to which a grid is made without asking how much memory there is."""

SMALLEST_R, LARGEST_R = 1e-40, 1e40
"""Radii between which the seventh power, a fourth moment in 3D, is a number."""

Term = tuple[Callable[[np.ndarray], np.ndarray], np.ndarray]
"""A function φ of the Laplacian's eigenvalues, and the density that φ(Δ) acts on."""


class VelocityMoments(NamedTuple):
    """Integrals over velocity of a density f on a grid (paper eqs. 19 to 21)."""

    density: float
    """ρ = ∫f dv"""
    momentum: np.ndarray
    """∫v f dv, shape (d,)"""
    energy: float
    """½∫|v|² f dv"""
    pressure: np.ndarray
    """∫(v−u)(v−u) f dv, shape (d, d), u the bulk velocity"""
    fourth: float
    """∫|v−u|⁴ f dv"""


class VelocitySpace(Protocol):
    """A grid of velocities: Cartesian (`VelocityGrid`) or radial (`RadialGrid`).

    Attributes
    ----------
    dim : int
        Velocity dimension d.
    shape : tuple of int
        Shape of a density.
    axes : tuple of str
        Names of a density's axes: ``vx, vy[, vz]``, or ``r``.
    R : float
        Truncation radius of the relative velocity.
    L : float
        Largest velocity component or speed.
    spacing : float
        π over the largest wavenumber. Narrower features are not resolved.
    measure : float or ndarray
        Weights of the nodes in the integral over velocity.
    largest_laplacian, largest_dilation : float
        Largest |eigenvalue| of `laplacian` and of `dilation`.
    """

    @property
    def dim(self) -> int: ...  # noqa: D102
    @property
    def shape(self) -> tuple[int, ...]: ...  # noqa: D102
    @property
    def axes(self) -> tuple[str, ...]: ...  # noqa: D102
    @property
    def R(self) -> float: ...  # noqa: D102
    @property
    def L(self) -> float: ...  # noqa: D102
    @property
    def spacing(self) -> float: ...  # noqa: D102
    @property
    def measure(self) -> float | np.ndarray: ...  # noqa: D102
    @property
    def largest_laplacian(self) -> float: ...  # noqa: D102
    @property
    def largest_dilation(self) -> float: ...  # noqa: D102

    def velocities(self) -> tuple[np.ndarray, ...]:
        """Velocity components of the nodes, ``dim`` arrays that broadcast to `shape`."""

    def coordinates(self) -> dict[str, Any]:
        """Labelled coordinates of a density's axes, as xarray takes them."""

    def velocity_moments(self, f: np.ndarray) -> VelocityMoments:
        """Moments of a density by the grid's quadrature."""

    def invariants(self) -> dict[str, np.ndarray]:
        """The quantities `INVARIANTS` as functions of velocity at the nodes, shapes (n, *shape)."""

    def edge(self, f: np.ndarray) -> float:
        """Largest |f| at the border of the grid, where a density wraps around."""

    def spectral_tail(self, f: np.ndarray) -> float:
        """Part of ∫f² in the upper quarter of the wavenumbers."""

    def laplacian(self, f: np.ndarray) -> np.ndarray:
        """Δv f, exact for what the grid represents."""

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) f over the ``terms`` (φ, f). φ takes the Laplacian's eigenvalues times x."""

    def gradient(self, f: np.ndarray) -> list[np.ndarray]:
        """The components of ∇v f, without those that vanish for every density on the grid."""

    def dilation(self, f: np.ndarray) -> np.ndarray:
        """∇v·(v f), whose moments are exact except for what leaves the grid at the border."""


def check_dim(dim: int) -> None:
    """Raise ValueError unless ``dim`` is a velocity dimension."""
    if not is_count(dim) or dim not in (2, 3):
        raise ValueError(f"dim={dim!r}: allowed are 2 and 3")


def check_point_count(N: int) -> None:
    """Raise ValueError unless ``N`` can be the number of points per dimension."""
    if isinstance(N, bool) or not isinstance(N, (int, np.integer)) or N < 4 or N % 2:
        raise ValueError(f"N={N!r}: must be an even integer of at least 4")


def check_node_count(N: int) -> None:
    """Raise ValueError unless ``N`` can be the number of radial nodes."""
    if isinstance(N, bool) or not isinstance(N, (int, np.integer)) or N < 4:
        raise ValueError(f"N={N!r}: must be an integer of at least 4, the number of radial nodes")


def check_node_memory(N: int, numbers: int) -> None:
    """Raise ValueError where memory cannot hold so many numbers, the least that a grid of N keeps."""
    if numbers > MANY:
        check_memory(f"N={N}", 8 * numbers, "a grid must fit; take a smaller N")


def check_radius(R: float) -> None:
    """Raise ValueError unless ``R`` can be the truncation radius."""
    check_positive("R", R)
    if not SMALLEST_R <= float(R) <= LARGEST_R:
        raise ValueError(f"R={R!r}: must lie between {SMALLEST_R:g} and {LARGEST_R:g}")


def check_shape(f: np.ndarray, grid: VelocitySpace) -> None:
    """Raise ValueError unless ``f`` is an array of the shape of a density on ``grid``."""
    if not hasattr(f, "shape"):
        raise ValueError(f"density is a {type(f).__name__}: must be an array of shape {grid.shape}")
    if np.shape(f) != grid.shape:
        raise ValueError(f"density has shape {np.shape(f)}: the grid's is {grid.shape}")
