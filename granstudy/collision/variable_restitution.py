"""Gain weights for a restitution that depends on the normal impact speed (the paper's Remark 2).

With σ at angle χ from ĝ the normal impact speed is |g·ω| = ρ sin(χ/2), so α depends on χ and the
integral of e^{iπρα k·(ĝ−σ)/L} over σ is no longer a phase times sinc: it is a function of ρ, |k| and
k·ĝ. Everything else of the method is unchanged.
"""

from collections.abc import Callable

import numpy as np
from scipy.special import j0

from granstudy.collision.weights import alpha
from granstudy.grid import VelocityGrid

SAMPLES = 48
"""Gauss–Legendre nodes in |k̂·ĝ| at which a pair's weight is fitted."""

FIT_TOLERANCE = 1e-11
"""Largest error of the fit; the weight itself is at most 1."""

MOST_TERMS = 32

RestitutionLaw = Callable[[np.ndarray], np.ndarray]


def deflections(dim: int, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes u = sin(χ/2) in [0, 1] and weights of the mean over σ, resolving phases up to ``scale``.

    The measure of the mean is 2u du in 3D and (2/π) du/√(1−u²), that is dχ/π, in 2D.
    """
    count = 48 + int(scale)
    x, w = np.polynomial.legendre.leggauss(count)
    if dim == 2:
        return np.sin(np.pi / 4 * (x + 1)), w / 2
    u = (x + 1) / 2
    return u, w * u


def mean_phase(
    restitution: RestitutionLaw,
    dim: int,
    rho: float,
    parallel: np.ndarray,
    transverse: np.ndarray,
) -> np.ndarray:
    """Mean over σ of e^{iα K·(ĝ−σ)} with K = πρk/L split along and across ĝ.

    K·(ĝ−σ) = 2u² K∥ − 2u√(1−u²) K⊥ cos φ with u = sin(χ/2); the mean over φ is a Bessel function in
    3D and a cosine (φ = 0, π) in 2D. Shape: that of ``parallel`` and ``transverse``.
    """
    scale = float(np.max(np.abs(parallel)) + np.max(transverse))
    u, weights = deflections(dim, scale)
    alphas = alpha(np.asarray(restitution(rho * u), dtype=float))
    ring_mean = np.cos if dim == 2 else j0
    total = np.zeros(np.broadcast_shapes(parallel.shape, transverse.shape), dtype=np.complex128)
    for ui, ai, wi in zip(u, np.broadcast_to(alphas, u.shape), weights, strict=True):
        across = ring_mean(2 * ai * ui * np.sqrt(1 - ui**2) * transverse)
        total += wi * np.exp(2j * ai * ui**2 * parallel) * across
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


def pair_terms(
    restitution: RestitutionLaw, dim: int, radii: np.ndarray, k: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Terms of an antipodal pair's gain weight, Σ_r means[ρ, r, |k|] cos(β_r ρ k·ĝ).

    The exact weight Re(mean_phase · e^{−i½ρ k·ĝ}) is even in k·ĝ and of frequency at most ½ρ|k|; it is
    fitted in least squares over directions, a shell and a |k| at a time, by cosines of fixed
    frequencies. Few suffice as e varies little over a scene's impacts; their number is doubled until
    the fit is within `FIT_TOLERANCE`.

    Parameters
    ----------
    radii : ndarray, shape (shells,)
        Radial nodes ρ.
    k : ndarray, shape (n,)
        Magnitudes π|k|/L.

    Returns
    -------
    beta : ndarray, shape (r,)
    means : ndarray, shape (shells, r, n)

    Raises
    ------
    ValueError
        If no number of terms up to `MOST_TERMS` reaches the tolerance.
    """
    x, w = np.polynomial.legendre.leggauss(SAMPLES)
    mu, root = (x + 1) / 2, np.sqrt(w / 2)
    exact = np.empty((len(radii), SAMPLES, len(k)))
    for shell, rho in enumerate(radii):
        parallel = rho * mu[:, None] * k
        transverse = rho * np.sqrt(1 - mu[:, None] ** 2) * k
        phase = mean_phase(restitution, dim, rho, parallel, transverse)
        exact[shell] = (phase * np.exp(-0.5j * parallel)).real
    terms = 1
    while terms <= MOST_TERMS:
        beta = 0.25 * (1.0 - np.cos(np.pi * (np.arange(terms) + 0.5) / terms))
        # (shells, n, SAMPLES, r)
        basis = np.cos(beta * (radii[:, None, None] * k[:, None] * mu)[..., None])
        inverse = np.linalg.pinv(root[:, None] * basis, rcond=1e-13)
        means = np.einsum("skrm,m,smk->srk", inverse, root, exact)
        fitted = np.einsum("skmr,srk->smk", basis, means)
        if np.max(np.abs(fitted - exact)) <= FIT_TOLERANCE:
            return beta, means
        terms *= 2
    raise ValueError(
        f"restitution={restitution!r}: its gain weight needs more than {MOST_TERMS} terms for "
        f"{FIT_TOLERANCE:g}; use method 'literal' or a smoother law"
    )
