"""The examination of a run as it goes on: its state of health, and what T and a2 may be off by."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from granstudy.model.scene import Scene
from granstudy.trust import health
from granstudy.trust.pair_rates import CollisionRates, RatesAt
from granstudy.velocity.space import VelocitySpace

BALANCES = 20
"""Balances in a run, about: each takes an evaluation of Q, and transforms of twice the box."""

FASTEST = 0.5
SLOWEST = {2: 1 / 64, 3: 1 / 24}
"""Parts of the collision frequency that the shape relaxes at, at the most and at the least: a2 of Maxwell
molecules at e = 0 (docs/theory.md)."""


class Imbalance(NamedTuple):
    """Of one density: relative rates a unit of the collisions' time.

    Attributes
    ----------
    temperature : float
        T'/T by Q, less that by all pairs.
    a2 : float
        a2'/(1 + a2) by Q, less that by all pairs.
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
    """How far moments of Q(f,f) are from those of all pairs (docs/method.md §10)."""
    grid = rates.grid
    exact = rates(f)
    m = grid.velocity_moments(f)
    u = m.momentum / m.density
    V = sum(np.square(v - ui) for v, ui in zip(grid.velocities(), u, strict=True))
    energy, fourth = (np.sum(phi * f * grid.measure) for phi in (V / 2, V**2))
    mass_Q, energy_Q, fourth_Q = (np.sum(phi * Q * grid.measure) for phi in (1.0, V / 2, V**2))
    # T goes as ∫|v|²f / ρ, and 1 + a2 as ρ ∫|v|⁴f / (∫|v|²f)²
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
    """The health of one run.

    Parameters
    ----------
    scene : Scene
    grid : VelocitySpace
    outputs : int
        How many the run will have.
    rates : RatesAt
        Of the scene's collisions on the grid.

    Attributes
    ----------
    outputs : list of dict
        `granstudy.trust.health.state_of_health` of every output, with the estimated errors of T and a2.
    """

    def __init__(self, scene: Scene, grid: VelocitySpace, outputs: int, rates: RatesAt) -> None:
        self._scene, self._grid, self._rates = scene, grid, rates
        self._every = max(1, (outputs - 1) // BALANCES)
        self._last = outputs - 1
        self._first: dict[str, Any] = {}
        self._clock = 0.0
        self._balanced_at = 0.0
        self._imbalance: Imbalance | None = None
        self._temperature = self._a2 = self._mass = 0.0
        self.outputs: list[dict[str, float]] = []

    def look(
        self,
        f: np.ndarray,
        values: dict[str, Any],
        clock: float,
        Q: Callable[[], np.ndarray],
        *,
        restitution: Any,
        heating: float,
        steps_of_order_3: bool,
    ) -> dict[str, str]:
        """Examine an output; returns what there is to say, by name.

        Parameters
        ----------
        f, values : ndarray and dict
            The density as the grid holds it and its moments.
        clock : float
            The collisions' time: t, in a rescaled frame τ.
        Q : callable
            Q(f,f), a unit of that time.
        restitution : float or callable
            Of the particles as the grid holds them.
        heating : float
            2ε/T, a unit of that time: what is there is forgotten at that rate.
        steps_of_order_3 : bool
            Whether the way from the output before was one step of a size that nothing controls.
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
            # one step h at a rate r is off by (rh)⁴/24
            self._temperature += (now.cooling * step) ** 4 / 24.0
            self._a2 += (FASTEST * now.frequency * step) ** 4 / 24.0
        output = health.state_of_health(f, values, self._first, self._grid)
        output |= {"temperature": self._temperature, "a2": self._a2}
        self.outputs.append(output)
        return health.warnings(output)

    def _sample(self, values: dict[str, Any]) -> None:
        """Begin with what the grid makes of the moments that the initial density states, where it does."""
        stated = self._scene.moments
        if stated is not None:
            self._temperature = abs(float(values["temperature"]) / stated.temperature - 1.0)
            self._a2 = abs(float(values["a2"]) - stated.a2)
            self._mass = abs(float(values["density"]) / stated.density - 1.0)

    def _balance(self, f: np.ndarray, Q: np.ndarray, restitution: Any, heating: float) -> None:
        """Add what T and a2 went astray since the balance before, by the trapezoidal rule.

        An error of T decays relative to T, as T' goes as −T^{1+λ/2} + 2ε; one of the shape relaxes. A mass
        other than the scene's makes everything so much faster or slower.
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
        """Rates at which T and a2 go astray."""
        return (
            abs(rates.temperature) + self._mass * abs(rates.cooling),
            abs(rates.a2) + self._mass * abs(rates.shaping),
        )
