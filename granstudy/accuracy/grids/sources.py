"""Where a density comes from when it is put on a new grid: the initial one, or a run's present one."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from granstudy.accuracy.grids.regrid import (
    Kept,
    kept_moments,
    rate_difference,
    regrid,
    with_moments,
)
from granstudy.accuracy.leg import Gas
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import a2_relaxation
from granstudy.trust.initial_errors import StartMoments
from granstudy.trust.pair_rates import CollisionRates, Rates
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.space import VelocitySpace

EDGE, UNSEEN = 1e-8, 0.5
"""Errors of a density's moments by the sums of a grid between which it has an edge: less is round-off and
tails, more is a core that the grid does not see."""

REFERENCE_SPEEDS, REFERENCE_RADIUS = 256, 12.0
"""Speeds, and R in units of √T, of the grid that the shape of a density with an edge is held against."""

SHAPES_COUNT = 2.0
"""Factor on errors of the shape: the reference has errors too."""


class Source(Protocol):
    """A density that any grid of a kind can be given."""

    def on(self, grid: VelocitySpace) -> np.ndarray:
        """The density on a grid, with its true moments."""

    def lost(self, grid: VelocitySpace) -> Change:
        """Errors of T (relative) and a2 that the grid made, had the moments not been given back."""


@dataclass(frozen=True)
class Initial:
    """The initial density of a gas, with true moments ``true``."""

    gas: Gas
    true: StartMoments

    def on(self, grid: VelocitySpace) -> np.ndarray:
        """The density at the nodes, given its true ρ, T and a2 by the least change."""
        return with_moments(self.gas.scene.density(grid), grid, kept_of(self.true, grid.dim))

    def lost(self, grid: VelocitySpace) -> Change:
        """Errors of T and a2 by the grid's sums; an error of the mass counts as one of T.

        Over speeds, only the shape of a density with an edge counts: its moments are given back, so that T
        and a2 go wrong only as far as their rates do, until the shape relaxes.
        """
        f = self.gas.scene.density(grid)
        kept, d = kept_moments(f, grid), grid.dim
        T = kept.second / (d * kept.density)
        a2 = kept.fourth / kept.density / (d * (d + 2) * T**2) - 1.0
        mass = abs(kept.density / self.true.density - 1.0)
        lost = Change(abs(T / self.true.temperature - 1.0) + mass, abs(a2 - self.true.a2) + mass)
        if not isinstance(grid, RadialGrid) or max(lost) < EDGE or max(lost) > UNSEEN:
            return lost
        exact, found = self._reference, CollisionRates(self.gas.scene, grid)(self.on(grid))
        relaxing = a2_relaxation(self.gas.scene.restitution, d, self.gas.scene.kernel.exponent)
        by_shape = rate_difference(found, exact, kept_of(self.true, d))
        by_shape = by_shape.scaled(SHAPES_COUNT / (relaxing * exact.frequency))
        return Change(*map(min, lost, by_shape))

    @cached_property
    def _reference(self) -> Rates:
        """Exact rates of the density over many speeds."""
        R = REFERENCE_RADIUS * float(np.sqrt(self.true.temperature))
        reference = RadialGrid(self.gas.scene.dim, REFERENCE_SPEEDS, R)
        return CollisionRates(self.gas.scene, reference)(self.on(reference))


@dataclass(frozen=True)
class Present:
    """A density on a grid, that another grid of the same kind interpolates."""

    f: np.ndarray
    grid: VelocitySpace

    def on(self, grid: VelocitySpace) -> np.ndarray:
        """The density interpolated locally, with its moments kept."""
        return regrid(self.f, self.grid, grid)

    def lost(self, grid: VelocitySpace) -> Change:
        """Nothing: moments are kept. What became of the shape shows in the exact rates (`shape_error`)."""
        return Change(0.0, 0.0)


def kept_of(true: StartMoments, dim: int) -> Kept:
    """Moments of a density at rest."""
    second = dim * true.density * true.temperature
    fourth = (dim + 2) / dim * second**2 / true.density * (1.0 + true.a2)
    return Kept(true.density, np.zeros(dim), second, fourth)


def shape_error(
    gas: Gas, before: tuple[np.ndarray, VelocitySpace], after: tuple[np.ndarray, VelocitySpace]
) -> Change:
    """What a change of grid did to the shape: by how much the exact rates of T and a2 differ.

    Both densities have the same moments; their exact rates differ as their shapes do.
    """
    one, other = (CollisionRates(gas.scene, grid)(f) for f, grid in (before, after))
    return rate_difference(one, other, kept_moments(*before))
