"""The kinds of runs, a row each: how a run of the kind is computed, checked and counted."""

from collections.abc import Callable
from dataclasses import dataclass

import xarray as xr

from granstudy.evolution.forecast import expected_evaluations
from granstudy.evolution.simulate import computed_by, simulate
from granstudy.evolution.times import check_frame
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.states.solve import FIND, check_state, gaussian_scene, state_evaluations
from granstudy.study.evaluate import evaluate
from granstudy.study.run import Run
from granstudy.study.schema.experiment import EvolutionExperiment, StateExperiment
from granstudy.trust.exact_law import check_maxwell_law


@dataclass(frozen=True)
class Kind:
    """What there is to know of the runs of one kind.

    Attributes
    ----------
    compute : callable or None
        (run, solver) ↦ its dataset; None where all runs of an experiment are computed together.
    code : callable
        (run, solver chosen) ↦ the function whose module, with the operator's maker, is the code of the run.
    evaluations : callable
        (run, solver chosen) ↦ evaluations of Q that the run makes; about as many where the steps adapt.
    planned_scene : callable
        run ↦ the scene that Q is planned for.
    check : callable
        Raises ValueError for what would stop the run, whatever is chosen for it.
    by_particles : bool
        Whether particles, which have no collision operator, can do such runs.
    sized : bool
        Whether N and R must be given.
    shares_nodes : bool
        Whether a run and its reference must have the same velocity nodes.
    """

    compute: Callable[[Run, Solver], xr.Dataset] | None
    code: Callable[[Run, Solver], Callable[..., object]]
    evaluations: Callable[[Run, SizedSolver], int] = lambda run, solver: 1
    planned_scene: Callable[[Run], Scene] = lambda run: run.scene
    check: Callable[[Run], None] = lambda run: None
    by_particles: bool = False
    sized: bool = False
    shares_nodes: bool = False
