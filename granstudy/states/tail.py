"""The tail of a state: how fast it falls, as far out as the grid resolves it (docs/states.md §3)."""

from typing import NamedTuple

import numpy as np

from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.space import VelocitySpace

ABOVE_FLOOR = 1000.0
"""A density counts as resolved where it is so many times the error that the grid shows."""


class TailSlope(NamedTuple):
    """Local slopes of −ln f."""

    speeds: np.ndarray
    """Speeds c in units of √T, midway between nodes."""
    slopes: np.ndarray
    """−d ln f/d c^q; −d ln f/d ln c where q = 0."""
    floor: float
    """Density below which slopes are left out."""


def tail_slope(g: np.ndarray, grid: VelocitySpace, temperature: float, power: float) -> TailSlope:
    """Slopes −d ln g/d c^q between neighbouring nodes, out to where g first falls to its floor.

    The floor is `ABOVE_FLOOR` times the largest of three errors: −min g, |g| at the grid's border, and the
    round-off of max g. The nodes are all nodes of a radial grid; of a Cartesian grid, the nodes nearest to
    the positive half of the first axis.

    Parameters
    ----------
    g : ndarray, shape grid.shape
    grid : VelocitySpace
    temperature : float
        T of g, the unit of the speeds squared.
    power : float
        q ≥ 0. For q = 0 the slope is taken against ln c, and is the exponent of a power law.
    """
    speeds, values = _profile(g, grid)
    round_off = np.finfo(float).eps * float(g.max())
    floor = ABOVE_FLOOR * max(-float(g.min()), grid.edge(g), round_off)
    below = np.flatnonzero(values <= floor)
    count = int(below[0]) if below.size else values.size
    c, ln_g = speeds[:count] / np.sqrt(temperature), np.log(values[:count])
    abscissa = np.log(c) if power == 0.0 else c**power
    return TailSlope((c[1:] + c[:-1]) / 2, -np.diff(ln_g) / np.diff(abscissa), floor)


def filtered_values(grid: RadialGrid, g: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """A radial density at any speeds below L, without the oscillations that the last modes leave.

    A density with a sharp top, as of small e and λ, has a spectrum that falls slowly. The series that ends at
    k_N then oscillates far out, where the density itself is smaller. The filter e^{−36(k/k_N)^8} takes the
    last modes away, and leaves a tail as it is.
    """
    modes = grid.wavenumbers / grid.wavenumbers[-1]
    return grid.mode_values(speeds) @ (np.exp(-36.0 * modes**8) * (grid.analysis @ g))


def _profile(g: np.ndarray, grid: VelocitySpace) -> tuple[np.ndarray, np.ndarray]:
    """Increasing speeds, and g at these speeds."""
    speeds = np.sqrt(np.broadcast_to(sum(np.square(v) for v in grid.velocities()), grid.shape))
    if len(grid.shape) == 1:
        return speeds, g
    for _ in range(grid.dim - 1):
        speeds, g = speeds[..., speeds.shape[-1] // 2], g[..., g.shape[-1] // 2]
    outwards = slice(speeds.size // 2, None)
    return speeds[outwards], g[outwards]
