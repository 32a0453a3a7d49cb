"""The protocol of a collision operator, and the choice of one by the solver's method."""

from importlib import import_module
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from granstudy.model.kernel import check_restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import Choice, Solver
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import VelocitySpace

if TYPE_CHECKING:
    from granstudy.collision.fast.adaptive.plan import QuadraturePlan

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


class CollisionOperator(Protocol):
    """Q(f,f) for one scene and one solver: planned once, called often.

    Attributes
    ----------
    grid : VelocityGrid, or RadialGrid of the method `radial`
    transforms : int
        Fourier transforms on the grid that one call makes.
    """

    @property
    def grid(self) -> VelocitySpace: ...  # noqa: D102
    @property
    def transforms(self) -> int: ...  # noqa: D102

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f), of the shape and type of ``f``: real for real densities."""

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""


@runtime_checkable
class SpectrumOperator(CollisionOperator, Protocol):
    """An operator of which a run advances f̂, complex and never projected on real f (`literal`)."""

    @property
    def grid(self) -> VelocityGrid: ...  # noqa: D102

    def spectrum(self, f_hat: np.ndarray) -> np.ndarray:
        """Q̂ from f̂ (docs/method.md §2, normalised by N^d), both in FFT order."""


@runtime_checkable
class TunedOperator(CollisionOperator, Protocol):
    """An operator with a quadrature chosen for a tolerance and a density (`Solver.rtol`)."""

    plan: "QuadraturePlan"

    def check(self, f: np.ndarray) -> float:
        """The error of Q(f,f) that the tolerance bounds, by a finer quadrature."""

    def tune(self, f: np.ndarray) -> "QuadraturePlan":
        """Choose the quadrature anew, for this density."""


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


class NotFiniteError(ValueError):
    """A density holds NaN or infinite values."""


class ToleranceError(ValueError):
    """A tolerance cannot be reached on the solver's grid."""


def check_state(f: np.ndarray, grid: VelocitySpace) -> None:
    """Raise ValueError unless ``f`` can be a state on ``grid``: its shape, and finite values."""
    if np.shape(f) != grid.shape:
        raise ValueError(f"density has shape {np.shape(f)}: the grid's is {grid.shape}")
    if not np.all(np.isfinite(f)):
        raise NotFiniteError("density holds values that are NaN or infinite: all must be finite")
