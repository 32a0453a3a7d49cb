"""Velocities drawn from an initial density by rejection, cell by cell of a grid (docs/particles.md §2)."""

import numpy as np
from scipy.ndimage import maximum_filter

from granstudy.model.scene import Scene
from granstudy.velocity.cartesian import VelocityGrid

MARGIN = 1.05
"""A cell's majorant over the largest density at its corners and centre."""

FLOOR = 0.02
"""A cell's majorant over that of its neighbours, at least: mass that no corner sees is found."""

NEGATIVE = 1e-12
"""−f/max f up to which a density is taken to be 0: round-off."""


class Sampler:
    """Draws from a scene's density on the box [−L, L]^d.

    A velocity is proposed uniformly in a cell that is chosen by its majorant M ≈ max f, and becomes
    ⌊f/M + U⌋ particles, U uniform in [0, 1): one with probability f/M where M is a bound; where it is not,
    two or more at times. The expected density is f in either case.

    Raises
    ------
    ValueError
        For a density that is negative, not finite, or without mass on the grid.
    """

    def __init__(self, scene: Scene, grid: VelocityGrid) -> None:
        self._initial = scene.initial
        self._grid = grid
        centres = scene.density(grid)
        self._zero = -NEGATIVE * centres.max()
        corner = np.linspace(-grid.L, grid.L, grid.N + 1)
        bound = self._density(*np.meshgrid(*(corner,) * grid.dim, indexing="ij"))
        for axis in range(grid.dim):
            low, high = (np.arange(grid.N) + shift for shift in (0, 1))
            bound = np.maximum(np.take(bound, low, axis), np.take(bound, high, axis))
        bound = np.maximum(bound, self._not_negative(centres))
        majorant = np.maximum(MARGIN * bound, FLOOR * maximum_filter(bound, size=3)).ravel()
        self._cells = np.flatnonzero(majorant)
        self._majorant = majorant[self._cells]
        self._chance = self._majorant / self._majorant.sum()
        self._yield = min(1.0, centres.sum() / majorant.sum())

    def _not_negative(self, f: np.ndarray) -> np.ndarray:
        if f.min() < self._zero:
            raise ValueError(
                f"initial={self._initial!r}: method 'dsmc' needs a density that is nowhere negative; "
                f"this one falls to {f.min():.3g}"
            )
        return np.maximum(f, 0.0)

    def _density(self, *v: np.ndarray) -> np.ndarray:
        f = np.asarray(self._initial(*v), dtype=float)
        if f.shape != v[0].shape or not np.all(np.isfinite(f)):
            raise ValueError(
                f"initial={self._initial!r}: must return finite values of the shape of its velocity "
                f"components, got {f.shape} for {v[0].shape}"
            )
        return self._not_negative(f)

    def draw(self, n: int, rng: np.random.Generator) -> np.ndarray:
        """``n`` velocities, shape (n, d)."""
        drawn: list[np.ndarray] = []
        missing = n
        while missing > 0:
            proposals = int(1.1 * missing / self._yield) + 32
            cell = np.repeat(self._cells, (counts := rng.multinomial(proposals, self._chance)))
            majorant = np.repeat(self._majorant, counts)
            index = np.unravel_index(cell, self._grid.shape)
            spread = rng.random((self._grid.dim, proposals)) - 0.5
            v = [
                self._grid.nodes[i] + self._grid.spacing * x
                for i, x in zip(index, spread, strict=True)
            ]
            copies = np.floor(self._density(*v) / majorant + rng.random(proposals)).astype(int)
            found = np.repeat(np.stack(v, axis=1), copies, axis=0)
            # They come cell by cell: those left out must be any of them.
            drawn.append(found[rng.permutation(len(found))[:missing]])
            missing -= len(drawn[-1])
        return np.concatenate(drawn)


def quiet(v: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Velocities about their mean, mapped linearly to have exactly this covariance ⟨cc⟩; shape (n, d).

    Raises
    ------
    ValueError
        If the covariance is not positive definite.
    """
    c = v - v.mean(axis=0)
    try:
        wanted = np.linalg.cholesky(covariance)
    except np.linalg.LinAlgError:
        raise ValueError(
            f"initial: the grid's pressure tensor over density is {covariance.tolist()}, which is not "
            "positive definite; take a larger N, the density is narrower than a cell"
        ) from None
    return np.ascontiguousarray(
        c @ (wanted @ np.linalg.inv(np.linalg.cholesky(c.T @ c / len(c)))).T
    )
