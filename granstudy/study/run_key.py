"""The key of a run: a hash over all that its numbers depend on, parameters and code."""

import hashlib
from collections.abc import Callable

import xarray as xr

from granstudy.collision.choice.cheapest import choose_method
from granstudy.collision.choice.grid import fit_solver
from granstudy.collision.choice.methods import maker
from granstudy.datasets.run_dataset import stamped
from granstudy.evolution.simulate import computed_by
from granstudy.model.solver import Solver
from granstudy.states.solve import cooling_state
from granstudy.study.run import Run
from granstudy.support.fingerprint import fingerprint

COMPUTED_BY: dict[str, Callable[[Solver], Callable[..., xr.Dataset]]] = {
    "evolution": computed_by,
    "collision": lambda solver: stamped,
    "state": lambda solver: cooling_state,
}


def run_key(run: Run) -> str:
    """Hash over all that a run's numbers depend on: its parameters and the code that computes it."""
    code = run_fingerprint(run)
    return hashlib.sha256(f"{run.parameters()}\n{code}".encode()).hexdigest()[:32]


def run_fingerprint(run: Run) -> str:
    """Fingerprint of the code behind a run: what computes it, its operator, what chooses where it is open."""
    solver = run.solver
    modules = [COMPUTED_BY[run.model.run](solver).__module__]
    if not solver.traits.by_particles:
        modules.append(maker(run.choice.solver).__module__)
    if solver.traits.chooses:
        modules.append(choose_method.__module__)
    if solver.N is None:
        modules.append(fit_solver.__module__)
    return fingerprint(modules)
