"""Velocities drawn from an initial density by rejection, cell by cell of a grid (docs/particles.md §2)."""

import numpy as np
import scipy

from granstudy.model.scene import Scene
from granstudy.support.checks import answer
from granstudy.velocity.cartesian import VelocityGrid

MARGIN = 1.05
"""Majorant of a cell, over the largest density at its corners and centre."""

FLOOR = 0.02
"""Least majorant of a cell, over the majorants of its neighbours: finds mass that no corner sees."""

LEAST_YIELD = 1e-4
"""Smallest part of proposals that become particles; below, the density lies between the nodes."""

AT_ONCE = 10**6
"""Proposals made at once, unless more particles than half of them are missing."""

NEGATIVE = 1e-12
"""Largest −f/max f that counts as round-off of 0."""


class Sampler:
    """Draws velocities from the initial density of a scene, on the box [−L, L]^d of a grid.

    A cell is chosen in proportion to its majorant M ≈ max f, and a velocity is proposed uniformly in the
    cell. The velocity becomes ⌊f/M + U⌋ particles, U uniform in [0, 1). Where M bounds f, one particle
    results, with probability f/M; elsewhere two or more at times. The expected density is f in either case.

    Raises
    ------
    ValueError
        For a density that is negative, not finite, has no mass on the grid, or has all of it between nodes.
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
        majorant = np.maximum(
            MARGIN * bound, FLOOR * scipy.ndimage.maximum_filter(bound, size=3)
        ).ravel()
        self._cells = np.flatnonzero(majorant)
        self._majorant = majorant[self._cells]
        self._chance = self._majorant / self._majorant.sum()
        self._yield = min(1.0, centres.sum() / majorant.sum())
        if self._yield < LEAST_YIELD:
            raise ValueError(
                f"initial={self._initial!r}: holds at the nodes {self._yield:.1g} of what it holds between "
                f"them; take a larger N than {grid.N}, or a smaller R than {grid.R:g}"
            )

    def _not_negative(self, f: np.ndarray) -> np.ndarray:
        """``f`` with negative round-off set to 0; ValueError for values below."""
        if f.min() < self._zero:
            raise ValueError(
                f"initial={self._initial!r}: method 'dsmc' needs a density that is nowhere negative; "
                f"this one falls to {f.min():.3g}"
            )
        return np.maximum(f, 0.0)

    def _density(self, *v: np.ndarray) -> np.ndarray:
        """The initial density at the velocities ``v``, checked."""
        f = answer(f"initial={self._initial!r}", self._initial, *v)
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
            proposals = min(proposals, max(2 * missing, AT_ONCE))
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
            # Velocities come cell by cell: a random choice of them must be dropped.
            drawn.append(found[rng.permutation(len(found))[:missing]])
            missing -= len(drawn[-1])
        return np.concatenate(drawn)


def quiet(v: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Velocities about their mean, mapped linearly to have the covariance ⟨cc⟩ given, exactly.

    Parameters
    ----------
    v : ndarray, shape (n, d)
    covariance : ndarray, shape (d, d)

    Returns
    -------
    ndarray, shape (n, d)

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
