"""Every collision method, a row each: what makes its operator, what it checks, what it costs.

The module is a fork: the key of a run depends on the code of its own method alone
(`granstudy.support.fingerprint`).
"""

from collections.abc import Callable
from dataclasses import dataclass

from granstudy.collision.carleman import scenes as carleman_scenes
from granstudy.collision.carleman.operator import CarlemanOperator
from granstudy.collision.choice.cost import MethodCost, estimate
from granstudy.collision.choice.method_costs import CARLEMAN, DIRECT, FAST, LITERAL, RADIAL
from granstudy.collision.direct import DirectOperator
from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.collision.fast.gpu.device import check_scene as check_gpu_scene
from granstudy.collision.fast.gpu.operator import adaptive_on_gpu, fast_on_gpu
from granstudy.collision.fast.operator import fast_operator
from granstudy.collision.literal import LiteralOperator
from granstudy.collision.protocol import CollisionOperator
from granstudy.collision.radial.operator import RadialOperator
from granstudy.collision.rules import directions
from granstudy.model.isotropy import check_isotropic
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.quadrature.rule import check_gauss_size
from granstudy.support.machine import check_memory

Make = Callable[[Scene, SizedSolver], CollisionOperator]
"""(scene, solver) ↦ its operator."""

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"
"""Mark of a fork."""


def check_rule(scene: Scene, solver: SizedSolver) -> None:
    """Raise ValueError unless there is a rule with the number of directions asked for."""
    if solver.rtol is None:
        directions(scene, solver)


def check_carleman(scene: Scene, solver: SizedSolver) -> None:
    """Raise ValueError unless there is such a rule, and the Carleman form can do the scene."""
    check_rule(scene, solver)
    carleman_scenes.check_scene(scene)


@dataclass(frozen=True)
class OperatorRow:
    """One collision method.

    Attributes
    ----------
    make : callable
        (scene, solver) ↦ its operator.
    check : callable
        (scene, solver) ↦ None; raises ValueError, before any work, for a scene or solver that the method
        cannot do.
    cost : MethodCost
        Cost of an evaluation.
    tuned : callable, optional
        (scene, solver) ↦ operator with a quadrature chosen for ``rtol``.
    on_gpu : callable, optional
        (scene, solver) ↦ operator on a GPU, for methods that take ``device``.
    tuned_on_gpu : callable, optional
        (scene, solver) ↦ operator with a chosen quadrature, on a GPU.
    """

    make: Make
    check: Callable[[Scene, SizedSolver], None]
    cost: MethodCost
    tuned: Make | None = None
    on_gpu: Make | None = None
    tuned_on_gpu: Make | None = None


OPERATORS: dict[str, OperatorRow] = {
    "literal": OperatorRow(LiteralOperator, check_rule, LITERAL),
    "direct": OperatorRow(DirectOperator, check_rule, DIRECT),
    "fast": OperatorRow(
        fast_operator,
        check_rule,
        FAST,
        tuned=AdaptiveOperator,
        on_gpu=fast_on_gpu,
        tuned_on_gpu=adaptive_on_gpu,
    ),
    "radial": OperatorRow(
        RadialOperator, lambda scene, solver: check_isotropic(scene, solver.R), RADIAL
    ),
    "carleman": OperatorRow(CarlemanOperator, check_carleman, CARLEMAN),
}
"""The methods that have an operator, by name."""


def maker(solver: Solver) -> Make:
    """The maker of a solver's operator, its method being chosen; its module is the code that a run uses."""
    row = OPERATORS[solver.method]
    plain, tuned = (
        (row.make, row.tuned) if solver.device == "cpu" else (row.on_gpu, row.tuned_on_gpu)
    )
    make = tuned if solver.rtol is not None and tuned is not None else plain
    assert make is not None  # the solver has checked that its method takes the device
    return make


def check_fits(scene: Scene, solver: SizedSolver) -> None:
    """Raise ValueError, before anything large is allocated, for an operator that memory cannot hold."""
    if solver.N_rho is not None and "N_rho" not in solver.traits.unused:
        check_gauss_size("N_rho", solver.N_rho)
    needed = estimate(OPERATORS[solver.method].cost, scene, solver, evaluations=1).memory_mb
    sizes = solver.coordinates(scene.dim)
    played = {"N", "N_rho", "M_cir", "M_sph"} - solver.traits.unused
    shown = [name for name in sizes if name in played]
    check_memory(
        ", ".join(f"{name}={sizes[name]}" for name in shown),
        needed * 2.0**20,
        f"an operator of method {solver.method!r} must fit; take a smaller size",
    )


def check(scene: Scene, solver: SizedSolver) -> None:
    """Raise ValueError for a scene that the solver's method cannot do; a missing GPU does not count."""
    if scene.dim not in solver.traits.dimensions:
        allowed = " and ".join(map(str, solver.traits.dimensions))
        raise ValueError(f"dim={scene.dim!r}: method {solver.method!r} takes {allowed}")
    if callable(scene.restitution) and not solver.traits.laws:
        raise ValueError(
            f"restitution={scene.restitution!r}: method {solver.method!r} takes a constant, not a function "
            "of the impact speed; take method 'fast'"
        )
    OPERATORS[solver.method].check(scene, solver)
    if solver.device == "gpu":
        check_gpu_scene(scene)
