"""Time integration of ∂t f = Q(f,f) + ε Δv f (docs/method.md §3)."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
import scipy.fft
import xarray as xr
from tqdm import tqdm

from granstudy import health
from granstudy.collision import CollisionOperator, collision_operator, concrete
from granstudy.collision.operator import NotFiniteError, SpectrumOperator
from granstudy.dataset import Status, evolution_dataset
from granstudy.moments import moment_values
from granstudy.scene import Scene
from granstudy.solver import Solver
from granstudy.tuning import Tuning


def simulate(
    scene: Scene,
    solver: Solver,
    *,
    t_final: float,
    dt: float,
    save_every: int | None = None,
    progress: bool | None = None,
) -> xr.Dataset:
    """Advance a scene's initial density to ``t_final``.

    Parameters
    ----------
    t_final, dt : float
        Final time and step; ``t_final`` must be a whole number of steps. By `dsmc`, dt is the time between
        records of the moments.
    save_every : int, optional
        Keep the density every so many steps, with the first and the last; by default none is kept.
    progress : bool, optional
        Show a progress bar; by default where a person watches (a terminal).

    Returns
    -------
    xarray.Dataset
        Moments at every step over ``time``, exact laws and errors where a law is known, `status` and
        warnings (see `granstudy.dataset.evolution_dataset`). A run that cannot go on ends early
        with its status and what it had computed. Where the solver left something open, its coordinates
        and the attribute ``solver`` say what was chosen, ``choice`` why, and ``asked_solver`` what was asked.

    Raises
    ------
    ValueError
        For a bad scene, solver or time, before any work starts.
    """
    steps = step_count(t_final, dt)
    if save_every is not None and (not isinstance(save_every, int) or save_every < 1):
        raise ValueError(f"save_every={save_every!r}: must be a positive integer or None")
    if solver.method == "dsmc":
        # Imported here, as the code of particles is no part of other runs.
        particles = import_module("granstudy.particles.simulation")
        times = dt * np.arange(steps + 1)
        ds = particles.simulate_particles(scene, solver, times, save_every, progress)
        return ds.assign_coords(dt=dt)
    choice = concrete(scene, solver)
    solver = choice.solver
    operator = collision_operator(scene, solver)
    grid = operator.grid
    advance = equation(operator, scene.diffusion)
    state = advance.state(scene.density(grid))

    tuning = Tuning(operator)
    history: list[dict[str, Any]] = []
    snapshots: dict[float, np.ndarray] = {}
    found: dict[str, str] = {}
    status, reason = Status.OK, ""
    # Overflow and NaN are looked for below, in one place.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for step in tqdm(range(steps + 1), disable=None if progress is None else not progress):
            try:
                state = rk3_step(advance.rate, state, dt) if step > 0 else state
                f = advance.density(state)
                values = moment_values(f, grid)
                failed = health.failure(values)
            except NotFiniteError:
                failed = health.NOT_FINITE
            if failed:
                status = Status.DIVERGED
                reason = f"step {step}, t = {step * dt:g}: {failed}"
                break
            history.append(values)
            last = step == steps
            if save_every is not None and (step % save_every == 0 or last):
                snapshots[step * dt] = f.copy()
            density0 = history[0]["density"]
            for name, text in health.warnings(f, values, density0, grid).items():
                found.setdefault(name, f"from t = {step * dt:g}: {text}")
            for name, text in tuning.review(step, step * dt, f).items():
                found.setdefault(name, f"from t = {step * dt:g}: {text}")
    ds = evolution_dataset(
        scene, solver, grid, dt, history, snapshots, status, reason, list(found.values()),
        tuning.plans,
    )  # fmt: skip
    return ds.assign_attrs(choice.attributes())


def step_count(t_final: float, dt: float) -> int:
    """Number of steps, or ValueError where ``t_final`` is not a whole number of them."""
    for field, value in (("t_final", t_final), ("dt", dt)):
        if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
            raise ValueError(f"{field}={value!r}: must be a positive number")
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{field}={value!r}: must be a positive number")
    steps = round(t_final / dt)
    if steps < 1 or abs(steps * dt - t_final) > 1e-9 * t_final:
        raise ValueError(f"dt={dt!r}: t_final={t_final!r} must be a whole number of steps")
    return steps


@dataclass(frozen=True)
class Equation:
    """∂t f = Q(f,f) + ε Δv f for what a method advances: its ``rate``, the way from f and back."""

    rate: Callable[[np.ndarray], np.ndarray]
    state: Callable[[np.ndarray], np.ndarray]
    density: Callable[[np.ndarray], np.ndarray]


def equation(operator: CollisionOperator, diffusion: float) -> Equation:
    """Advance f, or f̂ where the operator says so; the diffusion costs nothing at ε = 0.

    It is exact in the space of the method's modes, for f̂ by the multiplier −(π|k|/L)² (docs/method.md §3).
    """
    if isinstance(operator, SpectrumOperator):
        grid, spectrum = operator.grid, operator.spectrum
        multiplier = -diffusion * (np.pi / grid.L) ** 2 * grid.wavenumber_squared()
        return Equation(
            rate=(lambda f_hat: spectrum(f_hat) + multiplier * f_hat) if diffusion else spectrum,
            state=lambda f: scipy.fft.fftn(f, norm="forward"),
            density=lambda f_hat: scipy.fft.ifftn(f_hat, norm="forward").real,
        )

    laplacian = operator.grid.laplacian

    def heated(f: np.ndarray) -> np.ndarray:
        return operator(f) + diffusion * laplacian(f)

    def same(f: np.ndarray) -> np.ndarray:
        return f

    return Equation(rate=heated if diffusion else operator, state=same, density=same)


def rk3_step(rhs: Callable[[np.ndarray], np.ndarray], f: np.ndarray, dt: float) -> np.ndarray:
    """One step of Kutta's third-order scheme (paper eq. 48)."""
    k1 = rhs(f)
    k2 = rhs(f + dt / 2 * k1)
    k3 = rhs(f - dt * k1 + 2 * dt * k2)
    return f + dt / 6 * (k1 + 4 * k2 + k3)
