"""Sums over a lattice of differences against the integrals that they stand for (docs/method.md §10).

A smooth density F(g) that decays has Σ_g F(g) h^d = ∫F dg to all orders in the spacing h. Times |g|^s the
summand has a kink at g = 0, and the sum is off by O(h^{d+s}). By Poisson's summation formula the excess is

    Σ_g |g|^s F(g) h^d − ∫|g|^s F dg = (2π)^{−d} ∫ F̂(k) E(k) dk,   E(k) = Σ_{m ≠ 0} c |k + 2πm/h|^{−d−s},

c |k|^{−d−s} the transform of |g|^s, c = 2^{d+s} π^{d/2} Γ((d+s)/2)/Γ(−s/2). Subtracted mode by mode, E
leaves no power of h. Its first term is Epstein's zeta function, E(0) = Z_d(−s) h^{d+s}. For even s, c = 0.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from scipy.fft import dct
from scipy.special import gamma, rgamma

STEP, RANGE = 0.25, (-36.0, 2.0)
"""Trapezoidal rule over log t, exact to round-off: the integrand is analytic, and decays at both ends."""

IMAGES = 4
"""Terms on either side of a theta function's sum, for either of its two series."""


def lattice_excess(dim: int, N: int, exponents: Sequence[float]) -> list[np.ndarray]:
    """E(k) h^{−d−s} of every exponent s ≥ 0 at k_i h = πn_i/N, n_i = 0..N, shape (N+1,)*dim each."""
    factors = [
        2.0 ** (dim + s) * np.pi ** (dim / 2) * gamma((dim + s) / 2) * float(rgamma(-s / 2))
        for s in exponents
    ]
    sums = image_sums(dim, N, exponents)
    return [factor * total for factor, total in zip(factors, sums, strict=True)]


def image_sums(dim: int, N: int, exponents: Sequence[float]) -> list[np.ndarray]:
    """Σ_{m ≠ 0} |x + 2πm|^{−d−s} at x_i = πn_i/N, n_i = 0..N, for every s > 0; shape (N+1,)*dim each.

    For s = 0, where the sum diverges and E vanishes, 0 stands in its place.

    With |x|^{−a} = ∫ t^{a/2−1} e^{−t|x|²} dt/Γ(a/2), the sum over m is a product of sums over each direction
    at every t, theta functions. Without m = 0, and without the (4πt)^{−d/2} of small t, what remains decays
    at both ends of the integral; the integral of the latter is known.
    """
    x = np.pi * np.arange(N + 1) / N
    t = np.exp(np.arange(*RANGE, STEP))
    theta, first = _theta(x, t), np.exp(-np.multiply.outer(t, x**2))
    damping = np.pi**2
    small_t = (4 * np.pi * t) ** (-dim / 2) * np.exp(-damping * t)
    found = []
    for s in exponents:
        if s == 0.0:
            found.append(np.zeros((N + 1,) * dim))
            continue
        weights = STEP * t ** ((dim + s) / 2)
        total = _sum_of_products(weights, theta, dim) - _sum_of_products(weights, first, dim)
        total += (4 * np.pi) ** (-dim / 2) * gamma(s / 2) * damping ** (-s / 2) - weights @ small_t
        found.append(total / gamma((dim + s) / 2))
    return found


def _theta(x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Σ_m e^{−t(x+2πm)²} at every t (first axis) and x, by the series that converges faster."""
    m = np.arange(-IMAGES, IMAGES + 1)
    squares = np.add.outer(x, 2 * np.pi * m) ** 2
    near = np.exp(-np.multiply.outer(t, squares)).sum(axis=2)
    waves = np.exp(-np.multiply.outer(1 / (4 * t), m**2)) @ np.cos(np.multiply.outer(m, x))
    far = waves / np.sqrt(4 * np.pi * t)[:, None]
    return np.where(t[:, None] > 1 / (4 * np.pi), near, far)


def _sum_of_products(weights: np.ndarray, a: np.ndarray, dim: int) -> np.ndarray:
    """Σ_t w_t a_t(x_1) ... a_t(x_d), for a of shape (t, x)."""
    n = a.shape[1]
    inner = np.ones((len(a), 1))
    for _ in range(dim - 1):
        inner = (inner[:, :, None] * a[:, None, :]).reshape(len(a), -1)
    return np.asarray((inner.T @ (weights[:, None] * a)).reshape((n,) * dim))


def radial_excess(dim: int, nodes: np.ndarray, s: float) -> np.ndarray:
    """Excess of |g|^s, averaged over directions, at pairs of speeds, shape (N, N).

    The mean over directions has the kink A |r − r*|^q, in 3D q = s + 2, A = −1/(2(s+2) r r*), in 2D
    q = s + 1, A = Γ(−q/2)/(2Γ(−s/2) √(π r r*)). Its excess on a
    line is an E(k) as above for d = 1; back from k, at the distance n of two nodes, it is κ_n h^q. In 3D the
    kink at r = −r* counts as well, and nothing is left. In 2D, h is the local spacing, and an error of a
    higher order in h/r is left.
    """
    N = len(nodes)
    if s % 2.0 == 0.0:  # no kink
        return np.zeros((N, N))
    q = s + dim - 1.0
    line = _on_a_line(N, q)
    # c Γ((1+q)/2) of the line; Γ(−q/2) cancels in 2D
    c = 2.0 ** (1 + q) * np.sqrt(np.pi) * gamma((1 + q) / 2)
    index = np.arange(1, N + 1)
    apart = np.abs(np.subtract.outer(index, index))
    if dim == 3:
        kappa = line[apart] - line[np.add.outer(index, index)]
        A = -rgamma(-q / 2) / (2 * (s + 2))
        return np.asarray(c * A * nodes[0] ** q * kappa / np.multiply.outer(nodes, nodes))
    A = rgamma(-s / 2) / (2 * np.sqrt(np.pi))
    root = np.sqrt(np.gradient(nodes))
    scale = np.multiply.outer(root, root) ** q / np.sqrt(np.multiply.outer(nodes, nodes))
    return np.asarray(c * A * scale * line[apart])


@lru_cache(maxsize=64)
def _on_a_line(N: int, q: float) -> np.ndarray:
    """Σ over images of |k|^{−1−q} on a line, at the distances of nodes; shape (8N + 1,).

    Kept: the search for a radius asks for it again and again.
    """
    modes = 8 * N
    [images] = image_sums(1, modes, [q])
    line: np.ndarray = dct(images, type=1) / (2 * modes)
    return line
