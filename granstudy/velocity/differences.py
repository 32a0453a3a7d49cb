"""Local derivatives of densities, for velocities that shrink or move (docs/method.md §5).

What moves a density must not use the whole box: what a trigonometric or Bessel series does between the nodes,
10⁻⁶ of the largest value everywhere, becomes 0.1 in a2 once it is moved onto nodes, as a2 weighs it by |c|⁴.
All operators here take `HALF_WIDTH` neighbours on either side, and are in conservative form: the moments of
∇·(c g) are what they must be, to what g has at the border of the grid.
"""

from math import factorial

import numpy as np
from scipy.special import j0, j1, jn_zeros

HALF_WIDTH = 8
"""Neighbours on either side, p: differences are exact for polynomials of degree 2p = 16."""

CORE, CORE_LARGEST = 2 * HALF_WIDTH, 0.4
"""Nodes about r = 0 whose differences are mended in 2D: a number, and the largest part of all nodes."""

CORE_MODES = 0.6
"""Modes that the mended differences are right for: weights e^{−(2k/0.6 k_N)²}, k up to the largest, k_N."""

CORE_PENALTY = 1e-3
"""Size of a change of the differences that counts as much as an error of 1."""

CORE_MOMENTS = 4
"""Moments 1, r², r⁴, r⁶ that mending leaves exactly as they are."""


def central_differences(N: int, spacing: float) -> np.ndarray:
    """Matrix A of the central difference of order 2p on N equidistant nodes; values beyond them are 0.

    The coefficients are ±(p!)²/(k (p−k)! (p+k)!), k = 1..p. A is antisymmetric. In Σ_i A_i(c_i g) summation
    by parts gives Σ φ ∇·(c g) = −Σ (A·φ) c g, and A φ is exact for polynomials φ of degree 2p.
    """
    p = HALF_WIDTH
    A = np.zeros((N, N))
    for k in range(1, min(p, N - 1) + 1):
        coefficient = factorial(p) ** 2 / (k * factorial(p - k) * factorial(p + k))
        A += (-1) ** (k + 1) * coefficient / spacing * np.eye(N, k=k)
    return A - A.T


def radial_dilation_3d(nodes: np.ndarray) -> np.ndarray:
    """Matrix of ∇c·(c g) on the speeds r_j = jh.

    F = r g is odd, and r ∇c·(c g) = F + d(rF)/dr: the central difference is taken of rF on ±r_j. As on a
    line, the moments of even powers of r are exact to what g has at the border.
    """
    N = len(nodes)
    difference = central_differences(2 * N + 1, nodes[0])[N + 1 :]
    # rF = r²g is even, and 0 at r = 0
    even = difference[:, N + 1 :] + difference[:, N - 1 :: -1]
    return np.eye(N) + even * nodes**2 / nodes[:, None]


def radial_dilation_2d(nodes: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Matrix B of ∇c·(c g) on speeds at zeros of J0, minus the transpose of r d/dr.

    With D the derivative of the polynomials through the neighbours of each node, mirrored at r = 0 and
    continued beyond the last node, Σ_j w_j φ_j (B g)_j = −Σ_i w_i g_i r_i (Dφ)_i for every φ: moments of even
    powers of r are exact to what g has at the border. About r = 0, where the weights have a kink, this B g is
    right on average only, and is mended (`_mended`).
    """
    N = len(nodes)
    D = _mirrored_derivative(N, nodes[-1])
    B = -(D * (nodes * weights)[:, None]).T / weights[:, None]
    return _mended(B, nodes, weights)


def _mirrored_derivative(N: int, last: float) -> np.ndarray:
    """d/dr of even functions at the first N of the nodes ∝ zeros of J0, from their values there."""
    p = HALF_WIDTH
    zeros = jn_zeros(0, N + p + 1)
    speeds = last * zeros / zeros[N - 1]
    line = np.concatenate([-speeds[::-1], speeds])
    D = np.zeros((N, len(speeds)))
    for i in range(N):
        near = len(speeds) + i + np.arange(-p, p + 1)
        places = np.where(near < len(speeds), len(speeds) - 1 - near, near - len(speeds))
        np.add.at(D[i], places, _derivative_weights(line[near], p))
    return D[:, :N]


def _derivative_weights(x: np.ndarray, at: int) -> np.ndarray:
    """Weights of the derivative at x[at] of the polynomial through values at ``x``, barycentric."""
    others = np.arange(len(x)) != at
    differences = np.subtract.outer(x, x) / (x[-1] - x[0]) + np.eye(len(x))
    w = 1.0 / np.prod(differences, axis=1)
    weights = np.zeros(len(x))
    weights[others] = w[others] / w[at] / (x[at] - x[others])
    weights[at] = -weights.sum()
    return weights


def _mended(B: np.ndarray, nodes: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """B with its first rows changed by little, so that they are right for long waves as well.

    The change C has no moments, Σ_j w_j r_j^{2m} C_ji = 0 for m < `CORE_MOMENTS`, and acts on nodes about
    r = 0 alone. Among such changes it has the least Σ_k (error of B + C on J0(kr))² + (penalty |C|)².
    """
    rows = min(CORE, int(CORE_LARGEST * len(nodes)))
    columns = rows + rows // 2
    largest = jn_zeros(0, len(nodes))[-1] / _ball(nodes)
    k = np.linspace(0.0, largest, 4 * columns, endpoint=False)
    x = np.multiply.outer(nodes, k)
    relevance = np.exp(-((2 * k / (CORE_MODES * largest)) ** 2))
    modes = j0(x)
    errors = ((2 * modes - x * j1(x) - B @ modes) * relevance)[:rows]
    modes = (modes * relevance)[:columns]
    root = np.sqrt(weights[:rows, None])
    powers = (nodes[:rows, None] / nodes[rows - 1]) ** (2 * np.arange(min(CORE_MOMENTS, rows)))
    basis = np.linalg.qr(root * powers)[0]
    errors = root * errors
    errors -= basis @ (basis.T @ errors)
    normal = modes @ modes.T + CORE_PENALTY**2 * len(k) * np.eye(columns)
    mended = B.copy()
    mended[:rows, :columns] += np.linalg.solve(normal, modes @ errors.T).T / root
    return mended


def _ball(nodes: np.ndarray) -> float:
    """L of speeds L z_j/z_{N+1}, j ≤ N."""
    zeros = jn_zeros(0, len(nodes) + 1)
    return float(nodes[0] * zeros[-1] / zeros[0])
