"""The kinds of runs, a row each: how a run of the kind is computed, checked and counted."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import xarray as xr

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.evolve import Limits, evolve_to
from granstudy.accuracy.states.find import state_to
from granstudy.collision.operator import choose
from granstudy.evolution.forecast import expected_evaluations
from granstudy.evolution.simulate import advance, computed_by
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.runs.computation import Computation
from granstudy.runs.evaluate import evaluate
from granstudy.runs.labels.labelled import labelled_run
from granstudy.runs.labels.truths import truth_of
from granstudy.states.solve import (
    FIND,
    check_state,
    cooling_state,
    gaussian_scene,
    solving_seconds,
    state_evaluations,
)
from granstudy.support.progress import Progress


@dataclass(frozen=True)
class Kind:
    """What there is to know of the runs of one kind.

    Attributes
    ----------
    code : callable
        chosen solver ↦ the function that computes such a run; its module is the code that the run uses.
    to_accuracy : callable or None
        The function that computes such a run to an accuracy; None where there is no such run.
    compute : callable or None
        (computation, solver, progress, checkpoint) ↦ the run's dataset, progress as of `granstudy.simulate`;
        None where all runs of an experiment are computed together. The checkpoint is a path or None, for runs
        that can go on from there; whoever asked for the run removes it.
    evaluations : callable
        (computation, chosen solver) ↦ evaluations of Q that the run makes; an estimate where the steps adapt.
    planned_scene : callable
        scene ↦ the scene that Q is planned for.
    check : callable
        computation ↦ None; raises ValueError for what would stop the run whatever is chosen for it.
    by_particles : bool
        Whether particles, which have no collision operator, can do such a run.
    needs_size : bool
        Whether N and R must be given.
    shares_nodes : bool
        Whether a run and its reference must have the same velocity nodes.
    parts : callable
        computation ↦ the computations of other kinds that the run makes on its way; their cost is its cost,
        and their code its code.
    seconds : callable
        chosen solver ↦ seconds beside evaluations of Q, of a run that does not evolve.
    heated : bool
        Whether the run solves for a heated state.
    """

    code: Callable[[Solver], Callable[..., object]]
    to_accuracy: Callable[..., object] | None
    compute: Callable[[Computation, Solver, Progress, Path | None], xr.Dataset] | None
    evaluations: Callable[[Computation, SizedSolver], int] = lambda computation, solver: 1
    planned_scene: Callable[[Scene], Scene] = lambda scene: scene
    check: Callable[[Computation], None] = lambda computation: None
    by_particles: bool = False
    needs_size: bool = False
    shares_nodes: bool = False
    parts: Callable[[Computation], Sequence[Computation]] = lambda computation: ()
    seconds: Callable[[SizedSolver], float] = lambda solver: 0.0
    heated: bool = False


def _evolve(
    computation: Computation, solver: Solver, progress: Progress, checkpoint: Path | None
) -> xr.Dataset:
    assert computation.time is not None
    if solver.accuracy is not None:
        return evolve_to(
            computation.scene,
            Accuracy.of_solver(solver),
            computation.time,
            Limits(threads=solver.threads),
            progress,
        )
    return advance(computation.scene, solver, computation.time, progress, checkpoint)


def _evolution_evaluations(computation: Computation, solver: SizedSolver) -> int:
    assert computation.time is not None
    return expected_evaluations(computation.scene, solver, computation.time)


def _find(
    state: str,
    computation: Computation,
    solver: Solver,
    progress: Progress,
    checkpoint: Path | None,
) -> xr.Dataset:
    if solver.accuracy is not None:
        asked = Accuracy.of_solver(solver)
        return state_to(computation.scene, asked, state, progress=progress, threads=solver.threads)
    return FIND[state](computation.scene, solver, progress=progress)


def _check_state(state: str, computation: Computation) -> None:
    solver = computation.solver
    if solver.accuracy is not None:
        solver = Solver(N=32, R=8.0, method="radial")
    check_state(computation.scene, solver, heated=state == "heated")


def _state(state: str) -> Kind:
    return Kind(
        code=lambda solver: cooling_state,
        to_accuracy=state_to,
        compute=partial(_find, state),
        evaluations=lambda computation, solver: state_evaluations(solver),
        planned_scene=gaussian_scene,
        check=partial(_check_state, state),
        seconds=solving_seconds,
        heated=state == "heated",
    )


def _label_parts(computation: Computation) -> list[Computation]:
    """A random run itself, and the finer run that is its truth, where no law is."""
    run = replace(computation, kind="evolution")
    truth = truth_of(run)
    return [run] if truth is None else [run, truth]


def _label(
    computation: Computation, solver: Solver, progress: Progress, checkpoint: Path | None
) -> xr.Dataset:
    assert computation.time is not None
    run, *finer = _label_parts(computation)
    truths = [
        _evolve(one, replace(one.solver, threads=solver.threads), False, None) for one in finer
    ]
    return labelled_run(
        computation.scene,
        choose(computation.scene, solver),
        computation.time,
        _evolve(run, solver, progress, None),
        truths[0] if truths else None,
    )


KINDS = {
    "evolution": Kind(
        code=computed_by,
        to_accuracy=evolve_to,
        compute=_evolve,
        evaluations=_evolution_evaluations,
        by_particles=True,
    ),
    "collision": Kind(
        code=lambda solver: evaluate,
        to_accuracy=None,
        compute=lambda computation, solver, *_: evaluate(computation.scene, solver),
        shares_nodes=True,
    ),
    "benchmark": Kind(
        code=lambda solver: evaluate, to_accuracy=None, compute=None, needs_size=True
    ),
    "labels": Kind(
        code=lambda solver: labelled_run,
        to_accuracy=None,
        compute=_label,
        by_particles=True,
        parts=_label_parts,
    ),
    "cooling state": _state("cooling"),
    "heated state": _state("heated"),
}
"""The row of each kind, by its name in the parameters of a run."""
