"""Every collision method, a row each: what makes its operator, what it checks, what it costs.

The module is a fork: a run follows only the row of its own method, and only that method's code counts in the
run's key (`granstudy.support.fingerprint`).
"""

from collections.abc import Callable
from dataclasses import dataclass

from granstudy.collision.carleman import scenes as carleman_scenes
from granstudy.collision.carleman.operator import CarlemanOperator
from granstudy.collision.choice.cost import MethodCost
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

Make = Callable[[Scene, SizedSolver], CollisionOperator]

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"


def check_rule(scene: Scene, solver: SizedSolver) -> None:
    """Raise ValueError unless there is a rule of directions of the size asked for."""
    if solver.rtol is None:
        directions(scene, solver)


def check_carleman(scene: Scene, solver: SizedSolver) -> None:
    """Raise ValueError unless there is such a rule and the Carleman form can do the scene."""
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
        Raises ValueError for a scene or solver that the method cannot do, before any work.
    cost : MethodCost
        What an evaluation takes.
    tuned, on_gpu, tuned_on_gpu : callable, optional
        What makes the operator of a solver with a tolerance, on a GPU, or with both; only methods that take
        ``rtol`` or ``device`` have these (`granstudy.model.methods`).
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
    """What makes the operator of a solver whose method is chosen; its module is the code that a run uses."""
    row = OPERATORS[solver.method]
    plain, tuned = (
        (row.make, row.tuned) if solver.device == "cpu" else (row.on_gpu, row.tuned_on_gpu)
    )
    make = tuned if solver.rtol is not None and tuned is not None else plain
    assert make is not None  # the solver has checked that its method takes the device
    return make


def check(scene: Scene, solver: SizedSolver) -> None:
    """Raise ValueError for what would stop the solver's method on the scene, but for a missing GPU."""
    OPERATORS[solver.method].check(scene, solver)
    if solver.device == "gpu":
        check_gpu_scene(scene)
