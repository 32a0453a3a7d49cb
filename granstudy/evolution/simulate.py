"""Simulation of a scene, on a grid or by particles.

The module is a fork: it only chooses, and no run's key depends on it (`granstudy.support.fingerprint`).
"""

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.collision.choice.methods import maker
from granstudy.collision.operator import concrete
from granstudy.datasets.parameters import parameter
from granstudy.datasets.run_dataset import versions
from granstudy.datasets.storage.checkpoint import Checkpoint
from granstudy.evolution.evolve import evolve
from granstudy.evolution.times import TimeSettings, check_frame, check_outputs
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.particles.cost import check_particles
from granstudy.particles.simulation import simulate_particles
from granstudy.support.fingerprint import fingerprint
from granstudy.support.progress import Progress

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"
"""Mark of a fork."""


def simulate_by(
    scene: Scene,
    solver: Solver,
    *,
    t_final: float,
    dt: float | None = None,
    time_rtol: float | None = None,
    times: Sequence[float] | np.ndarray | None = None,
    frame: str = "fixed",
    scheme: str | None = None,
    conserve: Sequence[str] = (),
    save_every: int | None = None,
    progress: Progress = None,
    checkpoint: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """`granstudy.simulate` with a solver; parameters, errors and warnings are explained there."""
    settings = TimeSettings(t_final, dt, time_rtol, times, frame, scheme, conserve, save_every)
    ds = advance(scene, solver, settings, progress, checkpoint)
    if checkpoint is not None:
        Path(checkpoint).unlink(missing_ok=True)
    return ds


def advance(
    scene: Scene,
    solver: Solver,
    settings: TimeSettings,
    progress: Progress = None,
    checkpoint: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """`simulate_by` with settings of time that are checked, and without its warning; a checkpoint stays."""
    check_frame(scene, solver, settings)
    check_outputs(settings)
    if not solver.traits.by_particles:
        choice = concrete(scene, solver)
        kept = _checkpoint(scene, choice.solver, settings, checkpoint, maker(choice.solver))
        return evolve(scene, choice, settings, progress, kept)
    check_particles(scene, solver.sized(), settings.t_final)
    kept = _checkpoint(scene, solver, settings, checkpoint)
    ds = simulate_particles(scene, solver, settings.recorded, settings.save_every, progress, kept)
    if settings.dt is None:
        return ds
    return ds.assign_coords(dt=((), settings.dt, parameter("dt").attributes))


def _checkpoint(
    scene: Scene,
    solver: Solver,
    settings: TimeSettings,
    path: str | os.PathLike[str] | None,
    *makers: Callable[..., object],
) -> Checkpoint | None:
    """The checkpoint in a file, for a run with a chosen solver and the makers of its parts."""
    if path is None:
        return None
    if not isinstance(path, str | os.PathLike) or not os.fspath(path):
        raise ValueError(f"checkpoint={path!r}: must be the path of a file, or None")
    modules = [function.__module__ for function in (computed_by(solver), *makers)]
    identity = {
        "scene": scene.identity(),
        "solver": solver.describe(),
        "time": settings.describe(),
        "code": fingerprint(modules),
        "versions": versions(),
    }
    return Checkpoint(Path(path), identity)


def computed_by(solver: Solver) -> Callable[..., xr.Dataset]:
    """The function that simulates by a solver's method; its module is the code that a run uses."""
    return simulate_particles if solver.traits.by_particles else evolve
