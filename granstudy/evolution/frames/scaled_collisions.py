"""Q in a rescaled frame, where a restitution law becomes e(θ|g·ω|) (docs/method.md §5)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from granstudy.collision.operator import collision_operator
from granstudy.evolution.frames.rescaled import ScaledCollisions
from granstudy.evolution.unknowns import collisions
from granstudy.model.restitution import ScaledRestitution, check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.support.errors import LawRangeError, NotFiniteError

Collisions = Callable[[np.ndarray], np.ndarray]
"""g ↦ Q(g,g)."""

SPACING = 0.25
"""Distance in log θ between scales that have an operator."""

POINTS = 4
"""Operators that one interpolation uses: a polynomial of degree 3, an error O(SPACING⁴)."""

KEPT = 6
"""Operators kept: to make one takes seconds, to keep many takes memory."""


def scaled_collisions(scene: Scene, solver: SizedSolver, Q: Collisions) -> ScaledCollisions:
    """(g, θ) ↦ Q(g,g) of particles with restitution e(θ|g·ω|).

    Parameters
    ----------
    scene, solver : Scene, SizedSolver
    Q : callable
        g ↦ Q(g,g) at θ = 1. At constant e that is Q at every θ.

    Raises
    ------
    ValueError
        If a restitution law leaves [0, 1] at speeds that the first interpolation needs.
    """
    if callable(scene.restitution):
        return InterpolatedCollisions(scene, solver, Q)
    return lambda g, scale: Q(g)


class InterpolatedCollisions:
    """(g, θ) ↦ Q, interpolated in log θ between operators at θ = e^{j·SPACING}, made when needed."""

    def __init__(self, scene: Scene, solver: SizedSolver, Q: Collisions) -> None:
        check_restitution(scene.restitution, solver.R * np.exp(SPACING))
        self._scene = scene
        self._solver = solver
        self._made = {0: Q}

    def __call__(self, g: np.ndarray, scale: float) -> np.ndarray:
        """Q(g,g) of particles with restitution e(θ|g·ω|); ``scale`` is θ."""
        if not (np.isfinite(scale) and scale > 0.0):
            raise NotFiniteError(f"scale={scale!r}: must be positive and finite")
        x = np.log(scale) / SPACING
        places = int(np.floor(x)) - (POINTS // 2 - 1) + np.arange(POINTS)
        weights = lagrange_weights(places, x)
        used = [(int(j), w) for j, w in zip(places, weights, strict=True) if w != 0.0]
        return np.asarray(sum(w * self._at(j)(g) for j, w in used))

    def _at(self, place: int) -> Collisions:
        """Q at θ = e^{place·SPACING}; the operator farthest from it gives way where too many are kept."""
        if place not in self._made:
            if len(self._made) == KEPT:
                del self._made[max(self._made, key=lambda other: abs(other - place))]
            law = self._scene.restitution
            assert callable(law)
            scaled = ScaledRestitution(law, float(np.exp(place * SPACING)))
            try:
                check_restitution(scaled, self._solver.R)
            except ValueError as error:
                raise LawRangeError(
                    f"{error}; the gas moves at speeds that its law is not for"
                ) from None
            operator = collision_operator(replace(self._scene, restitution=scaled), self._solver)
            self._made[place] = collisions(operator)
        return self._made[place]


def lagrange_weights(places: np.ndarray, x: float) -> np.ndarray:
    """Weights of the values at distinct ``places`` in the interpolating polynomial at x."""
    differences = np.subtract.outer(places, places) + np.eye(len(places))
    above = np.where(np.eye(len(places), dtype=bool), 1.0, x - places)
    return np.asarray(np.prod(above / differences, axis=1))
