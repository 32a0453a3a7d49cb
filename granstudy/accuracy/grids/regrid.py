"""A density on another grid: local interpolation, then the least change that keeps its moments.

What a trigonometric or Bessel series does between nodes, 10⁻⁶ of the largest value everywhere, becomes 0.1 in
a2 once it is moved onto nodes. Polynomials through `POINTS` neighbours leave noise where it is
(docs/method.md §5). Mass, bulk velocity, energy and fourth moment are known exactly before, and given back
after.
"""

from typing import NamedTuple

import numpy as np

from granstudy.trust.changes import Change
from granstudy.trust.pair_rates import Rates
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.space import VelocitySpace

POINTS = 16
"""Neighbours that a value is interpolated from."""


class Kept(NamedTuple):
    """Moments that a change of the grid keeps.

    Attributes
    ----------
    density : float
        ρ.
    velocity : ndarray, shape (d,)
        u.
    second, fourth : float
        ∫|v−u|² f and ∫|v−u|⁴ f.
    """

    density: float
    velocity: np.ndarray
    second: float
    fourth: float


def kept_moments(f: np.ndarray, grid: VelocitySpace) -> Kept:
    """The moments of a density that a change of its grid keeps."""
    m = grid.velocity_moments(f)
    second = float(np.trace(m.pressure))
    return Kept(float(m.density), m.momentum / m.density, second, float(m.fourth))


def rate_difference(mine: Rates, its: Rates, kept: Kept) -> Change:
    """Differences of T'/T and of a2'/(1 + a2) between two densities with the same moments."""
    cooling = 2.0 * (mine.energy - its.energy) / kept.second
    fourth = (mine.fourth - its.fourth) / kept.fourth
    return Change(abs(cooling), abs(fourth - 2.0 * cooling))


def regrid(f: np.ndarray, source: VelocitySpace, target: VelocitySpace) -> np.ndarray:
    """A density on another grid of the same kind, with the moments that it had.

    Parameters
    ----------
    f : ndarray, shape source.shape
    source, target : VelocitySpace
        Two Cartesian or two radial grids.

    Returns
    -------
    ndarray, shape target.shape
    """
    if source == target:
        return f
    return with_moments(interpolated(f, source, target), target, kept_moments(f, source))


def interpolated(f: np.ndarray, source: VelocitySpace, target: VelocitySpace) -> np.ndarray:
    """The density at the nodes of another grid of the same kind; 0 beyond the border of its own."""
    if isinstance(source, RadialGrid):
        assert isinstance(target, RadialGrid)
        return radial_matrix(source, target.nodes) @ f
    assert isinstance(source, VelocityGrid) and isinstance(target, VelocityGrid)
    matrix = line_matrix(source, target.nodes)
    for axis in range(source.dim):
        f = np.moveaxis(np.tensordot(matrix, f, axes=(1, axis)), 0, axis)
    return np.ascontiguousarray(f)


def line_matrix(grid: VelocityGrid, at: np.ndarray) -> np.ndarray:
    """Matrix from values at the nodes of one dimension to values at velocities ``at``, 0 beyond the box."""
    first, weights = line_weights(grid, at)
    matrix = np.zeros((len(at), grid.N + 2 * POINTS))
    np.put_along_axis(matrix, first[:, None] + POINTS + np.arange(POINTS), weights, axis=1)
    return matrix[:, POINTS:-POINTS]


