"""Q for a restitution e(θ|g·ω|) whose scale θ changes with time (docs/method.md §5)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from granstudy.collision.operator import collision_operator
from granstudy.evolution.frames.rescaled import ScaledCollisions
from granstudy.evolution.unknowns import collisions
from granstudy.model.restitution import ScaledRestitution, check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver

Collisions = Callable[[np.ndarray], np.ndarray]

SPACING = 0.25
"""Distance in log θ of the scales that operators are made for."""

POINTS = 4
"""Operators that Q is interpolated from, by a polynomial of degree 3: an error of SPACING⁴."""

KEPT = 6
"""Operators kept: making one takes seconds, and so do the arrays of many take memory."""


def scaled_collisions(scene: Scene, solver: Solver, Q: Collisions) -> ScaledCollisions:
    """(g, θ) ↦ Q from Q at θ = 1, which is Q at every θ where e is a constant.

    Raises
    ------
    ValueError
        If the restitution leaves [0, 1] at speeds that the first interpolation needs.
    """
    if callable(scene.restitution):
        return InterpolatedCollisions(scene, solver, Q)
    return lambda g, scale: Q(g)


class InterpolatedCollisions:
    """(g, θ) ↦ Q, interpolated in log θ between operators at θ = e^{j·SPACING}, made when needed."""

    def __init__(self, scene: Scene, solver: Solver, Q: Collisions) -> None:
        check_restitution(scene.restitution, solver.R * np.exp(SPACING))
        self._scene = scene
        self._solver = solver
        self._made = {0: Q}

    def __call__(self, g: np.ndarray, scale: float) -> np.ndarray:
        """Q(g,g) of particles whose restitution is e(θ|g·ω|), θ the ``scale``."""
        x = np.log(scale) / SPACING
        places = int(np.floor(x)) - (POINTS // 2 - 1) + np.arange(POINTS)
        weights = lagrange_weights(places, x)
        used = [(int(j), w) for j, w in zip(places, weights, strict=True) if w != 0.0]
        return np.asarray(sum(w * self._at(j)(g) for j, w in used))

    def _at(self, place: int) -> Collisions:
        if place not in self._made:
            if len(self._made) == KEPT:
                del self._made[max(self._made, key=lambda other: abs(other - place))]
            law = self._scene.restitution
            assert callable(law)
            scaled = ScaledRestitution(law, float(np.exp(place * SPACING)))
            operator = collision_operator(replace(self._scene, restitution=scaled), self._solver)
            self._made[place] = collisions(operator)
        return self._made[place]


def lagrange_weights(places: np.ndarray, x: float) -> np.ndarray:
    """Weights at distinct ``places`` of the interpolating polynomial's value at x."""
    differences = np.subtract.outer(places, places) + np.eye(len(places))
    above = np.where(np.eye(len(places), dtype=bool), 1.0, x - places)
    return np.asarray(np.prod(above / differences, axis=1))
