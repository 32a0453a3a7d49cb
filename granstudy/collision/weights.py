"""Fourier weights of gain and loss, for a constant restitution and for laws e(|g·ω|) (docs/method.md §2)."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.special import j0

from granstudy.model.kernel import VHS
from granstudy.model.restitution import restitution_at
from granstudy.quadrature.deflection import deflections
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.sphere import sphere_area, sphere_mean

SphereMean = Callable[[int, np.ndarray], np.ndarray]
"""Mean of e^{iσ·x} over the unit sphere from the dimension and |x|: `sphere_mean`, or the paper's."""

RestitutionLaw = Callable[[np.ndarray], np.ndarray]
"""Restitution e as a function of the normal impact speed |g·ω|."""


def alpha(restitution: np.ndarray | float) -> np.ndarray | float:
    """α = (1+e)/4 of the collision rule v' = v − α(g − |g|σ)."""
    return (1.0 + restitution) / 4.0


def radial_measure(kernel: VHS, dim: int, rho: np.ndarray, w_rho: np.ndarray) -> np.ndarray:
    """|S^{d−1}| C_λ w_ρ ρ^{d−1+λ}: the factors of the weight at a radial node that all directions share."""
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

    The array covers the full spectrum, or with ``half`` the part that a real transform stores.
    """
    m2, place = np.unique(grid.wavenumber_squared(half), return_inverse=True)
    measure = radial_measure(kernel, grid.dim, rho, w_rho)
    means = mean(grid.dim, np.pi / grid.L * np.sqrt(m2)[:, None] * rho)
    return sphere_area(grid.dim) * (means @ measure)[place].reshape(place.shape)


def law_values(
    restitution: RestitutionLaw, dim: int, rho: np.ndarray | float, largest: float
) -> np.ndarray:
    r"""Restitution at the impacts that `mean_phase` adds up, shape (deflections, \*rho.shape).

    Parameters
    ----------
    largest : float
        Largest |K| (`largest_phase`).
    """
    u, _ = deflections(dim, largest)
    return np.array([restitution_at(restitution, np.asarray(rho * ui)) for ui in u])


def largest_phase(parallel: np.ndarray, transverse: np.ndarray) -> float:
    """Largest |K| of the parts of K."""
    return float(np.max(np.hypot(parallel, transverse)))


def mean_phase(
    values: np.ndarray, dim: int, parallel: np.ndarray, transverse: np.ndarray
) -> np.ndarray:
    """Mean over σ of e^{iα K·(ĝ−σ)} for K = πρk/L, given by its parts along ĝ and across.

    K·(ĝ−σ) = 2u² K∥ − 2u√(1−u²) K⊥ cos φ with u = sin(χ/2). The mean over φ is a Bessel function in 3D, and
    in 2D, where φ is 0 or π, a cosine.

    Parameters
    ----------
    values : ndarray
        Restitution at the impacts (`law_values`); those of one deflection broadcast with ``parallel``.
    parallel, transverse : ndarray
        K∥ and K⊥. The result has their common shape.
    """
    u, weights = deflections(dim, largest_phase(parallel, transverse))
    ring_mean = np.cos if dim == 2 else j0
    total = np.zeros(np.broadcast_shapes(parallel.shape, transverse.shape), dtype=np.complex128)
    for e, ui, wi in zip(values, u, weights, strict=True):
        doubled = 2 * ui * alpha(e)
        across = ring_mean(doubled * np.sqrt(1 - ui**2) * transverse)
        total += wi * np.exp(1j * doubled * ui * parallel) * across
    return total


def mean_gain(
    restitution: RestitutionLaw, grid: VelocityGrid, rho: float, direction: np.ndarray
) -> np.ndarray:
    """F⁺(k,ρ,ĝ) / (|S| C_λ ρ^λ) of one node on the whole spectrum."""
    scale = np.pi * rho / grid.L
    k = np.meshgrid(*(grid.wavenumbers,) * grid.dim, indexing="ij", sparse=True)
    parallel = sum(ki * gi for ki, gi in zip(k, direction, strict=True))
    transverse = np.sqrt(np.maximum(grid.wavenumber_squared() - parallel**2, 0.0))
    K = scale * parallel, scale * transverse
    values = law_values(restitution, grid.dim, rho, largest_phase(*K))
    return mean_phase(values, grid.dim, *K)


def pair_series(
    restitution: RestitutionLaw, dim: int, radii: np.ndarray, k: np.ndarray
) -> np.ndarray:
    """Weight of an antipodal pair ±ĝ as a Chebyshev series Σ_n c[ρ, |k|, n] T_n(2(k̂·ĝ)² − 1).

    The weight Re(mean_phase · e^{−i½ρ k·ĝ}) is even in k̂·ĝ and oscillates no faster than ½ρ|k|. For a smooth
    law, interpolation in 12 + 0.3ρ|k| Chebyshev points of (k̂·ĝ)² is exact to round-off.

    Parameters
    ----------
    radii : ndarray, shape (shells,)
        Radial nodes ρ.
    k : ndarray, shape (n,)
        Magnitudes π|k|/L.
    """
    values = [
        law_values(restitution, dim, radii[:, None], largest_phase(*_parts(radii, k, magnitude)))
        for magnitude in k
    ]
    # A series takes seconds to make, and planning a quadrature asks for few different ones. Its name is what
    # the law gives: a law that changes has other values.
    contents = tuple(array.tobytes() for array in values)
    return _pair_series(contents, dim, tuple(map(float, radii)), tuple(map(float, k))).copy()


@lru_cache(maxsize=8)
def _pair_series(
    contents: tuple[bytes, ...], dim: int, all_radii: tuple[float, ...], all_k: tuple[float, ...]
) -> np.ndarray:
    radii, k = np.array(all_radii), np.array(all_k)
    theta = _angles(radii, k)
    samples = np.empty((len(radii), len(k), len(theta)))
    for i, magnitude in enumerate(k):
        parallel, transverse = _parts(radii, k, magnitude)
        values = np.frombuffer(contents[i]).reshape(-1, len(radii), 1)
        phase = mean_phase(values, dim, parallel, transverse)
        samples[:, i] = (phase * np.exp(-0.5j * parallel)).real
    n = np.arange(len(theta))
    project = np.cos(np.outer(theta, n)) * np.where(n == 0, 1.0, 2.0) / len(theta)
    return samples @ project


def _angles(radii: np.ndarray, k: np.ndarray) -> np.ndarray:
    """Angles of the Chebyshev points of a series."""
    count = 12 + int(0.3 * np.max(radii) * np.max(k))
    return np.pi * (np.arange(count) + 0.5) / count


def _parts(radii: np.ndarray, k: np.ndarray, magnitude: float) -> tuple[np.ndarray, np.ndarray]:
    """K∥ and K⊥ at the Chebyshev points, for one |k|."""
    mu = np.sqrt((1 + np.cos(_angles(radii, k))) / 2)
    rho = radii[:, None]
    return rho * magnitude * mu, rho * magnitude * np.sqrt(1 - mu**2)
