"""Conservation by the least change of Q (docs/method.md §9)."""

from collections.abc import Callable, Sequence

import numpy as np

from granstudy.evolution.unknowns import Representation
from granstudy.velocity.space import VelocitySpace


class Projection:
    """The least change of Q after which the chosen invariants are balanced exactly.

    Let φ_i be the chosen invariants, E'_i the exact values of ∫φ_i Q dv, and M the Maxwellian with the ρ, u
    and T of the gas. Among all Q* with these integrals, the one with the least ∫(Q* − Q)²/M dv is

        Q* = Q − M Σ_j λ_j φ_j,   Σ_j (∫φ_i M φ_j dv) λ_j = ∫φ_i Q dv − E'_i,

    with Lagrange multipliers λ_j and integrals by the grid's own weights. The method is that of I. Gamba &
    S. Tharkabhushanam, J. Comput. Phys. 228, 2012 (2009), whose measure has no M. Without M the change would
    fill the whole box and spoil the higher moments. On a radial grid momentum is 0 by construction, and asks
    for nothing.

    Parameters
    ----------
    form : Representation
        Kind of the states.
    conserve : sequence of str
        Names of invariants, in the order of `granstudy.velocity.space.INVARIANTS`. None: Q is left as it is.
    energy_rate : callable
        f ↦ E' of the energy: the rate by all pairs of f (`granstudy.trust.pair_rates`), 0 at e = 1. E' of
        mass and of momentum is 0.

    Attributes
    ----------
    energy_removed : float
        ∫|v|²/2 (Q − Q*) dv of the last Q; 0 where energy is not conserved.
    """

    def __init__(
        self,
        form: Representation,
        conserve: Sequence[str],
        energy_rate: Callable[[np.ndarray], float] = lambda f: 0.0,
    ) -> None:
        self._form, self._conserve, self._energy_rate = form, tuple(conserve), energy_rate
        self.energy_removed = 0.0
        if conserve:
            grid = form.grid
            invariants = grid.invariants()
            phi = np.concatenate([invariants[name] for name in conserve])
            self._rows = phi.reshape(len(phi), -1)
            self._weighted = (phi * grid.measure).reshape(len(phi), -1)

    def __call__(self, state: np.ndarray, Q: np.ndarray) -> np.ndarray:
        """Q* of a state, from its Q."""
        if not self._conserve:
            return Q
        form, grid = self._form, self._form.grid
        f = form.density(state)
        excess = self._weighted @ form.density(Q).ravel()
        if "energy" in self._conserve:
            excess[-1] -= self._energy_rate(f)
            self.energy_removed = float(excess[-1])
        changes = self._rows * _maxwellian(grid, f).ravel()
        multipliers = np.linalg.solve(changes @ self._weighted.T, excess)
        return Q - form.state((multipliers @ changes).reshape(grid.shape))


def _maxwellian(grid: VelocitySpace, f: np.ndarray) -> np.ndarray:
    """e^{−|v−u|²/2T} with u and T of the density f."""
    m = grid.velocity_moments(f)
    u = m.momentum / m.density
    T = np.trace(m.pressure) / (grid.dim * m.density)
    c2 = sum((vi - ui) ** 2 for vi, ui in zip(grid.velocities(), u, strict=True))
    return np.exp(-np.asarray(c2) / (2 * T))
