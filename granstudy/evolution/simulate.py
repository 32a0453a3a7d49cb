"""Simulation of a scene, on a grid or by particles.

The module is a fork: it only chooses, and no run's key depends on it (`granstudy.support.fingerprint`).
"""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from granstudy.collision.operator import concrete
from granstudy.datasets.parameters import parameter
from granstudy.evolution.evolve import evolve
from granstudy.evolution.times import TimeSettings, check_frame, check_outputs
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.particles.cost import check_particles
from granstudy.particles.simulation import simulate_particles
from granstudy.support.progress import Progress

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
        For a bad scene, solver or time, before any work starts.

    Notes
    -----
    By method `dsmc`, times only say when moments are recorded; frame and conservation have no meaning there
    and are refused.
    """
    settings = TimeSettings(t_final, dt, time_rtol, times, frame, scheme, conserve, save_every)
    check_frame(scene, solver, settings)
    check_outputs(settings)
    if not solver.traits.by_particles:
        return evolve(scene, concrete(scene, solver), settings, progress)
    check_particles(scene, solver.sized(), settings.t_final)
    ds = simulate_particles(scene, solver, settings.recorded, save_every, progress)
    if settings.dt is None:
        return ds
    return ds.assign_coords(dt=((), settings.dt, parameter("dt").attributes))


def computed_by(solver: Solver) -> Callable[..., xr.Dataset]:
    """The function that simulates by a solver's method; its module is the code that a run uses."""
    return simulate_particles if solver.traits.by_particles else evolve
