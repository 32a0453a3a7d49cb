"""The energy that collisions take, from all pairs of a density: what the energy of Q has to balance.

A collision at relative velocity g with normal component u|g| takes the kinetic energy (1−e²)u²|g|²/4, so that,
whatever the method, the truncation or the quadrature (docs/method.md §4),

    dE/dt = −½ ∫∫ K(|v−v*|) f f* dv dv*,   K(ρ) = |S^{d−1}| C_λ ρ^{2+λ} mean over σ of (1−e²)u²/4

The mean is (1−e²)/8 for a constant e.
"""

import numpy as np
import scipy.fft

from granstudy.collision.variable_restitution import deflections
from granstudy.grid import VelocityGrid
from granstudy.kernel import sphere_area
from granstudy.radial_grid import RadialGrid
from granstudy.scene import Scene
from granstudy.velocity_space import VelocitySpace

ANGLES = 64
"""Nodes of the mean over the angle between two speeds."""


def loss_per_pair(scene: Scene, speeds: np.ndarray) -> np.ndarray:
    """K(ρ) at relative speeds ρ: the energy that two particles lose a unit time, twice."""
    u, weights = deflections(scene.dim, 0.0)
    if callable(scene.restitution):
        e = np.asarray(scene.restitution(np.multiply.outer(speeds, u)), dtype=float)
    else:
        e = np.full(len(u), float(scene.restitution))
    mean = ((1.0 - e**2) * u**2 / 4.0) @ weights
    kernel = scene.kernel
    return sphere_area(scene.dim) * kernel.strength * speeds ** (2.0 + kernel.exponent) * mean


class Dissipation:
    """dE/dt of a density by collisions: a quadratic form, its weights computed once."""

    def __init__(self, scene: Scene, grid: VelocitySpace) -> None:
        if isinstance(grid, RadialGrid):
            self._form: RadialForm | CartesianForm = RadialForm(scene, grid)
        else:
            assert isinstance(grid, VelocityGrid)
            self._form = CartesianForm(scene, grid)

    def __call__(self, f: np.ndarray) -> float:
        """dE/dt = −½ ∫∫ K f f*, of a real density."""
        return -0.5 * self._form(f)


class CartesianForm:
    """Σ K(|v_i−v_j|) f_i f_j over all pairs of nodes, by a transform on twice the box.

    The sum is the integral to the accuracy of the midpoint rule: spectral but for the kink of ρ^{2+λ} at
    ρ = 0, of which remains O(h^{d+2+λ}), h the spacing.
    """

    def __init__(self, scene: Scene, grid: VelocityGrid) -> None:
        self._size = (2 * grid.N,) * grid.dim
        # Differences of nodes in FFT order: nothing wraps around in twice the box.
        g = np.fft.fftfreq(2 * grid.N, 0.5 / grid.N) * grid.spacing
        squared = sum(
            np.square(a) for a in np.meshgrid(*(g,) * grid.dim, indexing="ij", sparse=True)
        )
        distinct, place = np.unique(np.rint(squared / grid.spacing**2), return_inverse=True)
        K = loss_per_pair(scene, grid.spacing * np.sqrt(distinct))[place].reshape(self._size)
        # ∫∫ K f f* = Σ_k K̂_k |f̂_k|²; a half spectrum counts its inner modes twice.
        weights = scipy.fft.rfftn(K).real * grid.cell**2 / K.size
        weights[..., 1:-1] *= 2.0
        self._weights = weights

    def __call__(self, f: np.ndarray) -> float:
        """The double integral."""
        f_hat = scipy.fft.rfftn(f, s=self._size)
        return float(np.vdot(self._weights, f_hat.real**2 + f_hat.imag**2))


class RadialForm:
    """Σ w_i w_j f_i f_j times the mean of K over the angle between the velocities."""

    def __init__(self, scene: Scene, grid: RadialGrid) -> None:
        x, w = np.polynomial.legendre.leggauss(ANGLES)
        if grid.dim == 2:
            x = np.cos(np.pi / 2 * (x + 1))
        r = grid.nodes[:, None]
        mean = np.zeros((grid.N, grid.N))
        for cosine, weight in zip(x, w / 2, strict=True):
            g = np.sqrt(np.maximum(r**2 + r.T**2 - 2.0 * cosine * r * r.T, 0.0))
            mean += weight * loss_per_pair(scene, g.ravel()).reshape(g.shape)
        self._form = grid.weights[:, None] * mean * grid.weights

    def __call__(self, f: np.ndarray) -> float:
        """The double integral."""
        return float(f @ self._form @ f)
