"""Tails of states to an accuracy: the rate that K says, and the slope as far out as two grids agree."""

from typing import NamedTuple

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.model.scene import Scene
from granstudy.states.tail import filtered_values
from granstudy.trust.flags import Status
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.sphere import sphere_area

FIRST, STEP, HALF_WIDTH = 2.0, 0.25, 0.25
"""First speed at which slopes are compared, the distance of such speeds, and the half width of a slope."""

INNER = 0.5
"""Part of R within which slopes are compared: beyond it the tail feels where the grid ends."""

AGREEMENT = 0.01
"""Relative difference of two grids' slopes up to which they agree."""


SLOPE_SAFETY = 3.0
"""Factor on the difference of two grids' slopes."""


class Slope(NamedTuple):
    """−d ln f/d c^q (d ln c for q = 0) at a speed c, in units of √T, and its error."""

    speed: float
    value: float
    error: float


NOWHERE = Slope(np.nan, np.nan, np.nan)
"""Where two grids agree nowhere."""


def tail_power(scene: Scene, state: str) -> float:
    """q of the tail exp(−A c^q); 0 for the power law of cooling Maxwell molecules."""
    exponent = float(scene.kernel.exponent)
    return 1.0 + exponent / 2.0 if state == "heated" else exponent


def tail_rate(scene: Scene, state: str, K: float, K_error: float) -> tuple[float, float]:
    """A of the tail exp(−A c^q), or s of c^{−s}, and its error, by that of K.

    A = 2|S|C_λ/(λK) of cooling, 2/(2+λ) √(2|S|C_λ/K) of heated gases (`granstudy.theory.tails`), with the
    K of the state. s = d + p (`granstudy.theory.maxwell_tail_exponent`).
    """
    exponent = float(scene.kernel.exponent)
    ratio = sphere_area(scene.dim) * scene.kernel.strength / K
    if state == "heated":
        rate = 2.0 / (2.0 + exponent) * float(np.sqrt(2.0 * ratio))
        return rate, 0.5 * K_error * rate
    if exponent == 0.0:
        assert not callable(scene.restitution)
        s = scene.dim + theory.maxwell_tail_exponent(float(scene.restitution), scene.dim)
        return s, K_error * s
    rate = 2.0 / exponent * ratio
    return rate, K_error * rate


def far_slope(coarse: xr.Dataset, fine: xr.Dataset, dim: int, unit: float, power: float) -> Slope:
    """The fine grid's slope at the largest speed up to which both grids agree; NaN where they nowhere do.

    Densities are compared as they are and filtered (`granstudy.states.tail.filtered_values`); the farther
    speed counts. The error is `SLOPE_SAFETY` times the largest difference at this speed and the two before.

    Parameters
    ----------
    coarse, fine : xarray.Dataset
        A state on two radial grids.
    dim : int
    unit : float
        √T on the grids' velocities.
    power : float
        q; 0 for ln c.
    """
    if any(int(ds["status"]) != Status.OK for ds in (coarse, fine)):
        return NOWHERE
    speeds = np.arange(FIRST, INNER * float(coarse["R"]) / unit, STEP)
    found = []
    for filtered in (False, True):
        slopes = [_slopes(ds, dim, speeds, unit, power, filtered) for ds in (coarse, fine)]
        found.append(_agreed(speeds, *slopes))
    return max(found, key=lambda slope: np.nan_to_num(slope.speed))


def _agreed(speeds: np.ndarray, coarse: np.ndarray, fine: np.ndarray) -> Slope:
    """The fine slopes' last one before the two first disagree."""
    difference = np.abs(fine - coarse)
    agree = difference <= AGREEMENT * np.abs(fine)  # False for NaN
    count = agree.size if agree.all() else int(np.argmin(agree))
    if count == 0:
        return NOWHERE
    error = SLOPE_SAFETY * float(difference[max(count - 3, 0) : count].max())
    return Slope(float(speeds[count - 1]), float(fine[count - 1]), error)


def _slopes(
    ds: xr.Dataset, dim: int, speeds: np.ndarray, unit: float, power: float, filtered: bool
) -> np.ndarray:
    """Slopes of a grid's density; NaN where the density is not positive."""
    grid = RadialGrid(dim, int(ds["N"]), float(ds["R"]))
    g = ds["g"].values
    lower, upper = speeds - HALF_WIDTH, speeds + HALF_WIDTH
    values = filtered_values if filtered else RadialGrid.evaluate
    inner, outer = (values(grid, g, unit * c) for c in (lower, upper))
    with np.errstate(invalid="ignore", divide="ignore"):
        fall = np.where((inner > 0.0) & (outer > 0.0), np.log(inner) - np.log(outer), np.nan)
    width = np.log(upper / lower) if power == 0.0 else upper**power - lower**power
    return np.asarray(fall / width)
