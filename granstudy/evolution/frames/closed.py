"""Frames that give T and a2 their exact rates, where the moments of a gas are closed (docs/method.md §10).

T and a2 of an isotropic gas of Maxwell molecules with constant e obey equations of their own: no other moment
of f enters. A grid cuts off tails, and so spoils a2 of a gas whose tail is nearly a power law. Here the shape
is changed so that ρ, T and a2 have their exact rates all the same.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from granstudy import theory
from granstudy.evolution.frames.fixed import FixedFrame
from granstudy.evolution.frames.rescaled import RescaledFrame
from granstudy.model.scene import Scene
from granstudy.trust.changes import Change, change_of_moments
from granstudy.velocity.space import VelocitySpace

ExactRates = Callable[[np.ndarray, float], Change]
"""f, 2ε/T ↦ the exact rates of T and a2. The collisions' time of Maxwell molecules is the frame's own."""

STEEPEST = 60.0
"""Power of a tail from which on it is as good as a Maxwellian's."""


def is_closed(scene: Scene) -> bool:
    """Whether T and a2 of an isotropic density obey equations of their own."""
    return scene.kernel.exponent == 0.0 and not callable(scene.restitution)


class Closure(NamedTuple):
    """What gives ρ, T and a2 their exact rates.

    Attributes
    ----------
    exact : callable
        f, 2ε/T ↦ the exact rates of T and a2.
    s : float
        The power with which the weight of the changes falls (`distinct_changes`).
    """

    exact: ExactRates
    s: float

    def correction(
        self, frame: FixedFrame | RescaledFrame, state: np.ndarray, rate: np.ndarray
    ) -> np.ndarray:
        """What is added to the rate of the density of a state whose rate is ``rate``."""
        f, grid = frame.density(state), frame.form.grid
        m = grid.velocity_moments(f)
        T = float(np.trace(m.pressure)) / (grid.dim * m.density)
        changes = distinct_changes(grid, T, self.s)
        masses = changes @ grid.measure
        by_each = np.array([change_of_moments(grid, f, change) for change in changes]).T
        mass = float(np.sum(grid.measure * frame.density(rate)))
        exact = self.exact(f, frame.heating(state, T))
        missing = np.subtract(exact, frame.moment_change(state, rate))
        amounts = np.linalg.solve(np.vstack([masses, by_each]), [-mass, *missing])
        return frame.form.state(amounts @ changes)


def tail(scene: Scene) -> float:
    """The power with which the density of Maxwell molecules that cool comes to fall; at most `STEEPEST`."""
    e = scene.restitution
    assert not callable(e)
    if e == 1.0:
        return STEEPEST
    return min(scene.dim + theory.maxwell_tail_exponent(float(e), scene.dim), STEEPEST)


class ClosedFixedFrame(FixedFrame):
    """`FixedFrame` with the exact rates of ρ, T and a2; the further argument is ``exact``."""

    def __init__(self, *equation: Any, exact: ExactRates) -> None:
        super().__init__(*equation)
        self._closure = Closure(exact, tail(self._scene))

    def rate(self, state: np.ndarray, taken_off: float = 0.0) -> np.ndarray:
        """The rate of change of `FixedFrame`, with the exact ones of ρ, T and a2."""
        rate = super().rate(state, taken_off)
        whole = super().rate(state) if taken_off else rate
        return rate + self._closure.correction(self, state, whole)


class ClosedRescaledFrame(RescaledFrame):
    """`RescaledFrame` with the exact rates of ρ, T and a2; the further argument is ``exact``."""

    def __init__(self, *equation: Any, exact: ExactRates) -> None:
        super().__init__(*equation)
        self._closure = Closure(exact, tail(self._scene))

    def rate(self, state: np.ndarray, taken_off: float = 0.0) -> np.ndarray:
        """The rate of change of `RescaledFrame`, with the exact ones of ρ, T and a2."""
        rate = super().rate(state, taken_off)
        whole = super().rate(state) if taken_off else rate
        changed = rate.copy()
        changed[: self._nodes] += self._closure.correction(self, state, whole).ravel()
        return changed


def distinct_changes(grid: VelocitySpace, T: float, s: float) -> np.ndarray:
    """Three changes of a density over speeds, which change ρ, T and a2 apart from each other; shape (3, N).

    They are w p(c²), with the weight w = (1 + c²/sT)^{−s/2}, which falls as the tail will, and is the
    Maxwellian for large s. The polynomials up to second degree in c² are orthogonal to all lower ones in this
    weight: of all changes with their moments these have the least ∫(δf)²/w.
    """
    c2 = np.square(grid.velocities()[0])
    w = (1.0 + c2 / (s * T)) ** (-s / 2)
    powers = [np.ones_like(c2)]
    for degree in (1, 2):
        lower = np.array(powers) * (grid.measure * w)
        onto = np.linalg.solve(lower @ np.array(powers).T, lower @ c2**degree)
        powers.append(c2**degree - onto @ np.array(powers))
    return np.asarray(w * np.array(powers))
