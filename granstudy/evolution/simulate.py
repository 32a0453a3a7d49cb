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
from granstudy.trust.notice import warn_of_trust

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"
"""Mark of a fork."""


def simulate(
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
    """Advance the initial density of a scene to ``t_final``, on a grid or by particles.

    Parameters
    ----------
    scene : Scene
    solver : Solver
        Grid or method may be left open (`granstudy.choose`).
    t_final : float
        Final time.
    dt : float, optional
        Size of every step; ``t_final`` must be a whole number of steps. Every step is an output.
    time_rtol : float, optional
        In place of ``dt``: tolerance of steps that adapt their size. The estimated error of a step is at most
        ``time_rtol``, relative to the largest value of the density, to its fourth moment, and in a rescaled
        frame to √T.
    times : array_like, optional
        With ``time_rtol``: times of outputs, positive and increasing; 0 and ``t_final`` are outputs too.
        Default: 10 in a decade, from 0.01 on, or from ``t_final``/100 where this is earlier.
    frame : str
        ============  ============================================================================
        ``fixed``     velocities v
        ``rescaled``  velocities (v − u)/θ, which shrink and grow with the gas: its temperature on
                      the grid stays as it is at the start. For long cooling and heating
        ============  ============================================================================
    scheme : str, optional
        ===============  =========================================================================
        ``rk3``          order 3, the paper's; default with ``dt``
        ``dopri54``      order 5; default with ``time_rtol``
        ``exponential``  order 3, with exact diffusion, which then does not limit the step
        ===============  =========================================================================
    conserve : sequence of str
        Which of ``mass``, ``momentum``, ``energy`` the discrete Q balances exactly. Q is changed as little as
        possible (docs/method.md §9). Mass and momentum then stay constant; collisions take energy at the
        exact rate, summed over all pairs of the density. A radial grid has no momentum.
    save_every : int, optional
        Keep the density at the first output, at every ``save_every``-th after it, and at the last. Default:
        no density is kept.
    progress : bool or callable, optional
        Show a progress bar, or call a function of (done, total, time). Default: a bar where a person watches
        (a terminal, a notebook). By a grid, done is the number of outputs after the start, and the function
        is called after each output, and between outputs about ten times a second. By particles, all batches
        count together, the time is their mean, and the function is called about ten times a second.
    checkpoint : str or path, optional
        File that the state of the run is written to once a minute, so that the same call goes on from there
        after an interruption, with the same numbers as a run without one. It is removed when the run is
        done. The environment variable ``GRANSTUDY_CHECKPOINT_SECONDS`` sets other seconds. By particles,
        states are those at recorded times.

    Returns
    -------
    xarray.Dataset
        Moments of f over ``time``, exact laws and errors where a law is known, `status`, `trust`. A run that
        cannot go on ends early, with its status, the reason, and all that was computed before.

        ==========================  =============================================================
        `f`, `g`                    kept densities, in the fixed and in the rescaled frame;
                                    `granstudy.physical_density` makes f of either
        attribute ``steps``         numbers of steps, and of evaluations of Q, where steps adapt
        attribute ``choice``        why grid and method were chosen, where they were open
        attribute ``solver``        the solver that was chosen
        attribute ``asked_solver``  the solver asked for, where that is another one
        ==========================  =============================================================

    Raises
    ------
    ValueError
        For a bad scene, solver or time, before any work starts; and where ``checkpoint`` is a file of another
        kind, or of a run with another scene, solver, time, code, or version of a library.

    Warns
    -----
    NotTrustedWarning
        If the run is marginal or untrusted, with the remedy.

    Notes
    -----
    By method `dsmc`, times only say when moments are recorded; frame and conservation have no meaning there
    and are refused.
    """
    settings = TimeSettings(t_final, dt, time_rtol, times, frame, scheme, conserve, save_every)
    ds = advance(scene, solver, settings, progress, checkpoint)
    if checkpoint is not None:
        Path(checkpoint).unlink(missing_ok=True)
    warn_of_trust(ds)
    return ds


def advance(
    scene: Scene,
    solver: Solver,
    settings: TimeSettings,
    progress: Progress = None,
    checkpoint: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """`simulate` with settings of time that are checked, and without its warning; a checkpoint stays."""
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
