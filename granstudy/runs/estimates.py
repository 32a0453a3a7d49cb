"""What a run will choose and cost, before it starts; made once a run."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

from granstudy.collision.choice.cost import Cost, estimate
from granstudy.collision.choice.methods import OPERATORS
from granstudy.collision.operator import choose
from granstudy.model.choice import Choice
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.particles.cost import particle_cost
from granstudy.runs.computation import Computation, ladder
from granstudy.runs.kinds import KINDS

MANY = 100_000
"""Runs whose estimates are kept in memory."""

STAND_IN = {2: (64, 8.0), 3: (32, 8.0)}
"""N and R of estimates, by dimension, where the run chooses them itself: to choose them takes longer than a
workflow can wait for before it starts."""


STAND_IN_RTOL = 1e-4
"""Tolerance of the quadrature, likewise, of a run to an accuracy."""


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
    """What becomes of what the run's solver leaves open; N and R are `STAND_IN` where they are open."""
    solver = computation.solver
    if solver.N is None:
        N, R = STAND_IN[computation.scene.dim]
        solver = (
            replace(solver, N=N, R=R)
            if solver.accuracy is None
            else Solver(N=N, R=R, method="auto", rtol=STAND_IN_RTOL, threads=solver.threads)
        )
    return replace(choose(planned_scene(computation), solver), asked=computation.solver)


def expected_evaluations(computation: Computation) -> int:
    """Evaluations of Q that the run makes, an estimate where the steps adapt; by particles none is made."""
    return KINDS[computation.kind].evaluations(computation, chosen(computation).solver)


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
        setup=sum(cost.seconds for cost in costs),
        each=0.0,
        evaluations=sum(rung.evaluations for rung in rungs),
        memory_mb=max(cost.memory_mb for cost in costs),
    )
    return Estimate(rungs[-1].choice, cost.evaluations, cost)


def _cost(computation: Computation, choice: Choice, evaluations: int) -> Cost:
    solver = choice.solver
    if solver.traits.by_particles:
        time = computation.time
        assert time is not None
        return particle_cost(computation.scene, solver, time.t_final, len(time.recorded))[0]
    cost = OPERATORS[solver.method].cost
    return estimate(cost, planned_scene(computation), solver, evaluations)
