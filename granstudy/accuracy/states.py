"""Cooling and heated states to an accuracy: the grid is raised until the answer no longer changes."""

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.dataset import trust_as_asked
from granstudy.accuracy.simulate import Asked, accuracy_asked
from granstudy.datasets.parameters import parameter
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.states.solve import FIND, check_state
from granstudy.support.machine import one_blas_thread
from granstudy.support.progress import Progress
from granstudy.trust.flags import Status

LADDER = (
    (20, 8.0),
    (24, 9.5),
    (32, 11.0),
    (40, 13.0),
    (48, 15.0),
    (64, 19.0),
    (80, 24.0),
    (96, 28.0),
)
"""Speeds, and R in units of √T, of the grids that are tried."""

SAFETY = 2.0
"""Factor on the change from one grid to the next."""

BALANCED = 3.0
"""Factor by which the error of a2 is below that of the balance of a state, at least (docs/states.md §2)."""

SLOW = 0.5
"""Ratio of a change to the one before, above which changes are taken to go on as a geometric series."""


@dataclass(frozen=True)
class Found:
    """A state on one grid: relative errors of K and of T, and errors of a2 and a3, by the grid before."""

    ds: xr.Dataset
    temperature: float
    a2: float
    a3: float

    def off(self, asked: Accuracy) -> float:
        """The larger error over the one asked for."""
        return max(self.temperature / asked.temperature, self.a2 / asked.a2)


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
    """A state on the first grid of `LADDER` that agrees with the one before to the accuracy.

    Returns
    -------
    xarray.Dataset
        As of `granstudy.cooling_state`, with three variables more, and attributes as of a run to an accuracy
        (`asked`, `reached`, ``choices``, `needed`):

        ==============================  ===================================================
        `cooling_coefficient_error`     estimated error of K (and of T, heated), relative
        `a2_error`, `a3_error`          estimated errors of a2 and a3
        ==============================  ===================================================

    Raises
    ------
    ValueError
        For a scene without such a state.
    """
    check_state(scene, Solver(N=LADDER[0][0], R=1.0, method="radial"), state == "heated")
    unit = _unit(scene)
    found: list[Found] = []
    for N, R in LADDER:
        solver = Solver(N=N, R=R * unit, method="radial", threads=threads)
        ds = FIND[state](scene, solver, tolerance, max_iterations, progress)
        found.append(_measured(ds, found))
        if found[-1].off(asked) <= 1.0:
            break
    return _described(scene, asked, state, found)


def _unit(scene: Scene) -> float:
    """√T of the scene's initial density."""
    stated = scene.moments
    if stated is None:
        raise ValueError(
            f"initial={scene.initial!r}: must state its moments for an accuracy; give a solver, or a named "
            "density"
        )
    return float(np.sqrt(stated.temperature))


def _measured(ds: xr.Dataset, before: list[Found]) -> Found:
    """A state's errors by the change from the grid before; 1 without one, or where no state was found."""
    if not before or int(ds["status"]) != Status.OK or int(before[-1].ds["status"]) != Status.OK:
        return Found(ds, 1.0, 1.0, 1.0)
    last = before[-1]

    def error(name: str, of_before: float, relative: bool = False) -> float:
        change = abs(float(ds[name]) - float(last.ds[name]))
        if relative:
            change /= abs(float(ds[name]))
        ratio = SAFETY * change / of_before if 0.0 < of_before < 1.0 else 0.0
        if SLOW < ratio < 1.0:
            return SAFETY * change * ratio / (1.0 - ratio)
        return SAFETY * change if ratio < 1.0 else 1.0

    coefficient = error("cooling_coefficient", last.temperature, relative=True)
    temperature = error("temperature", last.temperature, relative=True)
    a2 = max(error("a2", last.a2), float(ds["a2_error_estimate"]) / BALANCED)
    return Found(ds, max(coefficient, temperature), a2, error("a3", last.a3))


def _described(scene: Scene, asked: Accuracy, state: str, found: list[Found]) -> xr.Dataset:
    """The last state, with its errors and what was tried."""
    last = found[-1]
    errors = {
        "cooling_coefficient_error": (last.temperature, "estimated relative error of K and T"),
        "a2_error": (last.a2, "estimated error of a2"),
        "a3_error": (last.a3, "estimated error of a3"),
    }
    ds = last.ds.assign(
        {
            name: ((), value, {"long_name": text, "units": "1"})
            for name, (value, text) in errors.items()
        }
    )
    ds = ds.assign_coords(
        {
            name: ((), value, parameter(name).attributes)
            for name, value in asked.coordinates().items()
        }
    )
    choices = [
        {
            "N": int(one.ds["N"]),
            "R": float(one.ds["R"]),
            "a2": float(one.ds["a2"]),
            "error": one.a2,
        }
        for one in found
    ]
    reached = {"temperature": last.temperature, "a2": last.a2}
    attrs = {
        "asked": json.dumps(asked.describe(), sort_keys=True),
        "reached": json.dumps(reached, sort_keys=True),
        "choices": json.dumps(choices, sort_keys=True),
    }
    off = last.off(asked)
    if off > 1.0:
        attrs["needed"] = _missing(scene, asked, state, last)
    status = Status(int(ds["status"]))
    ds["trust"] = trust_as_asked(off, status, attrs.get("needed", ""))
    return ds.assign_attrs(attrs)


def _missing(scene: Scene, asked: Accuracy, state: str, last: Found) -> str:
    """Why a state missed its accuracy."""
    N, R = LADDER[-1]
    text = (
        f"K and T were asked to {asked.temperature:.1e} and reached to {last.temperature:.1e}, a2 to "
        f"{asked.a2:.1e} and {last.a2:.1e}, with N={N} and R={R:g} √T"
    )
    if state == "cooling" and scene.kernel.exponent == 0.0:
        assert not callable(scene.restitution)
        tail = theory.maxwell_tail_exponent(float(scene.restitution), scene.dim)
        if tail <= scene.dim + 4:
            return f"{text}; the tail falls like c^−{tail:.3g}, so that a2 does not exist"
        return f"{text}; the tail falls like c^−{tail:.3g}, and a larger R gains slowly"
    return text
