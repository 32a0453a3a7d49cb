"""The isotropic part of a density, and whether a run may go on with that part alone.

The mean over directions about the bulk velocity keeps ρ, T and a2 exactly. A density f0 + δ, δ without an
isotropic part, changes its T and a2 at the rates of f0 and of pairs of δ: terms that are linear in δ vanish.
So the error of going on with f0 is of second order.
"""

import numpy as np

from granstudy.accuracy.grids.regrid import (
    POINTS,
    kept_moments,
    line_weights,
    rate_difference,
    with_moments,
)
from granstudy.model.scene import Scene
from granstudy.quadrature.circle import circle_rule
from granstudy.quadrature.sphere import sphere_rule
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import a2_relaxation
from granstudy.trust.pair_rates import CollisionRates
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.radial import BALL_RATIO, RadialGrid

DIRECTIONS = {2: 64, 3: 302}
"""Directions of the mean, by dimension."""

SQUARE = 2.0
"""Rate at which the square of an anisotropy decays, over its own."""

SPEEDS_PER_POINT = 1.5
"""Speeds of the mean's grid over half the points of the Cartesian grid in a dimension."""


def isotropic_part(f: np.ndarray, grid: VelocityGrid) -> tuple[np.ndarray, RadialGrid]:
    """The mean of a density over all directions about its bulk velocity, on a fine radial grid.

    The density is interpolated locally; ρ, T and a2 are kept exactly.

    Returns
    -------
    tuple
        The mean at the speeds |v − u|, and their grid, which reaches as far as the box.
    """
    kept = kept_moments(f, grid)
    fine = RadialGrid(grid.dim, int(SPEEDS_PER_POINT * grid.N / 2), grid.L / BALL_RATIO)
    mean = spherical_mean(f, grid, fine.nodes, kept.velocity)
    return with_moments(mean, fine, kept._replace(velocity=np.zeros(grid.dim))), fine


def spherical_mean(
    f: np.ndarray, grid: VelocityGrid, speeds: np.ndarray, centre: np.ndarray
) -> np.ndarray:
    """Mean of a density over the spheres |v − centre| = r, for each of the ``speeds`` r."""
    count = DIRECTIONS[grid.dim]
    rule = circle_rule(count) if grid.dim == 2 else sphere_rule(count, "lebedev")
    share = rule.weights / rule.weights.sum()
    padded = np.pad(f, POINTS)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (POINTS,) * grid.dim)
    mean = np.empty(len(speeds))
    for i, r in enumerate(speeds):
        along = [line_weights(grid, u + r * x) for u, x in zip(centre, rule.points.T, strict=True)]
        local = windows[tuple(first + POINTS for first, _ in along)]
        for _, weights in reversed(along):
            local = np.einsum("p...x,px->p...", local, weights)
        mean[i] = share @ local
    return mean


def switching_error(
    scene: Scene, f: np.ndarray, grid: VelocityGrid, mean: np.ndarray, fine: RadialGrid
) -> Change:
    """Errors of T (relative) and a2 that a run makes when it goes on with the isotropic part.

    The difference of the exact rates of T and a2 of both, over the rate at which it vanishes: the rest of an
    anisotropic density decays at about the rate of errors of the shape, and its square twice as fast.

    Parameters
    ----------
    scene : Scene
        Kernel and (constant) restitution count.
    f : ndarray, shape grid.shape
    mean : ndarray, shape fine.shape
        Its isotropic part.
    """
    mine, its = CollisionRates(scene, grid)(f), CollisionRates(scene, fine)(mean)
    kept = kept_moments(f, grid)
    relaxation = a2_relaxation(scene.restitution, scene.dim, scene.kernel.exponent) * mine.frequency
    difference = rate_difference(mine, its, kept)
    return difference.scaled(1.0 / (SQUARE * relaxation))


def anisotropy(pressure: np.ndarray) -> float:
    """Largest part of the pressure tensor that is not isotropic, over the isotropic part."""
    P = np.trace(pressure) / len(pressure)
    return float(np.max(np.abs(pressure / P - np.eye(len(pressure)))))
