"""What a run will choose and cost, before it starts; made once a run."""

from dataclasses import dataclass, replace
from functools import cache

from granstudy.collision.choice.cost import Cost, estimate
from granstudy.collision.choice.methods import OPERATORS
from granstudy.collision.operator import choose
from granstudy.model.scene import Scene
from granstudy.model.solver import Choice
from granstudy.particles.cost import particle_cost
from granstudy.study.kinds import KINDS
from granstudy.study.run import Run

STAND_IN = {2: (64, 8.0), 3: (32, 8.0)}
"""N and R of estimates, by dimension, where the run chooses them itself: to choose them takes longer than a
workflow can wait for before it starts."""


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


def planned_scene(run: Run) -> Scene:
    """The scene that Q is planned for; of a state a gas at rest, as isotropic as the state is."""
    return KINDS[run.model.run].planned_scene(run)


@cache
def chosen(run: Run) -> Choice:
    """What becomes of what the run's solver leaves open; N and R are `STAND_IN` where they are open."""
    solver = run.solver
    if solver.N is None:
        N, R = STAND_IN[run.scene.dim]
        solver = replace(solver, N=N, R=R)
    return replace(choose(planned_scene(run), solver), asked=run.solver)


def expected_evaluations(run: Run) -> int:
    """Evaluations of Q that the run makes, an estimate where the steps adapt; by particles none is made."""
    return KINDS[run.model.run].evaluations(run, chosen(run).solver)


@cache
def estimate_run(run: Run) -> Estimate:
    """Estimate a run from its parameters alone.

    Raises
    ------
    ValueError
        For a scene, solver or times that are refused.
    """
    choice, evaluations = chosen(run), expected_evaluations(run)
    return Estimate(choice, evaluations, _cost(run, choice, evaluations))


def _cost(run: Run, choice: Choice, evaluations: int) -> Cost:
    solver = choice.solver
    if solver.traits.by_particles:
        assert run.time is not None
        return particle_cost(run.scene, solver, run.time.t_final, len(run.time.recorded))[0]
    return estimate(OPERATORS[solver.method].cost, planned_scene(run), solver, evaluations)
