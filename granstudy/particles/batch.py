"""One batch of particles: its collisions, its heating, its moments (docs/particles.md §1, §3)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from granstudy.model.scene import Scene
from granstudy.particles.collisions import collide, count_in_cells, means
from granstudy.particles.restitution_table import alpha_table
from granstudy.velocity.sphere import sphere_area

HEATING_SPLIT = 2.5e-3
"""Largest (2εh/T)·(νh) of a heating step h, ν the collision rate: errors of steady T stay below 1e-4."""

COLLISIONS_A_STEP = 2.0
"""Largest νh of a heating step: between two kicks, a gas must not cool much."""


class HardImpactError(ValueError):
    """An impact faster than the speeds up to which the restitution was checked."""


@dataclass(frozen=True)
class Gas:
    """What all batches share: dimension, ρ, u, and how particles collide and are heated.

    Attributes
    ----------
    dim : int
    density : float
        ρ.
    velocity : ndarray, shape (3,)
        Bulk velocity u; particles are described by c = v − u.
    rate : float
        ρ|S|C_λ: collision rate of a particle where |g|^λ = 1.
    exponent : float
        λ.
    diffusion : float
        ε.
    alphas : ndarray
        Table of α (`granstudy.particles.restitution_table.alpha_table`).
    largest_impact : float
        Largest impact speed of the table.
    """

    dim: int
    density: float
    velocity: np.ndarray
    rate: float
    exponent: float
    diffusion: float
    alphas: np.ndarray
    largest_impact: float

    @classmethod
    def of(cls, scene: Scene, R: float, density: float, velocity: np.ndarray) -> "Gas":
        """The gas of a scene, with the density and bulk velocity given; R sets the table of restitution."""
        alphas, largest_impact = alpha_table(scene.restitution, R)
        return cls(
            dim=scene.dim,
            density=density,
            velocity=np.append(velocity, np.zeros(3 - scene.dim)),
            rate=density * sphere_area(scene.dim) * scene.kernel.strength,
            exponent=scene.kernel.exponent,
            diffusion=float(scene.diffusion),
            alphas=alphas,
            largest_impact=largest_impact,
        )

    def heating_step(self, temperature: float) -> float:
        """Time between kicks, by `HEATING_SPLIT` and `COLLISIONS_A_STEP` with ν = ρ|S|C_λ (2√T)^λ."""
        nu = self.rate * (2.0 * np.sqrt(temperature)) ** self.exponent
        split = np.sqrt(HEATING_SPLIT * temperature / (2.0 * self.diffusion * nu))
        return float(min(split, COLLISIONS_A_STEP / nu))


class Averages(NamedTuple):
    """Averages over the particles of a batch.

    Attributes
    ----------
    density : float
        ρ of the gas.
    velocity : ndarray, shape (d,)
        u.
    second : ndarray, shape (d, d)
        ⟨cc⟩, c the velocity about u.
    fourth : float
        ⟨|c|⁴⟩.
    """

    density: float
    velocity: np.ndarray
    second: np.ndarray
    fourth: float

    @property
    def dim(self) -> int:
        """Velocity dimension d."""
        return len(self.velocity)

    @property
    def temperature(self) -> Any:
        """T = tr⟨cc⟩/d."""
        return np.trace(self.second) / self.dim

    @property
    def energy(self) -> Any:
        """E = ½ρ(dT + |u|²)."""
        u = self.velocity
        return 0.5 * self.density * (self.dim * self.temperature + u @ u)


BATCH_MOMENTS: dict[str, Callable[[Averages], Any]] = {
    "density": lambda a: a.density,
    "velocity": lambda a: a.velocity,
    "energy": lambda a: a.energy,
    "temperature": lambda a: a.temperature,
    "paper_temperature": lambda a: 2.0 * a.energy / a.dim,
    "pressure": lambda a: a.density * a.second,
    "a2": lambda a: a.fourth / (a.dim * (a.dim + 2) * a.temperature**2) - 1.0,
}
"""The moments of `granstudy.velocity.moments.MOMENTS` by particles; a new one is a new row."""


class Batch:
    """n particles, which advance in time by random numbers of their own.

    Parameters
    ----------
    gas : Gas
    c : ndarray, shape (n, d)
        Velocities about u, with mean 0.
    rng : numpy.random.Generator

    Attributes
    ----------
    c : ndarray, shape (n, 3)
        Velocities about u now; in 2D the third component is 0. The mean stays 0 to round-off.
    collisions : int
        Collisions since the start.
    """

    def __init__(self, gas: Gas, c: np.ndarray, rng: np.random.Generator) -> None:
        self.gas, self.rng = gas, rng
        self.c = np.zeros((len(c), 3))
        self.c[:, : gas.dim] = c
        self.collisions = 0

    def moments(self) -> dict[str, Any]:
        """Moments as of `granstudy.velocity.moments`, and collisions that a particle has had, on average."""
        d = self.gas.dim
        mean, second, fourth = means(self.c)
        velocity = (self.gas.velocity + mean)[:d]
        averages = Averages(self.gas.density, velocity, second[:d, :d], fourth)
        with np.errstate(all="ignore"):  # a gas at rest has no a2
            values = {name: value(averages) for name, value in BATCH_MOMENTS.items()}
        return values | {"collisions": 2.0 * self.collisions / len(self.c)}

    def advance(self, duration: float) -> None:
        """Advance by ``duration``: collisions, in turn with heating by Strang's splitting.

        Raises
        ------
        HardImpactError
            If an impact was faster than the speeds up to which the restitution law was checked.
        """
        if self.gas.diffusion == 0.0:
            self._collide(duration)
            return
        left, unheated = duration, 0.0
        while left > 0.0:
            temperature = float(np.trace(means(self.c)[1])) / self.gas.dim
            step = min(left, self.gas.heating_step(temperature))
            # The second half of a step's heating and the first half of the next are one kick.
            self._heat(unheated + step / 2)
            self._collide(step)
            left, unheated = left - step, step / 2
        self._heat(unheated)

    def _collide(self, duration: float) -> None:
        """Let particles collide for ``duration``."""
        gas = self.gas
        collisions, hardest = collide(
            self.c, gas.dim, self.rng, duration, gas.rate, gas.exponent, gas.alphas,
            gas.largest_impact,
        )  # fmt: skip
        self.collisions += collisions
        if hardest > gas.largest_impact:
            raise HardImpactError(
                f"an impact at speed {hardest:.3g} is beyond 4R = {gas.largest_impact:.3g}, up to "
                "which the restitution was checked: take a larger R"
            )

    def _heat(self, duration: float) -> None:
        """Kick all particles: variance 2ε·duration in each component, and mean 0, so that u stays.

        The factor n/(n−1) restores the variance that goes with the mean.
        """
        n, d = len(self.c), self.gas.dim
        kicks = self.rng.standard_normal((n, d))
        kicks -= kicks.mean(axis=0)
        self.c[:, :d] += np.sqrt(2.0 * self.gas.diffusion * duration * n / (n - 1)) * kicks

    def cell_counts(self, N: int, L: float) -> np.ndarray:
        """Number of particles in each cell of the box [−L, L]^d, shape (N,)*d."""
        counts = np.zeros((N, N, N if self.gas.dim == 3 else 1), dtype=np.int64)
        count_in_cells(self.c, self.gas.velocity, L, counts)
        return counts if self.gas.dim == 3 else counts[:, :, 0]


def history(batch: Batch, times: np.ndarray, start: float = 0.0) -> Iterator[dict[str, Any]]:
    """Moments of a batch, whose time is ``start``, at increasing ``times``, one after the other."""
    now = start
    for time in times:
        if time > now:
            batch.advance(time - now)
            now = time
        yield batch.moments()
