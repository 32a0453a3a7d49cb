"""Conservation by the least change of Q (docs/method.md §5)."""

from collections.abc import Callable, Sequence

import numpy as np

from granstudy.kernel import Restitution
from granstudy.representation import Representation

INVARIANTS = ("mass", "momentum", "energy")


def projection(
    form: Representation, conserve: Sequence[str]
) -> Callable[[np.ndarray], np.ndarray]:
    """Q ↦ Q*, the least change that makes ∫φ_i Q* dv vanish for the collision invariants φ_i asked for.

    Of all such Q* the one with the least ∫(Q* − Q)² dv is, with Lagrange multipliers λ_j,

        Q* = Q − Σ_j λ_j φ_j,   Σ_j (∫φ_i φ_j dv) λ_j = ∫φ_i Q dv,

    integrals by the grid's own weights (I. Gamba, S. Tharkabhushanam, J. Comput. Phys. 228, 2012 (2009)).
    On a radial grid momentum is 0 by construction and asks for nothing.
    """
    if not conserve:
        return lambda Q: Q
    invariants = form.grid.invariants()
    phi = np.concatenate([invariants[name] for name in conserve])
    rows = phi.reshape(len(phi), -1)
    weighted = (phi * form.grid.measure).reshape(len(phi), -1)
    multipliers = np.linalg.solve(weighted @ rows.T, weighted)
    states = [form.state(row) for row in phi]

    def least_change(Q: np.ndarray) -> np.ndarray:
        for multiplier, invariant in zip(multipliers @ form.density(Q).ravel(), states, strict=True):
            Q = Q - multiplier * invariant
        return Q

    return least_change


def check_conserve(conserve: Sequence[str], restitution: Restitution) -> None:
    """Raise ValueError for energy where collisions do not conserve it: they do at e = 1 only."""
    if "energy" in conserve and (callable(restitution) or restitution != 1.0):
        raise ValueError(
            f"conserve={tuple(conserve)!r}: restitution={restitution!r}, and collisions conserve "
            "energy at restitution=1 only; leave 'energy' out"
        )
