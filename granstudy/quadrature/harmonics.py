"""Real spherical harmonics, and the degree to which a set of directions integrates them exactly.

The harmonics are normalised over the sphere, (1/4π) ∫ Y_lm² dω = 1, so that Y_00 = 1:

    Y_lm(x, y, z)  =  A_lm(z) Re (x + iy)^m,   m ≥ 0
    Y_l,-m(x, y, z) = A_lm(z) Im (x + iy)^m,   m > 0
    A_lm(z) = sqrt((2 − δ_m0) (2l + 1) (l − m)!/(l + m)!) d^m P_l/dz^m

In x, y, z the harmonics are polynomials. No angle is needed, no division by sin θ, and nothing is singular
at the poles.
"""
# ruff: noqa: E741 -- l is the degree of Y_lm in every book

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

EXACT_TOLERANCE = 1e-12
"""Largest residual of a harmonic that counts as integrated exactly. Points stored with 15 digits leave
about 1e-15, a generic rule one degree beyond its own 1e-3 or more."""


def residual(points: NDArray, degree: int, weights: NDArray | None = None) -> float:
    """Largest |Σ w_i Y_lm(x_i)| / Σ w_i over all 1 ≤ l ≤ degree and |m| ≤ l.

    A set whose residual to degree t is zero, with equal weights, is a spherical design of degree t
    (Delsarte, Goethals and Seidel 1977).

    Parameters
    ----------
    points : ndarray, shape (n, 3)
    weights : ndarray, shape (n,), optional
        By default equal weights.
    """
    means = _means(points, _shares(points, weights), degree)
    return max((float(abs(mean)) for l, mean in means if l > 0), default=0.0)


def exact_degree(points: NDArray, weights: NDArray | None = None) -> int:
    """Largest degree t for which `residual(points, t, weights)` is at most `EXACT_TOLERANCE`.

    The search ends by itself. A rule with positive weights and n points is never exact beyond degree 2 √n:
    a polynomial that vanishes at all points exists, and its square does not integrate to zero.
    """
    share = _shares(points, weights)
    limit = 2 * int(np.sqrt(len(points))) + 1
    failed = [l for l, mean in _means(points, share, limit) if l and abs(mean) > EXACT_TOLERANCE]
    return min(failed, default=limit + 1) - 1


def harmonics(points: NDArray, modes: NDArray) -> NDArray:
    """Values Y_lm(x_i), shape (modes, n), in the precision of ``points``.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
    modes : ndarray of int, shape (modes, 2)
        Rows (l, m).
    """
    degree, order = int(modes[:, 0].max()), np.abs(modes[:, 1])
    A = _associated_table(points[:, 2], degree + 1)
    return A[modes[:, 0], order] * _select(_powers(points, degree), modes[:, 1])


def harmonic_gradients(points: NDArray, modes: NDArray) -> NDArray:
    """Tangential gradients of Y_lm at x_i, shape (modes, n, 3).

    The polynomial at the head of this module is differentiated in x, y, z and projected on the tangent
    plane, with d Re(x+iy)^m = m Re[(x+iy)^{m−1} (dx + i dy)] and dA_lm/dz ∝ A_l,m+1.
    """
    l, m = modes[:, 0], modes[:, 1]
    degree, order = int(l.max()), np.abs(m)
    A, powers = _associated_table(points[:, 2], degree + 1), _powers(points, degree)
    # The exact ratio of the normalisations of A_lm and A_l,m+1: zero at m = l, where A is constant.
    halved = np.where(order == 0, 1, 2) / points.dtype.type(2)
    ratio = np.sqrt((l - order) * (l + order + 1) * halved)
    lower = order[:, None] * powers[np.maximum(order - 1, 0)]
    across = np.where(m[:, None] >= 0, lower.real, lower.imag)
    along = np.where(m[:, None] >= 0, -lower.imag, lower.real)
    upward = ratio[:, None] * A[l, order + 1] * _select(powers, m)
    gradient = np.stack([A[l, order] * across, A[l, order] * along, upward], axis=-1)
    radial = np.sum(gradient * points, axis=-1, keepdims=True)
    return gradient - radial * points


def _shares(points: NDArray, weights: NDArray | None) -> NDArray:
    """Weights divided by their sum, or equal shares where no weights are given."""
    if weights is None:
        return np.full(len(points), 1 / points.dtype.type(len(points)))
    return weights / np.sum(weights)


def _means(points: NDArray, share: NDArray, degree: int) -> Iterator[tuple[int, float]]:
    """Pairs (l, Σ share_i Y_lm(x_i)) to ``degree``, one by one, so that large rules fit in memory."""
    powers = _powers(points, degree)
    for m in range(degree + 1):
        for l, A in _associated(points[:, 2], m, degree):
            total = np.sum(share * A * powers[m])
            yield l, total.real
            yield l, total.imag


def _powers(points: NDArray, degree: int) -> NDArray:
    """(x + iy)^m for m = 0..degree, shape (degree + 1, n)."""
    plane = points[:, 0] + 1j * points[:, 1]
    return np.cumprod(np.vstack([np.ones_like(plane), *[plane] * degree]), axis=0)


def _select(powers: NDArray, m: NDArray) -> NDArray:
    """Re (x + iy)^m for m ≥ 0, Im (x + iy)^|m| for m < 0: a row for every mode."""
    rows = powers[np.abs(m)]
    return np.where(m[:, None] >= 0, rows.real, rows.imag)


def _associated_table(z: NDArray, degree: int) -> NDArray:
    """A_lm at all z for 0 ≤ m ≤ l ≤ degree, and zero for m > l; shape (degree+1, degree+1, n)."""
    table = np.zeros((degree + 1, degree + 1, len(z)), dtype=z.dtype)
    for m in range(degree + 1):
        for l, A in _associated(z, m, degree):
            table[l, m] = A
    return table


def _associated(z: NDArray, m: int, degree: int) -> Iterator[tuple[int, NDArray]]:
    """Pairs (l, A_lm(z)) for l = m..degree by the three-term recurrence in l.

    A_lm = a_lm (z A_{l−1,m} − A_{l−2,m} / a_{l−1,m}),  a_lm² = (4l² − 1)/(l² − m²)
    (Legendre's recurrence in normalised form; stable upwards in l).
    """
    real = z.dtype.type
    factors = [real(2 * k + 1) / (2 * k) for k in range(1, m + 1)]
    before, current = np.zeros_like(z), np.full_like(z, np.sqrt(np.prod(factors, initial=real(1))))
    if m > 0:
        current = current * np.sqrt(real(2))
    a_before = real(1)
    for l in range(m, degree + 1):
        yield l, current
        a = np.sqrt(real(4 * (l + 1) ** 2 - 1) / ((l + 1) ** 2 - m**2))
        before, current = current, a * (z * current - before / a_before)
        a_before = a
