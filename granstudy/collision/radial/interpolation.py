"""Weights of Q by local interpolation on tables, to round-off.

A function of exponential type 1, such as M(x) or H in units of its box, is interpolated by Lagrange's formula
on `POINTS` equally spaced points about x. With p points h apart the error is at most

    h^p ((p−1)!!/2^{p/2})²/p!,

4e-18 for 18 points at h = ¼. A table so takes the place of a sum over a quadrature rule.
"""

from math import comb

import numpy as np

from granstudy.support.compiled import compiled

POINTS = 18
"""Points of a stencil."""

SPACING = 0.25
"""Their distance, over the inverse of the box."""

_SIGNED = np.array([(-1.0) ** j * comb(POINTS - 1, j) for j in range(POINTS)])
"""Barycentric weights of equally spaced points."""


@compiled(forceinline=True, fastmath=True)
def _stencil(t, weights):
    """Fill the weights of the points about place ``t`` of a table; returns the first of these points."""
    first = int(t) - POINTS // 2 + 1
    total = 0.0
    for j in range(POINTS):
        off = t - (first + j)
        if off == 0.0:
            weights[:] = 0.0
            weights[j] = 1.0
            return first
        weights[j] = _SIGNED[j] / off
        total += weights[j]
    for j in range(POINTS):
        weights[j] /= total
    return first


@compiled(fastmath=True)
def averaged_weights(wavenumbers, n, alpha, mu, w_mu, H, loss, R, L, count):
    """Weights of the waves M(k r) in ½[q_nm + q_mn] for all m ≥ n, spread over a table of waves.

    Parameters
    ----------
    wavenumbers : ndarray, shape (N,)
        k_1 < k_2 < ... of the modes.
    n : int
    alpha : float
        α = (1+e)/4.
    mu, w_mu : ndarray
        Rule of the mean over the angle of the two wavevectors.
    H : ndarray
        H(a, b) at a, b = (j − POINTS/2) SPACING/R.
    loss : ndarray, shape (N,)
        H(0, k_m).
    R, L : float
    count : int
        Points of the table of waves, which lie SPACING/L apart.

    Returns
    -------
    ndarray, shape (N−n, count)
        G such that Σ_j G[m−n, j] M(k_j r) = ⟨½[G(l,m) + G(m,l)] M(k r)⟩_μ.
    """
    N = wavenumbers.size
    found = np.zeros((N - n, count))
    of_k, of_a = np.empty(POINTS), np.empty(POINTS)
    of_m, of_l = np.empty(POINTS), np.empty(POINTS)
    per_H, per_wave, middle = R / SPACING, L / SPACING, POINTS // 2
    l = wavenumbers[n]  # noqa: E741
    for row in range(N - n):
        m = wavenumbers[n + row]
        lost = loss[n] + loss[n + row]
        for q in range(mu.size):
            k2 = max(l * l + m * m + 2.0 * l * m * mu[q], 0.0)
            k = np.sqrt(k2)
            shift = alpha * (1.0 - alpha) * k2
            # |m−α(l+m)| and, with the two modes exchanged, |l−α(l+m)|.
            s_m = np.sqrt(max((1.0 - alpha) * m * m + alpha * l * l - shift, 0.0))
            s_l = np.sqrt(max((1.0 - alpha) * l * l + alpha * m * m - shift, 0.0))
            at_a = _stencil(alpha * k * per_H + middle, of_a)
            at_m = _stencil(s_m * per_H + middle, of_m)
            at_l = _stencil(s_l * per_H + middle, of_l)
            gain = 0.0
            for i in range(POINTS):
                line = 0.0
                for j in range(POINTS):
                    line += of_m[j] * H[at_a + i, at_m + j] + of_l[j] * H[at_a + i, at_l + j]
                gain += of_a[i] * line
            weight = 0.5 * (gain - lost) * w_mu[q]
            at_k = _stencil(k * per_wave + middle, of_k)
            for j in range(POINTS):
                found[row, at_k + j] += weight * of_k[j]
    return found
