"""The radial grid: isotropic densities by their values at N speeds (docs/method.md §7)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import j1, jn_zeros

from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import (
    Term,
    VelocityMoments,
    check_dim,
    check_node_count,
    check_radius,
    check_shape,
)
from granstudy.velocity.sphere import sphere_area, sphere_mean, sphere_mean_slope

BALL_RATIO = 1.3
"""L / R. The series repeats f beyond L with the other sign. A density that decays like e^{−v²/2T} disturbs
itself by e^{−(L−R/2)²/T} = e^{−0.64 R²/T}, far less than the e^{−R²/4T} that truncation at R leaves out."""


@dataclass(frozen=True)
class RadialGrid:
    """An isotropic density as a Fourier–Bessel series on the ball |v| < L.

    With M(x) the mean of e^{iσ·x} over the unit sphere (sin x / x in 3D, J0 in 2D) and z_1 < z_2 < ... its
    zeros (mπ in 3D),

        f(v) = Σ_{m=1}^N c_m M(k_m|v|),   k_m = z_m/L,   given by f_j = f(r_j),   r_j = L z_j/z_{N+1}.

    Each term is the mean of the plane waves with |k| = k_m: N nodes resolve what a Cartesian grid of 1.7 N
    points in a dimension does at the same R. Integrals over velocity by
    the quadrature with these nodes that is exact for entire functions of exponential type up to
    2z_{N+1}/L, as f² is (Frappier & Olivier, Math. Comp. 60, 303 (1993); in 3D the trapezoidal rule):

        ∫f dv ≈ Σ_j w_j f_j,   w_j = 4π h r_j², h = L/(N+1) in 3D,   w_j = 4π L²/(z_{N+1} J1(z_j))² in 2D.

    Attributes
    ----------
    dim : int
        Velocity dimension d, 2 or 3.
    N : int
        Radial nodes and modes, at least 4.
    R : float
        Truncation radius of the relative velocity; L = 1.3 R.

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
        check_node_count(self.N)
        check_radius(self.R)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape (N,) of a density on this grid."""
        return (self.N,)

    @property
    def axes(self) -> tuple[str, ...]:
        """Name of a density's one axis."""
        return ("r",)

    @property
    def L(self) -> float:
        """Radius of the ball on which densities live."""
        return float(BALL_RATIO * self.R)

    @property
    def spacing(self) -> float:
        """π/k_N, the spacing of a Cartesian grid with the same largest wavenumber."""
        return float(np.pi / self.wavenumbers[-1])

    @property
    def measure(self) -> np.ndarray:
        """Weights of the integral over velocity."""
        return self.weights

    @cached_property
    def nodes(self) -> np.ndarray:
        """The N speeds r_j, increasing, inside (0, L)."""
        return self.L * self._zeros[:-1] / self._zeros[-1]

    @cached_property
    def wavenumbers(self) -> np.ndarray:
        """The N wavenumbers k_m, increasing, in units of 1/velocity."""
        return self._zeros[:-1] / self.L

    @cached_property
    def weights(self) -> np.ndarray:
        """Weights w_j of the integral over velocity."""
        if self.dim == 3:
            return sphere_area(3) * self.nodes**2 * self.L / (self.N + 1)
        return 4.0 * np.pi * (self.L / (self._zeros[-1] * j1(self._zeros[:-1]))) ** 2

    @cached_property
    def analysis(self) -> np.ndarray:
        """Matrix from the values f_j to the coefficients c_m."""
        return np.linalg.inv(self._synthesis)

    @property
    def largest_laplacian(self) -> float:
        """Largest |eigenvalue| of the Laplacian, k_N²."""
        return float(self.wavenumbers[-1] ** 2)

    @cached_property
    def largest_dilation(self) -> float:
        """Largest |eigenvalue| of `dilation`."""
        return float(np.max(np.abs(np.linalg.eigvals(self._dilation))))

    def velocities(self) -> tuple[np.ndarray, ...]:
        """Velocities (r_j, 0, ...), which stand for all directions: ``dim`` arrays of shape (N,)."""
        return (self.nodes, *(np.zeros(self.N),) * (self.dim - 1))

    def coordinates(self) -> dict[str, Any]:
        """The speeds r_j, and the weights w_j of the velocity integral along them."""
        return {
            "r": ("r", self.nodes, {"long_name": "radial speed |v|", "units": "1"}),
            "r_weight": (
                "r",
                self.weights,
                {"long_name": "weight of the integral over velocity", "units": "1"},
            ),
        }

    def velocity_moments(self, f: np.ndarray) -> VelocityMoments:
        """Moments of the isotropic density: u = 0, the pressure tensor a multiple of the identity."""
        density, second, fourth = self._powers @ f
        return VelocityMoments(
            density=density,
            momentum=np.zeros(self.dim),
            energy=0.5 * second,
            pressure=second / self.dim * np.eye(self.dim),
            fourth=fourth,
        )

    def invariants(self) -> dict[str, np.ndarray]:
        """1 and ½r² at the nodes, shape (1, N); no momentum, which is 0 for every isotropic density."""
        return {
            "mass": np.ones((1, self.N)),
            "momentum": np.zeros((0, self.N)),
            "energy": 0.5 * self.nodes[np.newaxis] ** 2,
        }

    def edge(self, f: np.ndarray) -> float:
        """|f| at the outermost node."""
        return float(abs(f[-1]))

    def spectral_tail(self, f: np.ndarray) -> float:
        """Part of ∫f² in the upper quarter of the modes."""
        power = (self.analysis @ f) ** 2 * self._mode_norms
        return float(power[3 * self.N // 4 :].sum() / power.sum())

    def laplacian(self, f: np.ndarray) -> np.ndarray:
        """Δv f: the multiplier −k_m² on the coefficients, at the nodes."""
        return self._laplacian @ f

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) f over the ``terms`` (φ, f)."""
        eigenvalues = -(self.wavenumbers**2)
        return self._synthesis @ sum(phi(x * eigenvalues) * (self.analysis @ f) for phi, f in terms)

    def gradient(self, f: np.ndarray) -> list[np.ndarray]:
        """No direction in which an isotropic density can move."""
        return []

    def dilation(self, f: np.ndarray) -> np.ndarray:
        """∇v·(v f) = d f + r f'(r) (docs/method.md §5)."""
        return self._dilation @ f

    def mode_values(self, speeds: np.ndarray) -> np.ndarray:
        """M(k_m r) of the N modes (last axis) at given speeds."""
        return sphere_mean(self.dim, np.multiply.outer(speeds, self.wavenumbers))

    def evaluate(self, f: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """The density at any speeds: its Fourier–Bessel series, 0 from L on."""
        check_shape(f, self)
        speeds = np.asarray(speeds, dtype=float)
        values = self.mode_values(speeds) @ (self.analysis @ f)
        return np.where(speeds < self.L, values, 0.0)

    def to_cartesian(self, f: np.ndarray, grid: VelocityGrid) -> np.ndarray:
        """The density at the nodes of a Cartesian grid, shape ``grid.shape``.

        Raises
        ------
        ValueError
            If the grid is of another dimension, or ``f`` of another shape than (N,).
        """
        self._check_grid(grid)
        squared = sum(np.square(v) for v in grid.velocities())
        # Nodes on one sphere share their value; rounding tells their |v|² apart in the last digits.
        key = np.rint(np.asarray(squared) / (grid.spacing / 2) ** 2).astype(np.int64)
        shells, place = np.unique(key, return_inverse=True)
        speeds = grid.spacing / 2 * np.sqrt(shells)
        return self.evaluate(f, speeds)[place].reshape(grid.shape)

    def from_cartesian(self, F: np.ndarray, grid: VelocityGrid) -> np.ndarray:
        """Average over directions of a density on a Cartesian grid, at the speeds r_j.

        Exact for what the Cartesian grid represents: the mean of the interpolating Σ_k F̂_k e^{iπk·v/L} over
        the sphere |v| = r is Σ_k F̂_k M(π|k|r/L). Speeds beyond the box see its periodic images; they
        get 0.

        Raises
        ------
        ValueError
            If the grid is of another dimension, or ``F`` of another shape than its own.
        """
        self._check_grid(grid)
        check_shape(F, grid)
        # The phase that the first node, at −L + h/2 in every direction, takes off.
        phase = np.exp(-1j * np.pi / grid.L * grid.wavenumbers * grid.nodes[0])
        F_hat = np.fft.fftn(F) / F.size
        for axis in range(grid.dim):
            F_hat *= phase.reshape([-1 if i == axis else 1 for i in range(grid.dim)])
        shells, place = np.unique(grid.wavenumber_squared(), return_inverse=True)
        c = np.bincount(place.ravel(), weights=F_hat.real.ravel())
        k = np.pi / grid.L * np.sqrt(shells)
        values = sphere_mean(self.dim, np.multiply.outer(self.nodes, k)) @ c
        return np.where(self.nodes < grid.L, values, 0.0)

    @cached_property
    def _zeros(self) -> np.ndarray:
        """The first N+1 zeros of M."""
        count = self.N + 1
        return jn_zeros(0, count) if self.dim == 2 else np.pi * np.arange(1.0, count + 1)

    @cached_property
    def _synthesis(self) -> np.ndarray:
        """Matrix from the coefficients c_m to the values f_j."""
        return self.mode_values(self.nodes)

    @cached_property
    def _laplacian(self) -> np.ndarray:
        return (self._synthesis * -(self.wavenumbers**2)) @ self.analysis

    @cached_property
    def _dilation(self) -> np.ndarray:
        """D + r d/dr, with x M'(x) at x = k_m r_j for r dM/dr."""
        slopes = sphere_mean_slope(self.dim, np.multiply.outer(self.nodes, self.wavenumbers))
        return self.dim * np.eye(self.N) + slopes @ self.analysis

    @cached_property
    def _powers(self) -> np.ndarray:
        """Weights of ∫f, ∫|v|² f and ∫|v|⁴ f."""
        return self.weights * self.nodes ** np.array([[0], [2], [4]])

    @cached_property
    def _mode_norms(self) -> np.ndarray:
        """∫ M(k_m|v|)² dv over the ball, by the grid's own quadrature."""
        return self.weights @ self.mode_values(self.nodes) ** 2

    def _check_grid(self, grid: VelocityGrid) -> None:
        if grid.dim != self.dim:
            raise ValueError(f"Cartesian grid has dim {grid.dim}: the radial grid has {self.dim}")
