"""Weights that give a density between its nodes: the grid's own series, or local polynomials.

A series is exact for what the grid represents, and its error is a part of the largest value everywhere. A
local polynomial takes `NEIGHBOURS` values near the point: its error is a part of the values there, which a
tail needs (docs/method.md §5).
"""

import numpy as np
from scipy.special import jn_zeros

from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.radial import RadialGrid

NEIGHBOURS = 16
"""Nodes of a local polynomial, of degree 15; values beyond the grid are 0."""

METHODS = ("spectral", "local")
"""Ways to interpolate."""


def check_method(method: str) -> None:
    """Raise ValueError unless ``method`` is one of `METHODS`."""
    if method not in METHODS:
        raise ValueError(f"method={method!r}: allowed are {', '.join(METHODS)}")


def line_weights(grid: VelocityGrid, x: np.ndarray, method: str = "spectral") -> np.ndarray:
    """Weights of the nodes of one dimension at the points x, shape x.shape + (N,); 0 outside the box."""
    check_method(method)
    x = np.asarray(x, dtype=float)
    if method == "spectral":
        inside = np.abs(x) <= grid.L
        weights = trigonometric_weights(grid.nodes, np.where(inside, x, 0.0))
        return np.where(inside[..., None], weights, 0.0)
    beyond = grid.spacing * np.arange(1, NEIGHBOURS + 1)
    line = np.concatenate([grid.nodes[0] - beyond[::-1], grid.nodes, grid.nodes[-1] + beyond])
    places = np.arange(line.size) - NEIGHBOURS
    return _local_weights(line, np.where(places < grid.N, places, -1), grid.N, x)


def trigonometric_weights(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Weights of equidistant nodes for the periodic trigonometric interpolant, shape x.shape + (N,).

    w_j = (1/N) Σ_{|k| ≤ N/2} cos(2πk(x − v_j)/P), P the period; the two unpaired modes count half each. The
    sum is sin(Nφ/2)/(N tan(φ/2)) with φ = 2π(x − v_j)/P.
    """
    N = len(nodes)
    half = (
        np.pi * np.subtract.outer(np.asarray(x, dtype=float), nodes) / (N * (nodes[1] - nodes[0]))
    )
    tangent = np.tan(half)
    # At a node, up to round-off, the quotient is 0/0 and its limit 1.
    at_node = np.abs(np.sin(half)) < 1e-14
    weights = np.sin(N * half) / (N * np.where(at_node, 1.0, tangent))
    return np.where(at_node, 1.0, weights)


def speed_weights(grid: RadialGrid, speeds: np.ndarray, method: str = "spectral") -> np.ndarray:
    """Weights of the radial nodes at speeds, shape speeds.shape + (N,); 0 outside the ball."""
    check_method(method)
    speeds = np.asarray(speeds, dtype=float)
    if method == "spectral":
        inside = speeds < grid.L
        weights = grid.mode_values(np.where(inside, speeds, 0.0)) @ grid.analysis
        return np.where(inside[..., None], weights, 0.0)
    N = grid.N
    count = N + NEIGHBOURS
    zeros = jn_zeros(0, count) if grid.dim == 2 else np.pi * np.arange(1.0, count + 1)
    outward = grid.nodes[0] / zeros[0] * zeros
    # f is even: the line is mirrored at 0.
    line = np.concatenate([-outward[::-1], outward])
    places = np.concatenate([np.arange(count)[::-1], np.arange(count)])
    return _local_weights(line, np.where(places < N, places, -1), N, speeds)


def _local_weights(line: np.ndarray, places: np.ndarray, N: int, x: np.ndarray) -> np.ndarray:
    """Lagrange's weights of the `NEIGHBOURS` nodes about each x.

    Parameters
    ----------
    line : ndarray
        Nodes, increasing, those beyond the grid among them.
    places : ndarray of int
        Place of each node in the density; −1 where the density is 0.
    N : int
        Number of places.
    """
    points = x.ravel()
    first = np.searchsorted(line, points) - NEIGHBOURS // 2
    inside = np.isfinite(points) & (first >= 0) & (first + NEIGHBOURS <= line.size)
    near = np.where(inside, first, 0)[:, None] + np.arange(NEIGHBOURS)
    nodes = line[near]
    # In units of the spacing, so that products neither overflow nor underflow.
    unit = (nodes[:, -1] - nodes[:, 0])[:, None] / NEIGHBOURS
    from_x = np.where(inside[:, None], points[:, None] - nodes, 0.0) / unit
    from_node = (nodes[:, :, None] - nodes[:, None, :]) / unit[:, :, None]
    others = ~np.eye(NEIGHBOURS, dtype=bool)
    ratios = np.where(others, from_x[:, None, :], 1.0) / np.where(others, from_node, 1.0)
    local = ratios.prod(axis=2) * inside[:, None]
    weights = np.zeros((points.size, N + 1))
    np.add.at(weights, (np.arange(points.size)[:, None], places[near]), local)
    return weights[:, :N].reshape(*x.shape, N)
