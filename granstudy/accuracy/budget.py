"""The budget of a run: what of the asked errors each source may use, and how fast its error may grow.

An error y obeys y' = −r y + growth (`granstudy.trust.error_estimate`). With a constant growth it stays below
growth · min(1/r, time left): so a source that may use a part of the asked error may grow by that part times
max(r, 1/time left), at any moment.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from granstudy.accuracy.asked import Accuracy
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import Balance

GRID_SHARE = 0.7
"""Part of the asked errors for what the grid and its quadrature do: truncation, aliasing, angles, radii, the
motion of a rescaled frame."""

STEP_SHARE = 0.1
"""Part for the steps in time."""

MOVE_SHARE = 0.1
"""Part for each change of the grid, and for going on with the isotropic part."""

SHAPE_SHARE = 0.6
"""Part of the grid's share of T that errors of a2 may use, which change the rate of cooling; and other
errors of the shape. Both are rarely used at once."""

DIRECT_SHARE = 0.2
"""Part of the grid's share of T for errors of T itself: there are few, as Q has the exact energy."""

CLOSED_SHAPE = 1e-2
"""Errors of the shape that neither T nor a2 feel, and that are allowed all the same."""

LEAST_LEFT = 0.25
"""Least part of a share that a source may go on to use, whatever was used before."""

LOWEST = -600.0
"""Least log of a temperature over its first value: Maxwell molecules cool exponentially."""


class Allowed(NamedTuple):
    """Largest growth of errors in a unit of the collisions' time, by the fields of `Balance`."""

    temperature: float
    a2: float
    other: float
    step_temperature: float
    step_a2: float

    def ratio(self, balance: Balance) -> float:
        """The largest growth by the grid over what is allowed."""
        return max(
            balance.temperature / self.temperature,
            balance.a2 / self.a2,
            balance.other / self.other,
        )

    def step_ratio(self, rate: Change) -> float:
        """The growth by steps over what is allowed."""
        return max(rate.temperature / self.step_temperature, rate.a2 / self.step_a2)


def allowed_growth(
    asked: Accuracy, balance: Balance, spent: Change, left: float, closed: bool = False
) -> Allowed:
    """How fast errors may grow now.

    Parameters
    ----------
    asked : Accuracy
    balance : Balance
        Rates at which errors are forgotten, and at which an error of the shape makes one of T.
    spent : Change
        Errors of T and a2 by the grid so far.
    left : float
        Collisions' time left, as if the temperature stayed (`clock_left`).
    closed : bool
        Whether T and a2 have their exact rates on any grid (`granstudy.evolution.frames.closed`): the shape
        must then be good to `CLOSED_SHAPE` alone.
    """
    forgetting = max(balance.forgetting, 1.0 / left)
    relaxing = max(balance.relaxing, 1.0 / left)
    share = GRID_SHARE * asked.temperature
    # an error y of a2 makes T grow off at the rate shape·y, to shape·y/forgetting
    coupling = balance.shape / forgetting
    a2 = asked.a2 if coupling == 0.0 else min(asked.a2, SHAPE_SHARE * asked.temperature / coupling)
    temperature = _left(share, spent.temperature * np.exp(-balance.forgetting * left))
    temperature *= DIRECT_SHARE
    a2_growth = _left(GRID_SHARE * a2, spent.a2 * np.exp(-balance.relaxing * left)) * relaxing
    # Where energy is wrong, a2 is wrong as well, unless by chance.
    other = a2_growth
    if balance.cooling > 0.0:
        most = SHAPE_SHARE * share * forgetting * relaxing / balance.cooling
        other = min(other, most)
    if closed:
        other = max(other, CLOSED_SHAPE * relaxing)
    return Allowed(
        temperature=temperature * forgetting,
        a2=a2_growth,
        other=float(other),
        step_temperature=STEP_SHARE * asked.temperature * forgetting,
        step_a2=STEP_SHARE * a2 * relaxing,
    )


def _left(share: float, spent: float) -> float:
    return float(max(share - spent, LEAST_LEFT * share))


def clock_left(cooling: float, heating: float, exponent: float, time: float) -> float:
    """Collisions left, in a unit of the present collisions' time.

    With x the temperature over its present value and x' = −cooling x^{1+λ/2} + heating: ∫x^{λ/2} dt.

    Parameters
    ----------
    cooling, heating : float
        |T'/T| by collisions and 2ε/T, in the unit in which ``time`` is counted.
    time : float
        Time left.
    """
    if heating == 0.0:
        rate = exponent / 2 * cooling
        return float(np.log1p(rate * time) / rate) if rate * time > 1e-9 else time
    return _law(cooling, heating, exponent, time)[1]


def temperature_range(cooling: float, heating: float, exponent: float, time: float) -> float:
    """Largest over smallest temperature of a run, by the same law."""
    x = _law(cooling, heating, exponent, time)[0]
    return max(x, 1.0 / x)


def _law(cooling: float, heating: float, exponent: float, time: float) -> tuple[float, float]:
    """x and ∫x^{λ/2} dt at the end."""

    def rate(t: float, y: np.ndarray) -> list[float]:
        x = float(np.exp(y[0]))
        return [heating / x - cooling * x ** (exponent / 2), x ** (exponent / 2)]

    end = solve_ivp(rate, (0.0, time), [0.0, 0.0], method="LSODA", rtol=1e-4, atol=1e-6).y[:, -1]
    return float(np.exp(max(end[0], LOWEST))), float(end[1])
