"""The radial grid: isotropic densities by their values at N speeds (docs/method.md §7)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from scipy.special import j1, jn_zeros

from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.differences import radial_dilation_2d, radial_dilation_3d
from granstudy.velocity.space import (
    Term,
    VelocityMoments,
    check_dim,
    check_node_count,
    check_node_memory,
    check_radius,
    check_shape,
)
from granstudy.velocity.sphere import sphere_area, sphere_mean

BALL_RATIO = 1.3
"""L/R. Beyond L the series repeats f with the other sign. A density that decays like e^{−v²/2T} disturbs
itself by e^{−(L−R/2)²/T} = e^{−0.64 R²/T}, far less than the e^{−R²/4T} that truncation at R leaves out."""


@dataclass(frozen=True)
class RadialGrid:
    """A grid of N speeds, on which an isotropic density is a Fourier–Bessel series on the ball |v| < L.

    M(x) is the mean of e^{iσ·x} over the unit sphere (sin x / x in 3D, J0 in 2D), z_1 < z_2 < ... are its
    zeros (mπ in 3D). A density is given by its values f_j = f(r_j):

        f(v) = Σ_{m=1}^N c_m M(k_m|v|),   k_m = z_m/L,   r_j = L z_j/z_{N+1}.

    Each term is the mean of the plane waves with |k| = k_m. N nodes resolve as much as a Cartesian grid of
    1.7 N points per dimension at the same R.

    Integrals over velocity take the quadrature with these nodes that is exact for entire functions of
    exponential type up to 2z_{N+1}/L, such as f² (Frappier & Olivier, Math. Comp. 60, 303 (1993)). In 3D it
    is the trapezoidal rule:

        ∫f dv ≈ Σ_j w_j f_j,   3D: w_j = 4π h r_j², h = L/(N+1),   2D: w_j = 4π L²/(z_{N+1} J1(z_j))².

    Attributes
    ----------
    dim : int
        Velocity dimension d, 2 or 3.
    N : int
        Number of nodes and of modes, at least 4.
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
        check_node_memory(self.N, int(self.N) ** 2)

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
        """π/k_N: the spacing of a Cartesian grid with the same largest wavenumber."""
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
        """Velocities (r_j, 0, ...), each standing for all directions: ``dim`` arrays of shape (N,)."""
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
        """Moments of an isotropic density: u = 0, and the pressure tensor is a multiple of the identity."""
        density, second, fourth = self._powers @ f
        return VelocityMoments(
            density=density,
            momentum=np.zeros(self.dim),
            energy=0.5 * second,
            pressure=second / self.dim * self._identity,
            fourth=fourth,
        )

    def invariants(self) -> dict[str, np.ndarray]:
        """1 and ½r² at the nodes, shape (1, N). Momentum is 0 for every isotropic density: shape (0, N)."""
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
        """Δv f at the nodes, by the multiplier −k_m² on the coefficients."""
        return self._laplacian @ f

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) f over the ``terms`` (φ, f)."""
        eigenvalues = -(self.wavenumbers**2)
        return self._synthesis @ sum(phi(x * eigenvalues) * (self.analysis @ f) for phi, f in terms)

    def gradient(self, f: np.ndarray) -> list[np.ndarray]:
        """An empty list, as an isotropic density can move in no direction."""
        return []

    def dilation(self, f: np.ndarray) -> np.ndarray:
        """∇v·(v f) = d f + r f'(r), by local differences in conservative form (docs/method.md §5)."""
        return self._dilation @ f

    def mode_values(self, speeds: np.ndarray) -> np.ndarray:
        """M(k_m r) of the N modes (last axis) at given speeds."""
        return sphere_mean(self.dim, np.multiply.outer(speeds, self.wavenumbers))

    def evaluate(self, f: np.ndarray, speeds: np.ndarray) -> np.ndarray:
        """The density at any speeds: its Fourier–Bessel series below L, 0 from L on."""
        check_shape(f, self)
        speeds = np.asarray(speeds, dtype=float)
        values = self.mode_values(speeds) @ (self.analysis @ f)
        return np.where(speeds < self.L, values, 0.0)

    def to_cartesian(self, f: np.ndarray, grid: VelocityGrid) -> np.ndarray:
        """The density at the nodes of a Cartesian grid, shape ``grid.shape``.

        Raises
        ------
        ValueError
            If the grid has another dimension, or ``f`` another shape than (N,).
        """
        self._check_grid(grid)
        squared = sum(np.square(v) for v in grid.velocities())
        # Nodes on one sphere share their value, although rounding makes their |v|² differ in the last digits.
        key = np.rint(np.asarray(squared) / (grid.spacing / 2) ** 2).astype(np.int64)
        shells, place = np.unique(key, return_inverse=True)
        speeds = grid.spacing / 2 * np.sqrt(shells)
        return self.evaluate(f, speeds)[place].reshape(grid.shape)

    def from_cartesian(self, F: np.ndarray, grid: VelocityGrid) -> np.ndarray:
        """Average over directions of a density ``F`` on a Cartesian grid, at the speeds r_j.

        The average is exact for what the Cartesian grid represents: the mean of Σ_k F̂_k e^{iπk·v/L} over
        the sphere |v| = r is Σ_k F̂_k M(π|k|r/L). At speeds beyond the box, where the series is periodic,
        the result is 0.

        Raises
        ------
        ValueError
            If the grid has another dimension, or ``F`` another shape than the grid.
        """
        self._check_grid(grid)
        check_shape(F, grid)
        # The transform takes phases from the first node, −L + h/2 in every direction. Move them to v = 0.
        phase = np.exp(-1j * np.pi / grid.L * grid.wavenumbers * grid.nodes[0])
        F_hat = np.fft.fftn(F) / F.size
        for axis in range(grid.dim):
            F_hat *= phase.reshape([-1 if i == axis else 1 for i in range(grid.dim)])
        shells, place = np.unique(grid.wavenumber_squared(), return_inverse=True)
        c = np.bincount(place.ravel(), weights=F_hat.real.ravel())
        k = np.pi / grid.L * np.sqrt(shells)
        values = sphere_mean(self.dim, np.multiply.outer(self.nodes, k)) @ c
        return np.where(self.nodes < grid.L, values, 0.0)

    @property
    def _zeros(self) -> np.ndarray:
        """The first N+1 zeros of M, increasing."""
        return _first_zeros(self.dim, self.N + 1)

    @cached_property
    def _synthesis(self) -> np.ndarray:
        """Matrix from the coefficients c_m to the values f_j."""
        return self.mode_values(self.nodes)

    @cached_property
    def _laplacian(self) -> np.ndarray:
        return (self._synthesis * -(self.wavenumbers**2)) @ self.analysis

    @cached_property
    def _dilation(self) -> np.ndarray:
        """Matrix of d + r d/dr."""
        if self.dim == 3:
            return radial_dilation_3d(self.nodes)
        return radial_dilation_2d(self.nodes, self.weights)

    @cached_property
    def _powers(self) -> np.ndarray:
        """Weights of ∫f, ∫|v|² f and ∫|v|⁴ f."""
        return self.weights * self.nodes ** np.array([[0], [2], [4]])

    @cached_property
    def _identity(self) -> np.ndarray:
        return np.eye(self.dim)

    @cached_property
    def _mode_norms(self) -> np.ndarray:
        """∫ M(k_m|v|)² dv over the ball, by the grid's own quadrature."""
        return self.weights @ self.mode_values(self.nodes) ** 2

    def _check_grid(self, grid: VelocityGrid) -> None:
        if grid.dim != self.dim:
            raise ValueError(f"Cartesian grid has dim {grid.dim}: the radial grid has {self.dim}")


@cache
def _first_zeros(dim: int, count: int) -> np.ndarray:
    """The first zeros of M: those of J0 in 2D, mπ in 3D."""
    zeros = jn_zeros(0, count) if dim == 2 else np.pi * np.arange(1.0, count + 1)
    zeros.flags.writeable = False
    return zeros
