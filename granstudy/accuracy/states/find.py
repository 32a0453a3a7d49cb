"""Cooling and heated states to an accuracy: the grid is raised until the answer no longer changes."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.simulate import Asked, accuracy_asked
from granstudy.accuracy.states.dataset import described
from granstudy.accuracy.states.exact import EXACT_UP_TO, ExactState, has_exact_moments
from granstudy.accuracy.states.ladder import FEWEST, LADDER, Found, measured, round_off_beyond
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.states.solve import FIND, check_state
from granstudy.support.machine import one_blas_thread
from granstudy.support.progress import Progress


def cooling_state(
    scene: Scene,
    solver: Solver | None = None,
    *,
    accuracy: Asked = None,
    tolerance: float = 1e-9,
    max_iterations: int = 20,
    progress: Progress = None,
) -> xr.Dataset:
    """Solve for the homogeneous cooling state: f = θ^{−d} g((v−u)/θ), with a g that stays as it is.

    The equation is Q(g,g) + (θ'/θ) ∇c·(c g) = 0, at θ = 1. The scene gives density, bulk velocity and
    temperature, as its initial density has them on the grid. The temperature sets how far the grid reaches
    in thermal speeds.

    Parameters
    ----------
    scene : Scene
        A scene with constant e < 1 and ε = 0.
    solver : Solver, optional
        Any method but `dsmc`, with N and R given. As the state is isotropic, `auto` takes `radial`; only
        these two may have an ``rtol``.
    accuracy : float or mapping, optional
        In place of a solver: largest errors of T and K (relative), and of a2, as of `granstudy.simulate`. N
        and R are raised until the state no longer changes by more; where it never does, the attribute
        ``needed`` says so. Default, without a solver: 1e-3.
    tolerance : float
        Largest residual, over the largest value of (θ'/θ) ∇c·(c g).
    max_iterations : int
        Largest number of steps of Newton's method.
    progress : bool or callable, optional
        Show a progress bar, or call a function of (done, total, time) after each step, with total
        ``max_iterations`` and time NaN. Default: a bar where a person watches (a terminal, a notebook).

    Returns
    -------
    xarray.Dataset
        Parameters, status, trust and attributes as of a run (`granstudy.simulate`). A state that was not
        found has the status failed, with the reason; the last iterate is then given as it is.

        =============================================  =========================================
        `g`                                            density over the scaled velocities
        `temperature`, `a2`, `a3`                      T, kurtosis excess, Sonine coefficient a3
        `cooling_rate`, `cooling_coefficient`          −T'/T; K of T' = −ρK T^{1+λ/2}
        `tail_slope` over ``tail_speed`` = |v−u|/√T    −d ln f/d c^λ; at λ = 0, −d ln f/d ln c
        `residual` over ``iteration``                  how Newton's method converged
        =============================================  =========================================

    Raises
    ------
    ValueError
        For a scene without such a state, or a solver that cannot find it, before any work starts.
    """
    return _state("cooling", scene, solver, accuracy, tolerance, max_iterations, progress)


def heated_state(
    scene: Scene,
    solver: Solver | None = None,
    *,
    accuracy: Asked = None,
    tolerance: float = 1e-9,
    max_iterations: int = 20,
    progress: Progress = None,
) -> xr.Dataset:
    """Solve for the steady state of a gas heated by diffusion, Q(f,f) + εΔf = 0.

    The equation is Q(g,g) + sΔg = 0 for f = θ^{−d} g((v−u)/θ), at the temperature T_g of the scene's initial
    density on the grid. Then θ^{2+λ} = ε/s and T = θ²T_g, so that the grid holds the state at any ε.

    Parameters, returned dataset and errors are as of `cooling_state`, with two differences: ε must be
    above 0, and `tail_slope` is −d ln f/d c^{1+λ/2}.
    """
    return _state("heated", scene, solver, accuracy, tolerance, max_iterations, progress)


def _state(
    state: str, scene: Scene, solver: Solver | None, accuracy: Asked, *how: Any
) -> xr.Dataset:
    """A state to an accuracy, or by a solver; ``how`` are tolerance, iterations and progress."""
    asked = accuracy_asked(solver, accuracy)
    if asked is not None:
        return state_to(scene, asked, state, *how)
    assert solver is not None
    return FIND[state](scene, solver, *how)


@one_blas_thread()
def state_to(
    scene: Scene,
    asked: Accuracy,
    state: str,
    tolerance: float = 1e-9,
    max_iterations: int = 20,
    progress: Progress = None,
    threads: int | None = None,
) -> xr.Dataset:
    """A state on the first grid of `LADDER` whose errors, by the grids before, are at most those asked for.

    K, T, a2 and a3 of Maxwell molecules are exact. Their grid is raised until its own numbers are as near to
    them as is asked, at most up to `EXACT_UP_TO`.

    Returns
    -------
    xarray.Dataset
        As of `granstudy.cooling_state`, with variables more, and attributes as of a run to an accuracy
        (`asked`, `reached`, ``choices``, `needed`):

        ==============================  ===================================================
        `cooling_coefficient_error`     estimated error of K (and of T, heated), relative
        `a2_error`, `a3_error`          estimated errors of a2 and a3
        `tail_rate`, `.._error`         A of the tail exp(−A c^q), q as of `tail_slope`, from K; cooling
                                        Maxwell molecules: s of the tail c^−s
        `far_slope`, `.._error`         `tail_slope` at `far_speed`, the largest speed at which the last
                                        two grids agree on it
        ==============================  ===================================================

    Raises
    ------
    ValueError
        For a scene without such a state.
    """
    check_state(scene, Solver(N=LADDER[0][0], R=1.0, method="radial"), state == "heated")
    unit = _unit(scene)
    states, grids = list[xr.Dataset](), list[Found]()
    exact = None
    for N, R in LADDER:
        solver = Solver(N=N, R=R * unit, method="radial", threads=threads)
        states.append(FIND[state](scene, solver, tolerance, max_iterations, progress))
        if has_exact_moments(scene):
            exact = ExactState.of(scene, state, states[-1])
        grids.append(measured(states) if exact is None else exact.on_grid(states[-1]))
        enough = grids[-1].off(asked) <= 1.0 or (exact is not None and N >= EXACT_UP_TO)
        if (enough and len(grids) >= FEWEST) or round_off_beyond(states[-1], R) > asked.a2:
            break
    if exact is None and grids[-1].off(asked) > 1.0:  # round-off may be larger than what R gains
        best = min(range(len(grids)), key=lambda i: grids[i].off(asked))
        grids = grids[: best + 1]
    answer = grids[-1] if exact is None else exact.in_place(states[-1])
    return described(scene, asked, state, answer, grids, unit)


def _unit(scene: Scene) -> float:
    """√T of the scene's initial density."""
    stated = scene.moments
    if stated is None:
        raise ValueError(
            f"initial={scene.initial!r}: must state its moments for an accuracy; give a solver, or a named "
            "density"
        )
    return float(np.sqrt(stated.temperature))
