"""Where a density comes from when it is put on a new grid: the initial one, or a run's present one."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from granstudy.accuracy.grids.regrid import Kept, kept_moments, regrid, with_moments
from granstudy.accuracy.leg import Gas
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import imbalance
from granstudy.trust.initial_errors import StartMoments
from granstudy.trust.pair_rates import CollisionRates
from granstudy.velocity.space import VelocitySpace


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
        """Errors of T and a2 by the grid's sums; an error of the mass counts as one of T."""
        f = self.gas.scene.density(grid)
        kept, d = kept_moments(f, grid), grid.dim
        T = kept.second / (d * kept.density)
        a2 = kept.fourth / kept.density / (d * (d + 2) * T**2) - 1.0
        mass = abs(kept.density / self.true.density - 1.0)
        return Change(abs(T / self.true.temperature - 1.0) + mass, abs(a2 - self.true.a2) + mass)


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
) -> tuple[float, float, float]:
    """What a change of grid did to the shape: differences of the exact T'/T and a2'/(1 + a2), and frequency.

    Both densities have the same moments; their exact rates differ as their shapes do.
    """
    nothing = Change(0.0, 0.0)
    rates = [imbalance(CollisionRates(gas.scene, grid), f, nothing) for f, grid in (before, after)]
    cooling = abs(rates[0].cooling - rates[1].cooling)
    return cooling, abs(rates[0].shaping - rates[1].shaping), rates[1].frequency
