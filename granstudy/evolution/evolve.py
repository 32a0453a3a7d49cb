"""Time integration of ∂t f = Q(f,f) + ε Δv f (docs/method.md §3 and §5)."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from typing import Any

import numpy as np
import xarray as xr
from tqdm import tqdm

from granstudy.collision import CollisionOperator, collision_operator, concrete
from granstudy.collision.fast.adaptive.retuning import Tuning
from granstudy.evolution.conservation import projection
from granstudy.evolution.dataset import evolution_dataset
from granstudy.evolution.frames.fixed import FixedFrame
from granstudy.evolution.frames.rescaled import RescaledFrame, centred
from granstudy.evolution.frames.scaled_collisions import scaled_collisions
from granstudy.evolution.schemes import SCHEMES
from granstudy.evolution.stability import largest_frequency, stability_limit, step_warning
from granstudy.evolution.steps import AdaptiveSteps, FixedSteps, StoppedError
from granstudy.evolution.times import TimeSettings, check_frame
from granstudy.evolution.unknowns import collisions, representation
from granstudy.model.restitution import Restitution, ScaledRestitution
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.trust import health
from granstudy.trust.error_estimate import Examination
from granstudy.trust.flags import Status
from granstudy.trust.pair_rates import RatesAt
from granstudy.velocity.moments import moment_values

Moments = dict[str, Any]


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
    settings = TimeSettings(
        t_final, dt, time_rtol, times, frame, scheme, conserve, save_every  # type: ignore[arg-type]
    )  # fmt: skip
    check_frame(scene, solver, settings)
    if solver.method == "dsmc":
        return _simulate_particles(scene, solver, settings, progress)
    choice = concrete(scene, solver)
    solver = choice.solver
    run = _prepare(scene, solver, settings)
    grid, equation, steps = run.operator.grid, run.equation, run.steps

    tuning = Tuning(run.operator)
    examination = Examination(scene, grid, steps.outputs, run.rates)
    found: dict[str, str] = {}
    times_reached: list[float] = []
    history: list[Moments] = []
    snapshots: dict[float, np.ndarray] = {}
    status, reason = Status.OK, ""
    hidden = None if progress is None else not progress
    # Overflow and NaN are looked for below, in one place.
    with (
        np.errstate(over="ignore", invalid="ignore", divide="ignore"),
        tqdm(total=steps.outputs, disable=hidden) as bar,
    ):
        try:
            for step, time, state, is_output in steps.march(run.start):
                f = equation.density(state)
                values = moment_values(f, grid)
                failed = health.failure(values)
                if failed:
                    raise StoppedError(step, time, failed)
                plans = len(tuning.plans)
                texts = tuning.review(step, time, f)
                if len(tuning.plans) > plans:
                    steps.equation_changed()
                if is_output:
                    if save_every is not None and (
                        len(history) % save_every == 0 or len(history) == steps.outputs - 1
                    ):
                        snapshots[time] = f.copy()
                    times_reached.append(time)
                    history.append(equation.record(values, state))
                    texts |= examination.look(
                        f,
                        values,
                        equation.clock(state, time),
                        partial(equation.collisions, state),
                        restitution=_restitution(scene, history[-1]),
                        heating=_heating(scene, equation.diffusivity(state), history[-1], values),
                        steps_of_order_3=settings.dt is not None,
                    )
                    texts |= _step_health(scene, settings, run, state, history, examination)
                    bar.update()
                for name, text in texts.items():
                    found.setdefault(name, f"from t = {time:g}: {text}")
        except StoppedError as stopped:
            status, reason = Status.DIVERGED, str(stopped)
    ds = evolution_dataset(
        scene, solver, settings, grid, times_reached, history, snapshots, status, reason,
        list(found.values()), tuning.plans, examination.outputs,
    )  # fmt: skip
    if isinstance(steps, AdaptiveSteps):
        ds.attrs["steps"] = json.dumps(steps.describe())
    return ds.assign_attrs(choice.attributes())


def _simulate_particles(
    scene: Scene, solver: Solver, settings: TimeSettings, progress: bool | None
) -> xr.Dataset:
    # Imported here, as the code of particles is no part of other runs.
    particles = import_module("granstudy.particles.simulation")
    check_frame(scene, solver, settings)
    times = settings.recorded
    ds: xr.Dataset = particles.simulate_particles(
        scene, solver, times, settings.save_every, progress
    )
    return ds if settings.dt is None else ds.assign_coords(dt=settings.dt)


@dataclass(frozen=True)
class _Prepared:
    """All that is known before the first step."""

    operator: CollisionOperator
    rates: RatesAt
    equation: FixedFrame | RescaledFrame
    steps: FixedSteps | AdaptiveSteps
    start: np.ndarray


def _prepare(scene: Scene, solver: Solver, settings: TimeSettings) -> _Prepared:
    velocity = np.zeros(scene.dim)
    if settings.frame == "rescaled" and solver.method != "radial":
        scene, velocity = centred(scene, solver)
    operator = collision_operator(scene, solver)
    form = representation(operator, scene.symmetry)

    rates = RatesAt(scene, form.grid)
    project = projection(form, settings.conserve, energy_rate(rates, scene, settings))
    Q = collisions(operator)
    equation: FixedFrame | RescaledFrame
    if settings.frame == "fixed":
        equation = FixedFrame(form, lambda f: project(f, Q(f)), scene.diffusion)
    else:
        Q_at = scaled_collisions(scene, solver, Q)
        equation = RescaledFrame(
            form, lambda g, scale: project(g, Q_at(g, scale)), scene.diffusion,
            scene.kernel.exponent, velocity,
        )  # fmt: skip
    made = SCHEMES[settings.scheme]
    steps: FixedSteps | AdaptiveSteps
    if settings.time_rtol is None:
        assert settings.dt is not None
        steps = FixedSteps(equation, made, settings.dt, settings.steps)
    else:
        steps = AdaptiveSteps(equation, made, settings.outputs, settings.time_rtol)
    return _Prepared(operator, rates, equation, steps, equation.start(scene.density(operator.grid)))


def energy_rate(
    rates: RatesAt, scene: Scene, settings: TimeSettings
) -> Callable[[np.ndarray], float]:
    """What collisions of all pairs change of a density's energy, where a run keeps to it."""
    if "energy" in settings.conserve and scene.restitution != 1.0:
        return rates(scene.restitution).energy
    return lambda f: 0.0


