"""Fourier weights of the collision operator (docs/method.md §2)."""

from collections.abc import Callable

import numpy as np

from granstudy.model.kernel import VHS, sphere_area
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.sphere import sphere_mean

SphereMean = Callable[[int, np.ndarray], np.ndarray]


def alpha(restitution: np.ndarray | float) -> np.ndarray | float:
    """α = (1+e)/4 of the collision rule v' = v − α(g − |g|σ)."""
    return (1.0 + restitution) / 4.0


def radial_measure(kernel: VHS, dim: int, rho: np.ndarray, w_rho: np.ndarray) -> np.ndarray:
    """|S^{d−1}| C_λ w_ρ ρ^{d−1+λ}: everything at a radial node that knows no direction."""
    return sphere_area(dim) * kernel.strength * w_rho * rho ** (dim - 1 + kernel.exponent)


def loss_weight(
    kernel: VHS,
    grid: VelocityGrid,
    rho: np.ndarray,
    w_rho: np.ndarray,
    half: bool,
    mean: SphereMean = sphere_mean,
) -> np.ndarray:
    """G⁻(m) = |S|² C_λ Σ_ρ w_ρ ρ^{d−1+λ} mean(πρ|m|/L) (paper eqs. 44 and 47).

    Shape: the full spectrum, or with ``half`` the part a real transform stores.
    """
    m2, place = np.unique(grid.wavenumber_squared(half), return_inverse=True)
    measure = radial_measure(kernel, grid.dim, rho, w_rho)
    means = mean(grid.dim, np.pi / grid.L * np.sqrt(m2)[:, None] * rho)
    return sphere_area(grid.dim) * (means @ measure)[place].reshape(place.shape)
