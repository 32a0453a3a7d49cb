"""Simulation of a scene, on a grid or by particles.

The module is a fork: it only chooses, so that no run's key depends on it (`granstudy.support.fingerprint`).
"""

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr

from granstudy.collision.operator import concrete
from granstudy.evolution.evolve import evolve
from granstudy.evolution.times import TimeSettings, check_frame
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.particles.simulation import simulate_particles

FORK = "no run follows or hashes this module (granstudy.support.fingerprint)"


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
    progress: bool | None = None,
) -> xr.Dataset:
    """Advance a scene's initial density to ``t_final``.

    Parameters
    ----------
    t_final : float
        Final time.
    dt : float, optional
        Size of every step, of which ``t_final`` must be a whole number; each is an output.
    time_rtol : float, optional
        In place of ``dt``: steps of any size, each with an estimated error of at most so much of the
        density's largest value and of its fourth moment (in a rescaled frame also of √T).
    times : array_like, optional
        With ``time_rtol``: times of the outputs, positive and increasing, beside 0 and ``t_final``. By
        default 10 a decade from 0.01 on (or a hundredth of ``t_final``).
    frame : str
        ``fixed``: velocities v. ``rescaled``: velocities (v − u)/θ that shrink or grow with the gas, so
        that its temperature stays what it is at the start on the grid; for long cooling and heating.
    scheme : str, optional
        ``rk3`` (the paper's; the default with ``dt``), ``dopri54`` (the default with ``time_rtol``), or
        ``exponential``: order 3, with the diffusion exact, so that it does not limit the step.
    conserve : sequence of str
        Of ``mass``, ``momentum`` and ``energy``: what Q is corrected to conserve, by the least change; of
        energy but for what inelastic collisions of all pairs take. The radial method has no momentum.
        By `dsmc` times say when the moments are recorded and nothing else.
    save_every : int, optional
        Keep the density every so many outputs, with the first and the last; by default none is kept.
    progress : bool, optional
        Show a progress bar; by default where a person watches (a terminal).

    Returns
    -------
    xarray.Dataset
        Moments of f at every output over ``time``, exact laws and errors where a law is known, `status` and
        warnings (see `granstudy.evolution.dataset.evolution_dataset`). A run that cannot go on ends early
        with its status and what it had computed. Where the solver left something open, its coordinates
        and the attribute ``solver`` say what was chosen, ``choice`` why, and ``asked_solver`` what was asked.
        The attribute ``steps`` counts the steps and evaluations of Q that an adaptive run made. A rescaled
        run says where its frame is, and holds its densities as `g`; see `granstudy.physical_density`.

    Raises
    ------
    ValueError
        For a bad scene, solver or time, before any work starts.
    """
    settings = TimeSettings(t_final, dt, time_rtol, times, frame, scheme, conserve, save_every)
    check_frame(scene, solver, settings)
    if not solver.traits.by_particles:
        return evolve(scene, concrete(scene, solver), settings, progress)
    ds = simulate_particles(scene, solver, settings.recorded, save_every, progress)
    return ds if settings.dt is None else ds.assign_coords(dt=settings.dt)


def computed_by(solver: Solver) -> Callable[..., xr.Dataset]:
    """The function that computes the simulations of a solver; its module is the code that a run uses."""
    return simulate_particles if solver.traits.by_particles else evolve
