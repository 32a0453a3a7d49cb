"""Simulation of a scene: to an accuracy, or by a solver."""

import os
from collections.abc import Sequence

import numpy as np
import xarray as xr

from granstudy.accuracy.asked import Accuracy, accurate_times
from granstudy.accuracy.evolve import Limits, evolve_to
from granstudy.evolution.simulate import simulate_by
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.checks import check_positive
from granstudy.support.progress import Progress
from granstudy.trust.notice import warn_of_trust

Asked = float | dict[str, float] | Accuracy | None
"""An accuracy as it is asked for (`Accuracy.of`)."""


def simulate(
    scene: Scene,
    solver: Solver | None = None,
    *,
    t_final: float,
    accuracy: Asked = None,
    dt: float | None = None,
    time_rtol: float | None = None,
    times: Sequence[float] | np.ndarray | None = None,
    frame: str = "fixed",
    scheme: str | None = None,
    conserve: Sequence[str] = (),
    save_every: int | None = None,
    max_seconds: float | None = None,
    max_memory: float | None = None,
    progress: Progress = None,
    checkpoint: str | os.PathLike[str] | None = None,
) -> xr.Dataset:
    """Advance the initial density of a scene to ``t_final``: to an accuracy, on a grid, or by particles.

    Parameters
    ----------
    scene : Scene
    solver : Solver, optional
        Grid, quadrature and method; some may be left open (`granstudy.choose`). Without a solver, the run
        chooses all of them, and steps and frame, for an accuracy.
    t_final : float
        Final time.
    accuracy : float or mapping, optional
        In place of a solver: largest errors that T (relative) and a2 may have at any output, as
        ``{"temperature": 1e-4, "a2": 1e-3}``. One number is that of T, and a2 is then asked to 10 times as
        much. Default, without a solver: 1e-3. The fields ``dt`` to ``save_every``, but for ``times``, are
        then the run's own choice (docs/accuracy.md).
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
    max_seconds : float, optional
        With an accuracy: wall time after which the run stops with what it has, status stopped.
    max_memory : float, optional
        With an accuracy: bytes that an operator may take. Where that is too little, the run goes on with less
        accuracy, and says so.
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

    To an accuracy, the dataset also says what was chosen and why, and what was reached
    (`granstudy.accuracy.dataset.accuracy_dataset`).

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
    chosen = {
        "dt": dt,
        "time_rtol": time_rtol,
        "frame": frame,
        "scheme": scheme,
        "conserve": conserve,
    }
    limits = {"max_seconds": max_seconds, "max_memory": max_memory}
    asked = accuracy_asked(solver, accuracy)
    if asked is None:
        assert solver is not None
        for name, value in limits.items():
            if value is not None:
                raise ValueError(f"{name}={value!r}: only with an accuracy, not with a solver")
        ds = simulate_by(
            scene,
            solver,
            t_final=t_final,
            dt=dt,
            time_rtol=time_rtol,
            times=times,
            frame=frame,
            scheme=scheme,
            conserve=conserve,
            save_every=save_every,
            progress=progress,
            checkpoint=checkpoint,
        )
        warn_of_trust(ds)
        return ds
    for name, value in limits.items():
        if value is not None:
            check_positive(name, value)
    if checkpoint is not None:
        raise ValueError(f"checkpoint={checkpoint!r}: not beside accuracy; give a solver")
    threads = None if solver is None else solver.threads
    settings = accurate_times(t_final, times, save_every, **chosen)
    given = Limits(max_seconds or np.inf, max_memory or np.inf, threads)
    ds = evolve_to(scene, asked, settings, given, progress)
    warn_of_trust(ds)
    return ds


def accuracy_asked(solver: Solver | None, accuracy: Asked) -> Accuracy | None:
    """The accuracy asked for, by itself or in a solver; None for a solver that asks for none.

    Raises
    ------
    ValueError
        For an accuracy beside a solver.
    """
    if solver is None:
        return Accuracy.of(accuracy)
    if accuracy is not None:
        raise ValueError(
            f"accuracy={accuracy!r}: chooses what a solver says; give accuracy or solver, not both"
        )
    return None if solver.accuracy is None else Accuracy.of_solver(solver)
