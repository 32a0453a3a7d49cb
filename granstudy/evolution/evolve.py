"""Time integration of ∂t f = Q(f,f) + ε Δv f on a grid (docs/method.md §3 and §5)."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import xarray as xr

from granstudy.collision.fast.adaptive.retuning import LONG_STEP, Tuning
from granstudy.collision.operator import collision_operator
from granstudy.collision.protocol import CollisionOperator, wisdom_attributes
from granstudy.datasets.run_dataset import Header, Record
from granstudy.datasets.storage.checkpoint import Checkpoint
from granstudy.evolution.conservation import Projection
from granstudy.evolution.dataset import evolution_dataset
from granstudy.evolution.frames.fixed import FixedFrame
from granstudy.evolution.frames.rescaled import RescaledFrame, centred
from granstudy.evolution.frames.scaled_collisions import scaled_collisions
from granstudy.evolution.schemes import SCHEMES
from granstudy.evolution.snapshot import Snapshot
from granstudy.evolution.stability import step_warning
from granstudy.evolution.steps.adaptive import AdaptiveSteps
from granstudy.evolution.steps.fixed import FixedSteps
from granstudy.evolution.steps.points import Point, StoppedError
from granstudy.evolution.times import TimeSettings
from granstudy.evolution.unknowns import collisions, representation
from granstudy.model.choice import Choice
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.support.errors import RAN_AWAY
from granstudy.support.machine import one_blas_thread
from granstudy.support.progress import Progress, watched
from granstudy.trust import health
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import NOTHING, Examination
from granstudy.trust.flags import Status
from granstudy.trust.pair_rates import RatesAt
from granstudy.velocity.moments import moment_values

Frame = FixedFrame | RescaledFrame


@one_blas_thread()
def evolve(
    scene: Scene,
    choice: Choice,
    settings: TimeSettings,
    progress: Progress = None,
    checkpoint: Checkpoint | None = None,
) -> xr.Dataset:
    """Advance the initial density of a scene on a grid; see `granstudy.simulate`.

    Parameters
    ----------
    scene : Scene
    choice : Choice
        The solver asked for, and the one chosen.
    settings : TimeSettings
    progress : bool or callable, optional
        As of `granstudy.simulate`.
    checkpoint : Checkpoint, optional
        From which the run goes on where it is there, and which is written while it goes on. Whoever asked
        for the run removes it.
    """
    kept = None if checkpoint is None else checkpoint.read()
    header = Header.of("evolution", scene, choice, settings.coordinates())
    run = _prepare(scene, choice.solver, settings)
    observer = _Observer(settings, run)
    points = _points(run, observer, kept)
    record = observer.record
    # The observer looks for overflow and NaN, in one place.
    with (
        np.errstate(over="ignore", invalid="ignore", divide="ignore"),
        watched(progress, run.steps.outputs - 1) as report,
    ):
        try:
            for point in points:
                observer.see(point)
                report(len(record.times) - 1, point.time)
                if checkpoint is not None and not point.inside and checkpoint.due():
                    checkpoint.write(observer.snapshot().plain())
        except StoppedError as stopped:
            record.status, record.reason = Status.DIVERGED, str(stopped)
    ds = evolution_dataset(header, run.operator.grid, record, settings.rescaled)
    if isinstance(run.steps, AdaptiveSteps):
        ds.attrs["steps"] = json.dumps(run.steps.describe())
    return ds.assign_attrs(wisdom_attributes(run.operator))


def _points(run: "_Prepared", observer: "_Observer", kept: Any) -> Iterator[Point]:
    """The states of a run, from the first on, or after the snapshot that a checkpoint kept."""
    if kept is None:
        return run.steps.march(run.start)
    snapshot = Snapshot.of(kept)
    observer.resume(snapshot)
    return run.steps.resume(snapshot.position)


@dataclass(frozen=True)
class _Prepared:
    """All that is made before the first step; the scene is seen from the frame's velocity."""

    scene: Scene
    operator: CollisionOperator
    rates: RatesAt
    project: Projection
    frame: Frame
    steps: FixedSteps | AdaptiveSteps
    start: np.ndarray


def _prepare(scene: Scene, solver: SizedSolver, settings: TimeSettings) -> _Prepared:
    """Make operator, exact rates, frame, steps and the first state."""
    velocity = np.zeros(scene.dim)
    if settings.rescaled and not solver.traits.radial:
        scene, velocity = centred(scene, solver)
    operator = collision_operator(scene, solver)
    form = representation(operator, scene.symmetry)
    rates = RatesAt(scene, form.grid)
    project = Projection(form, settings.conserve, _energy_rate(rates, scene, settings))
    Q = collisions(operator)
    frame: Frame
    if settings.rescaled:
        Q_at = scaled_collisions(scene, solver, Q)
        frame = RescaledFrame(form, lambda g, scale: project(g, Q_at(g, scale)), scene, velocity)
    else:
        frame = FixedFrame(form, lambda f: project(f, Q(f)), scene)
    scheme = SCHEMES[settings.scheme]
    steps: FixedSteps | AdaptiveSteps
    if settings.time_rtol is None:
        assert settings.dt is not None
        steps = FixedSteps(frame, scheme, settings.dt, settings.steps)
    else:
        steps = AdaptiveSteps(frame, scheme, settings.outputs, settings.time_rtol)
    start = frame.start(scene.density(operator.grid))
    return _Prepared(scene, operator, rates, project, frame, steps, start)


