"""Nodes g = ρĝ of the sum over relative velocities, one of each pair ±g."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from granstudy.collision.weights import radial_measure
from granstudy.model.scene import Scene
from granstudy.quadrature import Rule
from granstudy.velocity.cartesian import VelocityGrid


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes and weights of the sum Σ_ρ measure_ρ Σ_{±g} weights_g φ(±g), shell after shell.

    Attributes
    ----------
    vectors : ndarray, shape (n, 3)
        g in units L/π, so that phases are k·g. In 2D the second component is 0.
    weights : ndarray, shape (n,)
        Weight of g, which is also the weight of −g.
    shells : ndarray of int, shape (n,)
        Number of the shell on which g lies, not decreasing.
    radii, measure : ndarray, shape (shells,)
        ρ, and |S^{d−1}| C_λ w_ρ ρ^{d−1+λ}.
    """

    vectors: np.ndarray
    weights: np.ndarray
    shells: np.ndarray
    radii: np.ndarray
    measure: np.ndarray

    def __len__(self) -> int:
        return len(self.weights)

    @property
    def ends(self) -> np.ndarray:
        """Index after the last node of every shell that has nodes."""
        return np.flatnonzero(np.append(self.shells[1:] != self.shells[:-1], True)) + 1


def place_nodes(
    scene: Scene, grid: VelocityGrid, radial: Rule, directions: Sequence[Rule | None]
) -> Nodes:
    """Nodes on the shells of a radial rule, with one rule of directions per shell, or none.

    Each rule of directions holds one point of every pair ±ĝ, with the weight of both. Either point may
    stand for its pair; the choice changes aliasing alone. Signs that balance from point to point and from
    shell to shell cancel much of it.
    """
    axes = [0, 2] if grid.dim == 2 else [0, 1, 2]
    vectors, weights, shells = [np.zeros((0, 3))], [np.zeros(0)], [np.zeros(0, dtype=np.int64)]
    for shell, (rho, rule) in enumerate(zip(radial.points, directions, strict=True)):
        if rule is not None:
            signs = balanced_signs(rule.points) * (-1) ** shell
            g = np.zeros((len(rule), 3))
            g[:, axes] = np.pi / grid.L * rho * signs[:, None] * rule.points
            vectors.append(g)
            weights.append(rule.weights / 2)
            shells.append(np.full(len(rule), shell))
    return Nodes(
        np.concatenate(vectors),
        np.concatenate(weights),
        np.concatenate(shells),
        radial.points,
        radial_measure(scene.kernel, grid.dim, radial.points, radial.weights),
    )


def balanced_signs(points: np.ndarray) -> np.ndarray:
    """Signs ±1, chosen one after the other, that keep the sum of the points small."""
    signs = np.ones(len(points))
    total = np.zeros(points.shape[1])
    for i, point in enumerate(points):
        signs[i] = 1.0 if total @ point <= 0.0 else -1.0
        total += signs[i] * point
    return signs
