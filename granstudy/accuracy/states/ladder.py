"""The grids that a state is found on, one after the other, and its errors by their differences."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import xarray as xr

from granstudy.accuracy.asked import Accuracy
from granstudy.trust.flags import Status

LADDER = (
    (20, 8.0),
    (24, 9.5),
    (32, 11.0),
    (40, 13.0),
    (48, 15.5),
    (64, 20.0),
    (88, 27.0),
    (120, 37.0),
    (170, 53.0),
    (250, 78.0),
)
"""Speeds, and R in units of √T, of the grids that are tried."""

SAFETY = 3.0
"""Factor on what the changes from grid to grid say of the error."""

FASTEST = 0.2
"""Least ratio of a change to the one before that is counted on for the changes to come."""

EXPECTED = 0.7
"""A change counts as at least this part of what the changes before let expect: one may be small by chance."""

FEWEST = 4
"""Grids that a state is found on at least: three changes, and so two of their ratios."""

ROUND_OFF = 1e-8
"""Changes so small are round-off and what Newton's method leaves; no error is less."""

EPSILON = 2.0 * float(np.finfo(float).eps)
"""Round-off of a density, over its largest value."""

BALANCED = 3.0
"""Factor by which the error of a2 is below that of the balance of a state, at least (docs/states.md §2)."""

UNKNOWN = 1.0
"""Error of a T, K or a2 that is not known; that of an a3 is NaN."""


@dataclass(frozen=True)
class Found:
    """A state on one grid: relative errors of K and of T, and errors of a2 and a3."""

    ds: xr.Dataset
    temperature: float
    a2: float
    a3: float

    def off(self, asked: Accuracy) -> float:
        """The larger error over the one asked for."""
        return max(self.temperature / asked.temperature, self.a2 / asked.a2)


def measured(states: Sequence[xr.Dataset]) -> Found:
    """The last of the states that were found on the grids so far, with its errors."""
    last = states[-1]
    if any(int(ds["status"]) != Status.OK for ds in states[-2:]) or len(states) < 2:
        return Found(last, UNKNOWN, UNKNOWN, np.nan)

    def error(name: str, relative: bool = False) -> float:
        values = [float(ds[name]) for ds in states]
        unit = abs(values[-1]) if relative else 1.0
        return error_by_changes([abs(b - a) / unit for a, b in pairwise(values)])

    a2 = error("a2") + moment_round_off(last, 2)
    if len(states) < FEWEST:
        a2 = max(a2, float(last["a2_error_estimate"]) / BALANCED)
    temperature = max(error("cooling_coefficient", True), error("temperature", True))
    a3 = error("a3")
    if not np.isfinite(a3):  # nobody asked for it, so that the grid does not grow until it is known
        values = [float(ds["a3"]) for ds in states[-4:]]
        a3 = SAFETY**2 * max(abs(b - a) for a, b in pairwise(values))
    a3 += moment_round_off(last, 3)
    return Found(last, min(temperature, UNKNOWN), min(a2, UNKNOWN), a3)


def moment_round_off(ds: xr.Dataset, n: int) -> float:
    """Round-off of ⟨|c|^{2n}⟩, over its value for a Gaussian: far out, powers of c make it large.

    Every node counts with `EPSILON` of the largest density.
    """
    dim, theta = ds.sizes["component"], float(ds["velocity_scale"])
    T = float(ds["temperature"]) / theta**2
    gaussian = float(ds["density"]) * np.prod([(dim + 2 * k) * T for k in range(n)])
    sum_over_nodes = float((ds["c_weight"] * ds["c"] ** (2 * n)).sum())
    return EPSILON * float(ds["g"].max()) * sum_over_nodes / float(gaussian)


def round_off_beyond(ds: xr.Dataset, R: float) -> float:
    """Round-off of a2 on the next grid of the ladder after that with R; it grows as R^{d+4}."""
    larger = [radius for _, radius in LADDER if radius > R]
    growth = (larger[0] / R) ** (ds.sizes["component"] + 4) if larger else 1.0
    return growth * moment_round_off(ds, 2)


def error_by_changes(changes: Sequence[float]) -> float:
    """Error of the last of some values, by the changes from each to the next.

    Changes are taken to go on as a geometric series. Its ratio is the last one, or the mean of the last two
    where that is larger; a change that is smaller than a later one counts as that one. The sum of the changes
    to come, times `SAFETY`, is the error; inf where they do not fall. From a single ratio the sum is not
    taken to be less than the last change.
    """
    *before, last = np.maximum.accumulate(np.asarray(changes)[::-1])[::-1][-3:].tolist()
    if max([*before[-1:], last]) <= ROUND_OFF:
        return SAFETY * ROUND_OFF
    if not before:
        return SAFETY * last
    if len(before) == 1:
        ratio = max(last / before[0], FASTEST)
        return SAFETY * last * max(1.0, ratio / (1.0 - ratio)) if ratio < 1.0 else np.inf
    first, second = before
    last = max(last, EXPECTED * second**2 / first)
    ratio = max(last / second, float(np.sqrt(last / first)), FASTEST)
    return max(SAFETY * last * ratio / (1.0 - ratio), ROUND_OFF) if ratio < 1.0 else np.inf