def _restitution(scene: Scene, values: Moments) -> Restitution:
    """That of the particles as the grid holds them: a law of the speed counts in the frame's."""
    if callable(scene.restitution) and "velocity_scale" in values:
        return ScaledRestitution(scene.restitution, float(values["velocity_scale"]))
    return scene.restitution


def _heating(scene: Scene, diffusivity: float, record: Moments, values: Moments) -> float:
    """2ε/T a unit of the collisions' time, of what the grid holds."""
    scale = float(record.get("velocity_scale", 1.0))
    return float(2.0 * diffusivity / (values["temperature"] * scale**scene.kernel.exponent))


def _step_health(
    scene: Scene,
    settings: TimeSettings,
    run: _Prepared,
    state: np.ndarray,
    history: list[Moments],
    examination: Examination,
) -> dict[str, str]:
    """Record a step of fixed size over what is stable; say so where it is more."""
    if settings.dt is None:
        return {}
    grid = run.operator.grid
    scales = [float(values.get("velocity_scale", 1.0)) for values in history[-2:]]
    frequency = largest_frequency(scene.kernel, scene.dim, grid.R, float(history[-1]["density"]))
    limit = stability_limit(
        settings.scheme,
        grid,
        diffusion=run.equation.diffusivity(state),
        collision_frequency=scales[-1] ** scene.kernel.exponent * frequency,
        dilation_rate=float(np.log(scales[-1] / scales[0])) / settings.dt,
    )
    examination.outputs[-1]["step_ratio"] = settings.dt / limit
    return step_warning(settings.dt, settings.scheme, limit)