def line_weights(grid: VelocityGrid, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The first of the `POINTS` nodes about each velocity, and the nodes' weights.

    Nodes are numbered from 0; those below 0 and from N on lie beyond the box, where densities are 0. Weights
    of velocities beyond the box are 0.

    Returns
    -------
    tuple of ndarray, shapes (n,) and (n, POINTS)
    """
    place = (np.asarray(at) - grid.nodes[0]) / grid.spacing
    inside = np.abs(at) <= grid.L
    place = np.where(inside, place, 0.0)
    first = np.floor(place).astype(int) - (POINTS // 2 - 1)
    x = place - first
    nodes = np.arange(POINTS)
    binomial = np.cumprod([1.0, *((POINTS - k) / k for k in range(1, POINTS))])
    barycentric = (-1.0) ** nodes * binomial
    difference = x[:, None] - nodes
    hit = difference == 0.0
    weights = barycentric / np.where(hit, 1.0, difference)
    weights /= weights.sum(axis=1, keepdims=True)
    weights = np.where(hit.any(axis=1, keepdims=True), hit, weights)
    return first, weights * inside[:, None]


def radial_matrix(grid: RadialGrid, at: np.ndarray) -> np.ndarray:
    """Matrix from values of an isotropic density at its speeds to values at speeds ``at``, 0 beyond L.

    The nodes are mirrored at r = 0, and continued beyond L, where densities are 0.
    """
    further = RadialGrid(grid.dim, grid.N + POINTS, grid.R)
    speeds = further.nodes * (grid.nodes[0] / further.nodes[0])
    line = np.concatenate([-speeds[::-1], speeds])
    zero = len(speeds)
    places = np.clip(np.searchsorted(line, at) - POINTS // 2, 0, len(line) - POINTS)
    near = places[:, None] + np.arange(POINTS)
    weights = lagrange_weights(line[near], np.asarray(at))
    owner = np.where(near < zero, zero - 1 - near, near - zero)
    matrix = np.zeros((len(at), len(speeds)))
    np.add.at(matrix, (np.arange(len(at))[:, None], owner), weights)
    matrix[np.asarray(at) >= grid.L] = 0.0
    return matrix[:, : grid.N]


def lagrange_weights(nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Weights at x_i of the polynomial through values at ``nodes``, a row for each; shape as nodes'."""
    count = nodes.shape[1]
    scale = nodes[:, -1:] - nodes[:, :1]
    apart = (nodes[:, :, None] - nodes[:, None, :]) / scale[:, :, None] + np.eye(count)
    barycentric = 1.0 / np.prod(apart, axis=2)
    difference = (x[:, None] - nodes) / scale
    hit = difference == 0.0
    weights = barycentric / np.where(hit, 1.0, difference)
    weights /= weights.sum(axis=1, keepdims=True)
    return np.where(hit.any(axis=1, keepdims=True), hit, weights)


def with_moments(f: np.ndarray, grid: VelocitySpace, kept: Kept) -> np.ndarray:
    """The density changed by little, so that it has these moments exactly.

    f* = f + M Σ_j λ_j φ_j with φ = 1, v_i − u_i, |v−u|², |v−u|⁴, and M the Maxwellian of the gas: the change
    with the least ∫(f* − f)²/M dv (as Q's in docs/method.md §9). On a grid too coarse for that
    the moments come as near as they can.
    """
    u = kept.velocity
    c = [v - ui for v, ui in zip(grid.velocities(), u, strict=True)]
    square = np.broadcast_to(sum(ci**2 for ci in c), grid.shape)
    moving = len(grid.invariants()["momentum"]) > 0
    drift = [np.broadcast_to(ci, grid.shape) for ci in c] if moving else []
    phi = np.array([np.ones(grid.shape), *drift, square, square**2]).reshape(-1, f.size)
    wanted = np.array([kept.density, *(0.0 for _ in drift), kept.second, kept.fourth])
    temperature = kept.second / (grid.dim * kept.density)
    maxwellian = np.exp(-square / (2.0 * temperature)).ravel()
    weighted = phi * np.ravel(np.broadcast_to(grid.measure, grid.shape))
    # scaled, so that the equations are well conditioned
    size = np.sqrt(np.sum(phi**2 * maxwellian, axis=1))
    size = np.where(size > 0.0, size, 1.0)
    matrix = (weighted / size[:, None]) @ (phi / size[:, None] * maxwellian).T
    missing = (wanted - weighted @ f.ravel()) / size
    multipliers = np.linalg.lstsq(matrix, missing)[0] / size
    return f + ((multipliers @ phi) * maxwellian).reshape(grid.shape)
