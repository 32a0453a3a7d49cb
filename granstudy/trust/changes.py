"""What a change of a density does to its temperature and kurtosis."""

from typing import NamedTuple

import numpy as np

from granstudy.velocity.space import VelocitySpace

STEPS_COUNT = 2.0
"""Factor on the estimated errors of steps, which are right for one rate of change alone."""


class Change(NamedTuple):
    """A change, or a rate of change: of T relative to T, and of a2 over 1 + a2."""

    temperature: float
    a2: float

    def scaled(self, factor: float) -> "Change":
        """The change times a factor."""
        return Change(factor * self.temperature, factor * self.a2)

    def plus(self, other: "Change") -> "Change":
        """The sum of two changes."""
        return Change(self.temperature + other.temperature, self.a2 + other.a2)


def counted(error: Change) -> Change:
    """An error by steps as it counts."""
    return Change(STEPS_COUNT * abs(error.temperature), STEPS_COUNT * abs(error.a2))


def change_of_moments(
    grid: VelocitySpace, f: np.ndarray, change: np.ndarray, scaling: float = 0.0
) -> Change:
    """The change of T and a2 by a small change of a density, to first order.

    T is proportional to ∫V f/ρ and 1 + a2 to ρ ∫V² f/(∫V f)², with V = |v − u|² about the bulk velocity u,
    which may change as well.

    Parameters
    ----------
    grid : VelocitySpace
    f, change : ndarray, shape grid.shape
    scaling : float
        Change of log T by velocities that the grid does not see: 2 log θ of a rescaled frame.
    """
    m = grid.velocity_moments(f)
    u = m.momentum / m.density
    c = [v - ui for v, ui in zip(grid.velocities(), u, strict=True)]
    V = sum(np.square(ci) for ci in c)
    weighted, weighted_change = grid.measure * f, grid.measure * change
    second, fourth = np.sum(V * weighted), np.sum(V**2 * weighted)
    mass = np.sum(weighted_change)
    second_change, fourth_change = np.sum(V * weighted_change), np.sum(V**2 * weighted_change)
    if m.momentum.any():
        flux = np.array([np.sum(ci * V * weighted) for ci in c])
        moved = np.array([np.sum(ci * weighted_change) for ci in c]) / m.density
        fourth_change -= 4.0 * moved @ flux
    relative = second_change / second
    return Change(
        temperature=float(relative - mass / m.density + scaling),
        a2=float(fourth_change / fourth + mass / m.density - 2.0 * relative),
    )
