"""The equation of steady and of self-similar states (docs/states.md §1)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.velocity.moments import moment_values
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.space import VelocitySpace

Linear = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class SteadyEquation:
    """Q(g,g) + s D g + m g = 0 at a density ρ and a temperature T; unknown are g, s and m.

    D g is what balances collisions: ∇c·(c g) in the cooling state, s = θ'/θ there, or Δg in the heated one,
    s = ε. The rate s is that at which the energy of the terms cancels, so that g has the temperature asked
    for: without it g of any temperature would do, after a change of the unit of velocity. Likewise m is the
    rate at which mass leaves the grid, put back in the shape of g: 0 but for what g has at the border.

    The derivative has no null direction: one of g for each of ρ and T, and each is held. It is exact, as
    Q is a quadratic form: Q(g,h) + Q(h,g) = ½[Q(g+h, g+h) − Q(g−h, g−h)].

    Attributes
    ----------
    grid : VelocitySpace
        Densities live on it.
    collisions, balance : callable
        g ↦ Q(g,g) and g ↦ D g.
    symmetrise : callable
        Takes off what round-off did to the symmetry of a density.
    density, temperature : float
        ρ and T about c = 0.
    """

    grid: VelocitySpace
    collisions: Linear
    balance: Linear
    symmetrise: Linear
    density: float
    temperature: float

    def start(self, g: np.ndarray) -> np.ndarray:
        """The unknowns at a density: its s is that of balanced energy, its m is 0."""
        _, Q_energy = self._held(self.collisions(g))
        _, D_energy = self._held(self.balance(g))
        return self._join(g, [-Q_energy / D_energy, 0.0])

    def residual(self, x: np.ndarray) -> np.ndarray:
        """The left-hand side at every node, then M_0(g)/ρ − 1 and M_E(g)/(½dρT) − 1.

        What x has without the symmetry is no part of g; it is added, so that it comes out as 0.
        """
        g, s, m = self.split(x)
        left = self.collisions(g) + s * self.balance(g) + m * g + self._asymmetric(x)
        return self._join(left, self._held(g) - 1.0)

    def derivative(self, x: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """The residual's derivative at x, exact."""
        g, s, m = self.split(x)
        Dg = self.balance(g)

        def act(step: np.ndarray) -> np.ndarray:
            h, s_step, m_step = self.split(step)
            change = self._collisions_change(g, h) + s * self.balance(h) + m * h
            change += self._asymmetric(step)
            return self._join(change + s_step * Dg + m_step * g, self._held(h))

        return act

    def size(self, residual: np.ndarray, x: np.ndarray) -> float:
        """Largest value of the left-hand side over that of s D g."""
        g, s, _ = self.split(x)
        left, *_ = self.split(residual)
        return float(np.max(np.abs(left)) / np.max(np.abs(s * self.balance(g))))

    def split(self, x: np.ndarray) -> tuple[np.ndarray, float, float]:
        """G at the nodes, s and m."""
        return self.symmetrise(x[:-2].reshape(self.grid.shape)), float(x[-2]), float(x[-1])

    def _asymmetric(self, x: np.ndarray) -> np.ndarray:
        return x[:-2].reshape(self.grid.shape) - self.split(x)[0]

    def _collisions_change(self, g: np.ndarray, h: np.ndarray) -> np.ndarray:
        """Q(g,h) + Q(h,g); h is brought to the size of g, so that no digits are lost."""
        norm = np.linalg.norm(h)
        if norm == 0.0:
            return np.zeros_like(g)
        scale = np.linalg.norm(g) / norm
        return (self.collisions(g + scale * h) - self.collisions(g - scale * h)) / (2.0 * scale)

    def _held(self, g: np.ndarray) -> np.ndarray:
        """M_0 over ρ and M_E over ½dρT."""
        invariants = self.grid.invariants()
        phi = np.concatenate([invariants["mass"], invariants["energy"]]) * self.grid.measure
        values = phi.reshape(2, -1) @ g.ravel()
        energy = 0.5 * self.grid.dim * self.density * self.temperature
        return np.asarray(values / [self.density, energy])

    @staticmethod
    def _join(g: np.ndarray, rest: np.ndarray | list[float]) -> np.ndarray:
        return np.concatenate([g.ravel(), rest])


@dataclass(frozen=True)
class Gas:
    """What the state is asked to have, of the scene's initial density on the grid."""

    density: float
    velocity: np.ndarray
    temperature: float


def gas_of(scene: Scene, solver: Solver) -> Gas:
    """Density, bulk velocity and temperature of the scene's initial density on the solver's grid."""
    sized = solver.sized()
    grid: VelocitySpace = (
        RadialGrid(scene.dim, sized.N, sized.R) if sized.traits.radial else sized.grid(scene.dim)
    )
    values = moment_values(scene.density(grid), grid)
    return Gas(float(values["density"]), values["velocity"], float(values["temperature"]))
