"""The check that a scene is isotropic about v = 0, which the method `radial` needs."""

from collections.abc import Callable
from functools import cache, lru_cache

import numpy as np

from granstudy.model.densities import is_named
from granstudy.model.scene import Scene
from granstudy.support.checks import answer
from granstudy.velocity.radial import BALL_RATIO

SPEEDS = 64
"""Speeds at which an initial density is compared between directions."""

DIRECTIONS = 24
"""Directions that are compared. No symmetry of a lattice or of the axes relates them."""

TOLERANCE = 1e-10
"""Largest difference between directions, over the largest value: the round-off of smooth densities."""

GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
"""Golden ratio: part of a turn from one direction to the next."""


def check_isotropic(scene: Scene, R: float) -> None:
    """Raise ValueError unless the method `radial` can model the scene, truncated at R.

    Two conditions: the restitution is a constant, and the initial density is isotropic about v = 0 on the
    ball |v| < L. Isotropy is verified at `SPEEDS` speeds in `DIRECTIONS` directions.
    """
    if callable(scene.restitution):
        raise ValueError(
            f"restitution={scene.restitution!r}: method 'radial' takes a constant, not a function of "
            "the impact speed; take method 'fast'"
        )
    if is_named(scene.initial):
        _check_named(scene.initial, scene.dim, R)
    else:
        _check_density(scene.initial, scene.dim, R)


def _check_density(initial: Callable[..., np.ndarray], dim: int, R: float) -> None:
    """Raise ValueError unless a density is isotropic about v = 0 on the ball |v| < L."""
    speeds = BALL_RATIO * R * (np.arange(SPEEDS) + 0.5) / SPEEDS
    v = [np.outer(speeds, component) for component in directions(dim).T]
    f = answer(f"initial={initial!r}", initial, *v)
    if f.shape != v[0].shape:
        raise ValueError(
            f"initial={initial!r}: must return an array of the shape of its velocity "
            f"components, got {f.shape} for {v[0].shape}"
        )
    if not np.all(np.isfinite(f)):
        raise ValueError(f"initial={initial!r}: returns NaN or infinite values")
    spread = np.ptp(f, axis=1)
    worst = int(np.argmax(spread))
    if spread[worst] > TOLERANCE * np.max(np.abs(f)):
        low, high = f[worst].min(), f[worst].max()
        raise ValueError(
            f"initial={initial!r}: method 'radial' needs a density that is isotropic about "
            f"v = 0; at |v| = {speeds[worst]:.3g} this one goes from {low:.3g} to {high:.3g} with the "
            "direction; take method 'fast'"
        )


_check_named = lru_cache(maxsize=1024)(_check_density)
"""`_check_density` of densities that are known by their values (`granstudy.model.densities.is_named`)."""


@cache
def directions(dim: int) -> np.ndarray:
    """Unit vectors spread by the golden ratio, shape (`DIRECTIONS`, dim)."""
    angle = 2.0 * np.pi * GOLDEN * np.arange(DIRECTIONS)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if dim == 2:
        return circle
    height = 1.0 - (2.0 * np.arange(DIRECTIONS) + 1.0) / DIRECTIONS
    return np.column_stack([np.sqrt(1.0 - height**2)[:, None] * circle, height])