def _energy_rate(
    rates: RatesAt, scene: Scene, settings: TimeSettings
) -> Callable[[np.ndarray], float]:
    """The exact rate at which collisions change a density's energy, where a run conserves energy; else 0."""
    if "energy" in settings.conserve and scene.restitution != 1.0:
        return rates(scene.restitution).energy
    return lambda f: 0.0


class _Observer:
    """Watches a run step by step (moments, quadrature, health), and fills its record."""

    def __init__(self, settings: TimeSettings, run: _Prepared) -> None:
        self._settings = settings
        self._run = run
        self._outputs = run.steps.outputs
        self._tuning = Tuning(run.operator, LONG_STEP if run.steps.outputs_inside else 1)
        self._examination = Examination(run.scene, run.operator.grid, settings.recorded, run.rates)
        self._scale = 1.0
        self.record = Record(health=self._examination.outputs, plans=self._tuning.plans)

    def snapshot(self) -> Snapshot:
        """The run as it is after the state that was seen last."""
        return Snapshot(
            self._run.steps.position, self._examination.memory, self._scale, self.record
        )

    def resume(self, snapshot: Snapshot) -> None:
        """Go on from a snapshot."""
        self._scale, seen = snapshot.scale, snapshot.record
        self._examination.resume(snapshot.memory, seen.health)
        self._tuning.resume(seen.plans)
        # Health and plans are recorded by those who find them, in lists of theirs.
        self.record = replace(seen, health=self.record.health, plans=self.record.plans)

    def see(self, point: Point) -> None:
        """Look at the state after a step.

        Raises
        ------
        StoppedError
            If the run cannot go on from that state.
        """
        try:
            self._see(point)
        except RAN_AWAY as error:
            raise StoppedError(point.step, point.time, health.ran_away(error)) from None

    def _see(self, point: Point) -> None:
        frame, state = self._run.frame, point.state
        f = frame.density(state)
        values = moment_values(f, self._run.operator.grid)
        failed = health.failure(values)
        if failed:
            if not self.record.moments:
                self._record(point, f, frame.record(values, state))
            raise StoppedError(point.step, point.time, failed)
        passing = NOTHING
        if point.difference is not None:
            change = frame.moment_change(state, point.difference)
            self._examination.step(frame.clock(state, point.time), change.scaled(point.share))
            passing = change.scaled(point.passing)
        texts = {} if point.inside else self._step(point, f, values)
        if point.is_output:
            texts |= self._output(point, f, values, passing)
        self.record.warn(point.time, texts)

    def _step(self, point: Point, f: np.ndarray, values: dict[str, Any]) -> dict[str, str]:
        """Review the quadrature at the end of a step, and take a balance; returns warnings, by name."""
        run, state, rate = self._run, point.state, point.rate
        plans = len(self._tuning.plans)
        texts = self._tuning.review(point.step, point.time, f)
        if len(self._tuning.plans) > plans:
            run.steps.equation_changed()
            rate = None
        if self._examination.is_due(point.time):
            self._examination.balance(
                f,
                values,
                run.frame.moment_rates(state, rate),
                # that of the last Q, which belongs to the state
                run.project.energy_removed,
                restitution=run.frame.restitution(state),
                heating=run.frame.heating(state, values["temperature"]),
            )
        return texts

    def _output(
        self, point: Point, f: np.ndarray, values: dict[str, Any], passing: Change
    ) -> dict[str, str]:
        """Record and examine an output, or nothing of it; returns its warnings, by name."""
        frame, state = self._run.frame, point.state
        moments = frame.record(values, state)
        signs, texts = self._check_step(state, float(moments["density"]))
        texts |= self._examination.look(f, values, passing)
        self.record.health[-1].update(signs)
        self._record(point, f, moments)
        return texts

    def _record(self, point: Point, f: np.ndarray, moments: dict[str, Any]) -> None:
        """Record an output: its moments, and where they are asked for, the density."""
        record = self.record
        every, number = self._settings.save_every, len(record.moments)
        if every is not None and (number % every == 0 or number == self._outputs - 1):
            record.snapshots[point.time] = f.copy()
        record.times.append(point.time)
        record.moments.append(moments)

    def _check_step(
        self, state: np.ndarray, density: float
    ) -> tuple[dict[str, float], dict[str, str]]:
        """A fixed step over the largest stable one, a sign of health; and a warning where it is above 1."""
        dt, scheme, frame = self._settings.dt, self._settings.scheme, self._run.frame
        if dt is None:
            return {}, {}
        before, self._scale = self._scale, frame.scale(state)
        dilation_rate = float(np.log(self._scale / before)) / dt
        limit = frame.stable_step(scheme, state, density, dilation_rate)
        return {"step_ratio": dt / limit}, step_warning(dt, scheme, limit)
