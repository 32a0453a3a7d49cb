"""What a run will choose and cost, before it starts; made once a run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from granstudy.accuracy.asked import Accuracy
from granstudy.collision.choice.cost import Cost, estimate
from granstudy.collision.choice.methods import OPERATORS
from granstudy.collision.operator import choose
from granstudy.evolution.forecast import evolution_cost
from granstudy.model.choice import Choice
from granstudy.model.scene import Scene
from granstudy.particles.cost import particle_cost
from granstudy.runs.accurate import (
    Beginning,
    accurate_cost,
    beginning,
    state_cost,
    state_solver,
)
from granstudy.runs.computation import Computation, ladder
from granstudy.runs.kinds import KINDS

MANY = 100_000
"""Runs whose estimates are kept in memory."""

STAND_IN = {2: (64, 8.0), 3: (32, 8.0)}
"""N and R of estimates, by dimension, where the run chooses them itself for a tolerance: to choose them takes
longer than a workflow can wait for before it starts."""

TO_ACCURACY = "for an accuracy; an estimate, as the run chooses by measuring"
"""Reason of a choice that a run to an accuracy makes."""


@dataclass(frozen=True)
class Estimate:
    """What a run will take.

    Attributes
    ----------
    choice : Choice
        What becomes of what the solver leaves open; N and R are `STAND_IN` where they are open.
    evaluations : int
        Evaluations of Q, an estimate where the steps adapt.
    cost : Cost
        Seconds on one thread, and memory.
    """

    choice: Choice
    evaluations: int
    cost: Cost


def planned_scene(computation: Computation) -> Scene:
    """The scene that Q is planned for; of a state a gas at rest, as isotropic as the state is."""
    return KINDS[computation.kind].planned_scene(computation.scene)


@lru_cache(maxsize=MANY)
def chosen(computation: Computation) -> Choice:
    """What becomes of what the run's solver leaves open; N and R are `STAND_IN` where they are open.

    For an accuracy, what the run begins with, about; of a state, what it ends with.
    """
    scene, solver = computation.scene, computation.solver
    if solver.accuracy is not None:
        asked = Accuracy.of_solver(solver)
        if computation.time is None:
            sized = state_solver(scene, asked, KINDS[computation.kind].heated)
        else:
            sized = _begins(computation).solver
        return Choice(solver, sized, TO_ACCURACY)
    if solver.N is None:
        N, R = STAND_IN[scene.dim]
        solver = replace(solver, N=N, R=R)
    return replace(choose(planned_scene(computation), solver), asked=computation.solver)


@lru_cache(maxsize=MANY)
def _begins(computation: Computation) -> Beginning:
    """What an evolution to an accuracy begins with, about."""
    assert computation.time is not None
    asked = Accuracy.of_solver(computation.solver)
    return beginning(computation.scene, asked, computation.time.t_final)


def expected_evaluations(computation: Computation) -> int:
    """Evaluations of Q that the run makes, an estimate where the steps adapt; by particles none is made."""
    if computation.solver.accuracy is not None:
        return _accurate(computation).evaluations
    return KINDS[computation.kind].evaluations(computation, chosen(computation).solver)


def _accurate(computation: Computation) -> Cost:
    """Cost of a run or a state to an accuracy."""
    asked = Accuracy.of_solver(computation.solver)
    if computation.time is None:
        return state_cost(computation.scene, asked, KINDS[computation.kind].heated)
    return accurate_cost(asked, computation.time, _begins(computation))


@lru_cache(maxsize=MANY)
def estimate_run(computation: Computation) -> Estimate:
    """Estimate a run from its parameters alone; with a refinement, or with parts, the sum of its runs.

    Raises
    ------
    ValueError
        For a scene, solver or times that are refused.
    """
    if computation.refinement is not None:
        return _sum([estimate_run(rung) for rung in ladder(computation)])
    if parts := KINDS[computation.kind].parts(computation):
        whole = _sum([estimate_run(part) for part in parts])
        return replace(whole, choice=chosen(computation))
    choice, evaluations = chosen(computation), expected_evaluations(computation)
    return Estimate(choice, evaluations, _cost(computation, choice, evaluations))


def _sum(rungs: Sequence[Estimate]) -> Estimate:
    """The estimate of runs one after the other; the choice is the last one's."""
    costs = [rung.cost for rung in rungs]
    cost = Cost(
        setup=sum(cost.own_seconds for cost in costs),
        each=0.0,
        evaluations=sum(rung.evaluations for rung in rungs),
        memory_mb=max(cost.memory_mb for cost in costs),
        kept=tuple({one for cost in costs for one in cost.kept}),
    )
    return Estimate(rungs[-1].choice, cost.evaluations, cost)


def _cost(computation: Computation, choice: Choice, evaluations: int) -> Cost:
    solver, time = choice.solver, computation.time
    if computation.solver.accuracy is not None:
        return _accurate(computation)
    if solver.traits.by_particles:
        assert time is not None
        return particle_cost(computation.scene, solver, time.t_final, len(time.recorded))[0]
    scene, kind = planned_scene(computation), KINDS[computation.kind]
    cost = estimate(OPERATORS[solver.method].cost, scene, solver, evaluations)
    if time is None:
        return replace(cost, setup=cost.setup + kind.seconds(solver))
    return evolution_cost(cost, scene, solver, time)
