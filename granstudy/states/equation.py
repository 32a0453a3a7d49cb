"""The equation of self-similar and of steady states (docs/states.md §1)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from granstudy.collision.protocol import DifferentiableOperator
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.velocity.moments import moment_values
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.space import VelocitySpace

Map = Callable[[np.ndarray], np.ndarray]
"""A map of densities at the nodes of a grid."""


@dataclass(frozen=True)
class Gas:
    """Density ρ, bulk velocity u (shape (d,)) and temperature T that a state is asked to have."""

    density: float
    velocity: np.ndarray
    temperature: float


def gas_of(scene: Scene, solver: Solver) -> Gas:
    """ρ, u and T of the scene's initial density on the solver's grid."""
    sized = solver.sized()
    grid: VelocitySpace = (
        RadialGrid(scene.dim, sized.N, sized.R) if sized.traits.radial else sized.grid(scene.dim)
    )
    values = moment_values(scene.density(grid), grid)
    return Gas(float(values["density"]), values["velocity"], float(values["temperature"]))


@dataclass(frozen=True)
class SteadyEquation:
    """Q(g,g) + s D g + m g = 0 at a given density ρ and temperature T; g, s and m are unknown.

    The term s D g balances collisions. In the cooling state D g = ∇c·(c g) and s = θ'/θ; in the heated state
    D g = Δg and s = ε. The term m g puts back, in the shape of g, mass that leaves the grid; m = 0 where g
    is 0 at the grid's border.

    Both ρ and T must be held: the equation alone has a solution for each of them, which differ by units. With
    both held, the derivative has no null direction. The derivative is exact, as Q is a quadratic form:
    Q(g,h) + Q(h,g) = ½[Q(g+h, g+h) − Q(g−h, g−h)].

    Attributes
    ----------
    grid : VelocitySpace
        Grid that densities live on.
    collisions, balance : callable
        g ↦ Q(g,g) and g ↦ D g.
    symmetrise : callable
        g ↦ g with the symmetry restored that round-off disturbs.
    density, temperature : float
        ρ, and T about c = 0.
    """

    grid: VelocitySpace
    collisions: Map
    balance: Map
    symmetrise: Map
    density: float
    temperature: float

    def start(self, g: np.ndarray) -> np.ndarray:
        """The unknowns x = (g, s, m) at a density g: s balances its energy, and m = 0."""
        _, Q_energy = self._held(self.collisions(g))
        _, D_energy = self._held(self.balance(g))
        return self._join(g, [-Q_energy / D_energy, 0.0])

    def residual(self, x: np.ndarray) -> np.ndarray:
        """The left-hand side at every node, then M_0(g)/ρ − 1 and M_E(g)/(½dρT) − 1.

        A part of x without the symmetry does not belong to g. The residual includes it, so that a
        solution has none.
        """
        g, s, m = self.split(x)
        left = self.collisions(g) + s * self.balance(g) + m * g + self._asymmetric(x)
        return self._join(left, self._held(g) - 1.0)

    def derivative(self, x: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """The exact derivative of the residual at x: step ↦ change of the residual."""
        g, s, m = self.split(x)
        Dg = self.balance(g)
        collisions_change = self._collisions_derivative(g)

        def act(step: np.ndarray) -> np.ndarray:
            h, s_step, m_step = self.split(step)
            change = collisions_change(h) + s * self.balance(h) + m * h
            change += self._asymmetric(step)
            return self._join(change + s_step * Dg + m_step * g, self._held(h))

        return act

    def size(self, residual: np.ndarray, x: np.ndarray) -> float:
        """Largest value of the left-hand side, over the largest value of s D g."""
        g, s, _ = self.split(x)
        left, *_ = self.split(residual)
        return float(np.max(np.abs(left)) / np.max(np.abs(s * self.balance(g))))

    def split(self, x: np.ndarray) -> tuple[np.ndarray, float, float]:
        """g at the nodes, s and m."""
        return self.symmetrise(x[:-2].reshape(self.grid.shape)), float(x[-2]), float(x[-1])

    def _asymmetric(self, x: np.ndarray) -> np.ndarray:
        """The part of x at the nodes that lacks the symmetry."""
        return x[:-2].reshape(self.grid.shape) - self.split(x)[0]

    def _collisions_derivative(self, g: np.ndarray) -> Map:
        """h ↦ Q(g,h) + Q(h,g), by the operator's own matrix where it has one."""
        if isinstance(self.collisions, DifferentiableOperator):
            matrix = self.collisions.derivative(g)
            return lambda h: matrix @ h
        return partial(self._collisions_change, g)

    def _collisions_change(self, g: np.ndarray, h: np.ndarray) -> np.ndarray:
        """Q(g,h) + Q(h,g); h is scaled to the size of g, so that no digits are lost."""
        norm = np.linalg.norm(h)
        if norm == 0.0:
            return np.zeros_like(g)
        scale = np.linalg.norm(g) / norm
        return (self.collisions(g + scale * h) - self.collisions(g - scale * h)) / (2.0 * scale)

    def _held(self, g: np.ndarray) -> np.ndarray:
        """M_0/ρ and M_E/(½dρT), which the equation holds at 1."""
        invariants = self.grid.invariants()
        phi = np.concatenate([invariants["mass"], invariants["energy"]]) * self.grid.measure
        values = phi.reshape(2, -1) @ g.ravel()
        energy = 0.5 * self.grid.dim * self.density * self.temperature
        return np.asarray(values / [self.density, energy])

    @staticmethod
    def _join(g: np.ndarray, rest: np.ndarray | list[float]) -> np.ndarray:
        """One array of the nodes' values and two numbers."""
        return np.concatenate([g.ravel(), rest])
