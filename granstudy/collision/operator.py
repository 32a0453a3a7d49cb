"""The protocol of a collision operator, and the choice of one by the solver's method."""

from importlib import import_module
from typing import TYPE_CHECKING

from granstudy.collision.protocol import CollisionOperator
from granstudy.model.restitution import check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import Choice, Solver

if TYPE_CHECKING:
    pass

OPERATORS = {
    "literal": ("granstudy.collision.literal", "LiteralOperator"),
    "direct": ("granstudy.collision.direct", "DirectOperator"),
    "radial": ("granstudy.collision.radial.operator", "RadialOperator"),
    "carleman": ("granstudy.collision.carleman.operator", "CarlemanOperator"),
    "fast": ("granstudy.collision.fast.operator", "fast_operator"),
    "adaptive": ("granstudy.collision.fast.adaptive.operator", "AdaptiveOperator"),
    "fast on gpu": ("granstudy.collision.fast.gpu.operator", "fast_on_gpu"),
    "adaptive on gpu": ("granstudy.collision.fast.gpu.operator", "adaptive_on_gpu"),
}
"""Module and maker of the operator behind each method; imported only where a method is used, so that a
run loads, and is fingerprinted by, no other method's code."""


def concrete(scene: Scene, solver: Solver) -> Choice:
    """The solver with what it leaves open chosen for the scene; itself where it leaves nothing open.

    What chooses is imported only where something is open, so that it is no part of other runs' code.

    Raises
    ------
    ValueError
        If it asks for a GPU and there is none, or none that can model the scene.
    """
    if solver.device == "gpu":  # here, before any work
        import_module("granstudy.collision.fast.gpu.operator").check(scene)
    if not solver.is_open:
        return Choice(solver, solver, "")
    choice: Choice = import_module("granstudy.collision.choice.cheapest").choose(scene, solver)
    return choice


def collision_operator(scene: Scene, solver: Solver) -> CollisionOperator:
    """Plan the collision operator of a scene as the solver's method does it.

    What the solver leaves open, as ``method="auto"`` does, is first chosen (`granstudy.choose`); the kind of
    grid is part of that choice.

    Raises
    ------
    ValueError
        If the scene's restitution leaves [0, 1] at impact speeds up to R, or the quadrature has no
        rule of the size asked for, or its tolerance cannot be reached on the grid, or there is no GPU
        where one is asked for, or the method is ``dsmc``, which has no operator.
    """
    if solver.method == "dsmc":
        raise ValueError(
            "method='dsmc': particles have no collision operator; simulate with it, or take another method"
        )
    solver = concrete(scene, solver).solver
    check_restitution(scene.restitution, largest_speed=solver.R)
    module, name = OPERATORS[solver.operator]
    operator = getattr(import_module(module), name)
    return operator(scene, solver)
