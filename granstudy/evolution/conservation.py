"""Conservation by the least change of Q (docs/method.md §9)."""

from collections.abc import Callable, Sequence

import numpy as np

from granstudy.evolution.unknowns import Representation
from granstudy.velocity.space import VelocitySpace

Projection = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""(state, Q of that state) ↦ Q*."""


def projection(
    form: Representation,
    conserve: Sequence[str],
    energy_rate: Callable[[np.ndarray], float] = lambda f: 0.0,
) -> Projection:
    """The least change of Q that gives ∫φ_i Q* dv its exact value for the φ_i asked for.

    That is 0 for mass and momentum, and for energy ``energy_rate`` of f: what collisions of all its pairs
    change (`granstudy.trust.pair_rates`), 0 at e = 1.

    After I. Gamba & S. Tharkabhushanam, J. Comput. Phys. 228, 2012 (2009), but with the change measured over
    the Maxwellian M of the gas's own ρ, u, T. Of all Q* the one with the least ∫(Q* − Q)²/M dv is, with
    Lagrange multipliers λ_j and integrals by the grid's own weights,

        Q* = Q − M Σ_j λ_j φ_j,   Σ_j (∫φ_i M φ_j dv) λ_j = ∫φ_i Q dv − E'_i,   E' the exact value.

    Without M the change would fill the whole box and spoil the higher moments (docs/method.md §9). On a
    radial grid momentum is 0 by construction and asks for nothing.
    """
    if not conserve:
        return lambda state, Q: Q
    grid = form.grid
    invariants = grid.invariants()
    phi = np.concatenate([invariants[name] for name in conserve])
    rows = phi.reshape(len(phi), -1)
    weighted = (phi * grid.measure).reshape(len(phi), -1)

    def least_change(state: np.ndarray, Q: np.ndarray) -> np.ndarray:
        f = form.density(state)
        excess = weighted @ form.density(Q).ravel()
        if "energy" in conserve:
            excess[-1] -= energy_rate(f)
        changes = rows * _maxwellian(grid, f).ravel()
        multipliers = np.linalg.solve(changes @ weighted.T, excess)
        return Q - form.state((multipliers @ changes).reshape(grid.shape))

    return least_change


def _maxwellian(grid: VelocitySpace, f: np.ndarray) -> np.ndarray:
    """e^{−|v−u|²/2T} with the u and T of a density."""
    m = grid.velocity_moments(f)
    u = m.momentum / m.density
    T = np.trace(m.pressure) / (grid.dim * m.density)
    c2 = sum((vi - ui) ** 2 for vi, ui in zip(grid.velocities(), u, strict=True))
    return np.exp(-np.asarray(c2) / (2 * T))
