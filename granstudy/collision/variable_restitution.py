"""Gain weights for a restitution that depends on the normal impact speed (the paper's Remark 2).

With σ at angle χ from ĝ the normal impact speed is |g·ω| = ρ sin(χ/2), so α depends on χ and the
integral of e^{iπρα k·(ĝ−σ)/L} over σ is no longer a phase times sinc: it is a function of ρ, |k| and
k·ĝ. Everything else of the method is unchanged.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from scipy.special import j0

from granstudy.collision.weights import alpha
from granstudy.velocity.cartesian import VelocityGrid

RestitutionLaw = Callable[[np.ndarray], np.ndarray]


def deflections(dim: int, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes u = sin(χ/2) in [0, 1] and weights of the mean over σ, resolving phases up to ``scale``.

    The measure of the mean is 2u du in 3D and (2/π) du/√(1−u²), that is dχ/π, in 2D.
    """
    x, w = np.polynomial.legendre.leggauss(48 + int(0.75 * scale))
    if dim == 2:
        return np.sin(np.pi / 4 * (x + 1)), w / 2
    u = (x + 1) / 2
    return u, w * u


def mean_phase(
    restitution: RestitutionLaw,
    dim: int,
    rho: np.ndarray | float,
    parallel: np.ndarray,
    transverse: np.ndarray,
) -> np.ndarray:
    """Mean over σ of e^{iα K·(ĝ−σ)} with K = πρk/L split along and across ĝ.

    K·(ĝ−σ) = 2u² K∥ − 2u√(1−u²) K⊥ cos φ with u = sin(χ/2); the mean over φ is a Bessel function in
    3D and a cosine (φ = 0, π) in 2D. ``rho`` broadcasts with ``parallel`` and ``transverse``; the
    result has their common shape.
    """
    u, weights = deflections(dim, float(np.max(np.hypot(parallel, transverse))))
    ring_mean = np.cos if dim == 2 else j0
    total = np.zeros(np.broadcast_shapes(parallel.shape, transverse.shape), dtype=np.complex128)
    for ui, wi in zip(u, weights, strict=True):
        doubled = 2 * ui * alpha(np.asarray(restitution(rho * ui), dtype=float))
        across = ring_mean(doubled * np.sqrt(1 - ui**2) * transverse)
        total += wi * np.exp(1j * doubled * ui * parallel) * across
    return total


def mean_gain(
    restitution: RestitutionLaw, grid: VelocityGrid, rho: float, direction: np.ndarray
) -> np.ndarray:
    """F⁺(k,ρ,ĝ) / (|S| C_λ ρ^λ) on the whole spectrum."""
    scale = np.pi * rho / grid.L
    k = np.meshgrid(*(grid.wavenumbers,) * grid.dim, indexing="ij", sparse=True)
    parallel = sum(ki * gi for ki, gi in zip(k, direction, strict=True))
    transverse = np.sqrt(np.maximum(grid.wavenumber_squared() - parallel**2, 0.0))
    return mean_phase(restitution, grid.dim, rho, scale * parallel, scale * transverse)


def pair_series(
    restitution: RestitutionLaw, dim: int, radii: np.ndarray, k: np.ndarray
) -> np.ndarray:
    """Weight of an antipodal pair ±ĝ as Chebyshev series Σ_n c[ρ, |k|, n] T_n(2(k̂·ĝ)² − 1).

    The weight Re(mean_phase · e^{−i½ρ k·ĝ}) is even in k̂·ĝ and oscillates no faster than ½ρ|k|, so
    that interpolation in ½ρ|k|/2 + 12 Chebyshev points of (k̂·ĝ)² is exact to round-off for smooth laws.

    Parameters
    ----------
    radii : ndarray, shape (shells,)
        Radial nodes ρ.
    k : ndarray, shape (n,)
        Magnitudes π|k|/L.
    """
    # Making it takes seconds, and planning a quadrature asks for few different ones.
    return _pair_series(restitution, dim, tuple(map(float, radii)), tuple(map(float, k))).copy()


@lru_cache(maxsize=8)
def _pair_series(
    restitution: RestitutionLaw, dim: int, all_radii: tuple[float, ...], all_k: tuple[float, ...]
) -> np.ndarray:
    radii, k = np.array(all_radii), np.array(all_k)
    count = 12 + int(0.3 * np.max(radii) * np.max(k))
    theta = np.pi * (np.arange(count) + 0.5) / count
    mu = np.sqrt((1 + np.cos(theta)) / 2)
    rho = radii[:, None]
    samples = np.empty((len(radii), len(k), count))
    for i, magnitude in enumerate(k):
        parallel = rho * magnitude * mu
        transverse = rho * magnitude * np.sqrt(1 - mu**2)
        phase = mean_phase(restitution, dim, rho, parallel, transverse)
        samples[:, i] = (phase * np.exp(-0.5j * parallel)).real
    n = np.arange(count)
    project = np.cos(np.outer(theta, n)) * np.where(n == 0, 1.0, 2.0) / count
    return samples @ project
