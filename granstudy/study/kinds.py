"""The kinds of runs, a row each: how a run of the kind is computed, checked and counted."""

from collections.abc import Callable
from dataclasses import dataclass

import xarray as xr

from granstudy.evolution.forecast import expected_evaluations
from granstudy.evolution.simulate import computed_by, simulate
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.states.solve import (
    FIND,
    check_state,
    cooling_state,
    gaussian_scene,
    state_evaluations,
)
from granstudy.study.evaluate import evaluate
from granstudy.study.run import Run
from granstudy.study.schema.experiment import EvolutionExperiment, StateExperiment
from granstudy.trust.exact_law import check_maxwell_law


@dataclass(frozen=True)
class Kind:
    """What there is to know of the runs of one kind.

    Attributes
    ----------
    code : callable
        chosen solver ↦ the function that computes such a run; its module is the code that the run uses.
    compute : callable or None
        (run, solver) ↦ the run's dataset; None where all runs of an experiment are computed together.
    evaluations : callable
        (run, chosen solver) ↦ evaluations of Q that the run makes; an estimate where the steps adapt.
    planned_scene : callable
        run ↦ the scene that Q is planned for.
    check : callable
        run ↦ None; raises ValueError for what would stop the run whatever is chosen for it.
    by_particles : bool
        Whether particles, which have no collision operator, can do such a run.
    needs_size : bool
        Whether N and R must be given.
    shares_nodes : bool
        Whether a run and its reference must have the same velocity nodes.
    """

    code: Callable[[Solver], Callable[..., object]]
    compute: Callable[[Run, Solver], xr.Dataset] | None
    evaluations: Callable[[Run, SizedSolver], int] = lambda run, solver: 1
    planned_scene: Callable[[Run], Scene] = lambda run: run.scene
    check: Callable[[Run], None] = lambda run: None
    by_particles: bool = False
    needs_size: bool = False
    shares_nodes: bool = False


def _evolve(run: Run, solver: Solver) -> xr.Dataset:
    return simulate(run.scene, solver, **run.time_fields)


def _evolution_evaluations(run: Run, solver: SizedSolver) -> int:
    assert run.time is not None
    return expected_evaluations(run.scene, solver, run.time)


def _check_law(run: Run) -> None:
    """Raise ValueError unless the exact law holds that the run is held against, if it is one."""
    assert isinstance(run.model, EvolutionExperiment)
    if run.model.truth is not None and run.model.truth.law is not None:
        check_maxwell_law(run.scene)


def _state(run: Run) -> str:
    assert isinstance(run.model, StateExperiment)
    return run.model.state


KINDS = {
    "evolution": Kind(
        code=computed_by,
        compute=_evolve,
        evaluations=_evolution_evaluations,
        check=_check_law,
        by_particles=True,
    ),
    "collision": Kind(
        code=lambda solver: evaluate,
        compute=lambda run, solver: evaluate(run.scene, solver),
        shares_nodes=True,
    ),
    "benchmark": Kind(code=lambda solver: evaluate, compute=None, needs_size=True),
    "state": Kind(
        code=lambda solver: cooling_state,
        compute=lambda run, solver: FIND[_state(run)](run.scene, solver),
        evaluations=lambda run, solver: state_evaluations(solver),
        planned_scene=lambda run: gaussian_scene(run.scene),
        check=lambda run: check_state(run.scene, run.solver, heated=_state(run) == "heated"),
    ),
}
"""The row of each kind, by its name in study files."""
