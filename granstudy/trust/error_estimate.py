"""The errors of T and a2, estimated while a run goes on (docs/method.md §10)."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from granstudy.model.restitution import Restitution
from granstudy.model.scene import Scene
from granstudy.trust import health
from granstudy.trust.pair_rates import CollisionRates, RatesAt
from granstudy.velocity.space import VelocitySpace

BALANCES = 20
"""Balances in a run, about; each takes an evaluation of Q, and transforms on twice the box."""

FASTEST = 0.5
"""Fastest relaxation of the shape, in parts of the collision frequency."""

SLOWEST = {2: 1 / 64, 3: 1 / 24}
"""Slowest relaxation of the shape, in parts of the collision frequency, by dimension: the rate of a2 for
Maxwell molecules at e = 0 (docs/theory.md)."""


class Imbalance(NamedTuple):
    """How far Q of one density is from the exact sums over all pairs.

    All are relative rates in a unit of the collisions' time.

    Attributes
    ----------
    temperature : float
        T'/T by Q, less T'/T by all pairs.
    a2 : float
        a2'/(1 + a2) by Q, less the same by all pairs.
    cooling : float
        T'/T by all pairs.
    frequency : float
        Collisions of a particle.
    shaping : float
        a2'/(1 + a2) by all pairs.
    """

    temperature: float
    a2: float
    cooling: float
    frequency: float
    shaping: float


def imbalance(rates: CollisionRates, f: np.ndarray, Q: np.ndarray) -> Imbalance:
    """Moments of Q(f,f) against the exact sums over all pairs of f (docs/method.md §10).

    Parameters
    ----------
    rates : CollisionRates
        The sums, on the grid of f.
    f, Q : ndarray, shape rates.grid.shape
        The density, and Q(f,f) at the same nodes.
    """
    grid = rates.grid
    exact = rates(f)
    m = grid.velocity_moments(f)
    u = m.momentum / m.density
    V = sum(np.square(v - ui) for v, ui in zip(grid.velocities(), u, strict=True))
    energy, fourth = (np.sum(phi * f * grid.measure) for phi in (V / 2, V**2))
    mass_Q, energy_Q, fourth_Q = (np.sum(phi * Q * grid.measure) for phi in (1.0, V / 2, V**2))
    # T is proportional to ∫|v|²f / ρ, and 1 + a2 to ρ ∫|v|⁴f / (∫|v|²f)²
    mass = mass_Q / m.density
    off = (energy_Q - exact.energy) / energy
    cooling = float(exact.energy / energy)
    return Imbalance(
        temperature=float(off - mass),
        a2=float((fourth_Q - exact.fourth) / fourth + mass - 2.0 * off),
        cooling=cooling,
        frequency=exact.frequency,
        shaping=float(exact.fourth / fourth - 2.0 * cooling),
    )


class Examination:
    """Examines one run, output by output: signs of health, and estimated errors of T and a2.

    Parameters
    ----------
    scene : Scene
    grid : VelocitySpace
    outputs : int
        Number of outputs that the run will have.
    rates : RatesAt
        Exact rates of the scene's collisions on the grid.

    Attributes
    ----------
    outputs : list of dict
        What was measured at every output, by the names of `granstudy.trust.health.SIGNS`.
    """

    def __init__(self, scene: Scene, grid: VelocitySpace, outputs: int, rates: RatesAt) -> None:
        self._scene, self._grid, self._rates = scene, grid, rates
        self._every = max(1, (outputs - 1) // BALANCES)
        self._last = outputs - 1
        self._first: health.Moments = {}
        self._clock = 0.0
        self._balanced_at = 0.0
        self._imbalance: Imbalance | None = None
        self._temperature = self._a2 = 0.0
        self._mass_error = 0.0
        self.outputs: list[dict[str, float]] = []

    def look(
        self,
        f: np.ndarray,
        values: health.Moments,
        clock: float,
        Q: Callable[[], np.ndarray],
        *,
        restitution: Restitution,
        heating: float,
        steps_of_order_3: bool,
    ) -> dict[str, str]:
        """Examine an output; returns its warnings, by the names of `granstudy.trust.health.SIGNS`.

        Parameters
        ----------
        f : ndarray, shape grid.shape
            The density that the grid stores: f, in a rescaled frame g.
        values : mapping
            Moments of that density.
        clock : float
            The collisions' time: t, in a rescaled frame τ.
        Q : callable
            Returns Q(f,f), in a unit of the collisions' time.
        restitution : float or callable
            Restitution in the velocities that the grid stores.
        heating : float
            2ε/T in a unit of the collisions' time: the rate at which heating makes errors of T decay.
        steps_of_order_3 : bool
            Whether one step of a fixed size led here from the output before.
        """
        number = len(self.outputs)
        if number == 0:
            self._first = values
            self._sample(values)
        step, self._clock = clock - self._clock, clock
        if number % self._every == 0 or number == self._last:
            self._balance(f, Q(), restitution, heating)
        now = self._imbalance
        assert now is not None
        if steps_of_order_3 and number > 0:
            # the error of one step h at a rate r is (rh)⁴/24
            self._temperature += (now.cooling * step) ** 4 / 24.0
            self._a2 += (FASTEST * now.frequency * step) ** 4 / 24.0
        output = health.state_of_health(f, values, self._first, self._grid)
        output |= {"temperature": self._temperature, "a2": self._a2}
        self.outputs.append(output)
        return health.warnings(output)

    def _sample(self, values: health.Moments) -> None:
        """Start from the errors that the grid makes in the stated moments of the initial density."""
        stated = self._scene.moments
        if stated is not None:
            self._temperature = abs(float(values["temperature"]) / stated.temperature - 1.0)
            self._a2 = abs(float(values["a2"]) - stated.a2)
            self._mass_error = abs(float(values["density"]) / stated.density - 1.0)

    def _balance(
        self, f: np.ndarray, Q: np.ndarray, restitution: Restitution, heating: float
    ) -> None:
        """Add the errors of T and a2 since the balance before, by the trapezoidal rule.

        Older errors decay. The error of T, relative to T, does as T' = −const T^{1+λ/2} + 2ε says; an error
        of the shape relaxes.
        """
        before, self._imbalance = self._imbalance, imbalance(self._rates(restitution), f, Q)
        before = before or self._imbalance
        elapsed, self._balanced_at = self._clock - self._balanced_at, self._clock
        now = self._imbalance
        forgetting = heating - self._scene.kernel.exponent / 2 * now.cooling
        self._temperature *= np.exp(-elapsed * forgetting)
        self._temperature += elapsed * (self._off(before)[0] + self._off(now)[0]) / 2
        relaxing = 2 * heating + SLOWEST[self._grid.dim] * now.frequency
        self._a2 *= np.exp(-elapsed * relaxing)
        self._a2 += elapsed * (self._off(before)[1] + self._off(now)[1]) / 2

    def _off(self, rates: Imbalance) -> tuple[float, float]:
        """Rates at which the errors of T and a2 grow.

        A mass other than the scene's makes all collisions faster or slower by the same factor.
        """
        return (
            abs(rates.temperature) + self._mass_error * abs(rates.cooling),
            abs(rates.a2) + self._mass_error * abs(rates.shaping),
        )
