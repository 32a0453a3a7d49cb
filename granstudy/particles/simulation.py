"""Independent batches of particles, their means and standard errors (docs/particles.md §3)."""

from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, ThreadPoolExecutor, wait
from dataclasses import replace
from threading import Lock

import numpy as np
import xarray as xr

from granstudy.datasets.run_dataset import Ending, Header
from granstudy.datasets.storage.checkpoint import Checkpoint
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.particles.batch import Batch, Gas, HardImpactError, history
from granstudy.particles.dataset import particle_dataset, standard_error
from granstudy.particles.sampling import Sampler, quiet
from granstudy.particles.snapshot import BatchRecord, BatchSnapshots
from granstudy.support.progress import PAUSE, Progress, watched
from granstudy.trust.flags import Status
from granstudy.trust.initial_errors import errors_of, integrated, true_start
from granstudy.velocity.cartesian import VelocityGrid

LEAST_TEMPERATURE = 1e-150
"""Temperature below which a gas is at rest: fourth powers of velocities underflow."""


class _Reached:
    """How far the batches of a run have come, which advance in threads of their own."""

    def __init__(self, times: np.ndarray, batches: int) -> None:
        self._batches = batches
        self._step = dict(zip(times.tolist(), np.diff(times, prepend=0.0).tolist(), strict=True))
        self._lock = Lock()
        self._stopped = False
        self._sum = 0.0
        self.records = 0

    def add(self, time: float) -> None:
        """Note that a batch has reached the next time.

        Raises
        ------
        CancelledError
            If the run was stopped.
        """
        if self._stopped:
            raise CancelledError
        with self._lock:
            self.records += 1
            self._sum += self._step[float(time)]

    @property
    def mean_time(self) -> float:
        """Time reached, the mean of all batches."""
        return self._sum / self._batches

    def stop(self, batches: Sequence[Future[BatchRecord]]) -> None:
        """Let batches end at their next record, and none begin."""
        self._stopped = True
        for batch in batches:
            batch.cancel()


def simulate_particles(
    scene: Scene,
    solver: Solver,
    times: Sequence[float] | np.ndarray,
    save_every: int | None = None,
    progress: Progress = None,
    checkpoint: Checkpoint | None = None,
) -> xr.Dataset:
    """Simulate a scene by particles, and record its moments at any increasing times.

    Parameters
    ----------
    scene : Scene
    solver : Solver
        Solver of method ``dsmc``, with ``particles``, ``batches`` and ``seed``. N and R give the cells and
        the box that velocities are drawn on. The result does not depend on ``threads``.
    times : array_like, shape (n,)
        Times of the records, increasing from 0 or later. Any distance will do: collisions have no time step,
        and heating chooses its own.
    save_every : int, optional
        Keep the density, counted in the cells of the grid, at the first time, at every ``save_every``-th
        after it, and at the last. Default: no density is kept.
    progress : bool or callable, optional
        As of `granstudy.simulate`.
    checkpoint : Checkpoint, optional
        From which the run goes on where it is there, and which is written while it goes on. Whoever asked
        for the run removes it.

    Returns
    -------
    xarray.Dataset
        The dataset of `granstudy.simulate`, with `<name>_standard_error` beside each moment: the standard
        deviation over batches, divided by √batches.

    Raises
    ------
    ValueError
        For a bad scene, solver or time, before any work starts; and for a run that ends before the first of
        its times.
    """
    if not solver.traits.by_particles:
        raise ValueError(f"method={solver.method!r}: simulate_particles needs method 'dsmc'")
    solver = solver.sized()
    times = _checked_times(times)
    assert solver.particles is not None
    grid = solver.grid(scene.dim)
    density, velocity, pressure = _start(scene, grid)
    gas = Gas.of(scene, solver.R, density, velocity)
    sampler = Sampler(scene, grid)
    n = solver.particles // solver.batches
    kept = _kept(times, save_every)
    reached = _Reached(times, solver.batches)
    snapshots = BatchSnapshots(checkpoint)

    def run(number: int, rng: np.random.Generator) -> BatchRecord:
        record = snapshots.record(number)
        for time in times[: len(record.moments)]:
            reached.add(time)
        left = times[len(record.moments) :]
        if record.reason or not left.size:
            return record
        batch = snapshots.batch(number, gas, rng)
        if batch is None:
            batch = Batch(gas, quiet(sampler.draw(n, rng), pressure / density), rng)
        start = times[-len(left) - 1] if record.moments else 0.0
        try:
            for time, values in zip(left, history(batch, left, start), strict=True):
                record.moments.append(values)
                if time in kept:
                    record.counts[time] = batch.cell_counts(grid.N, grid.L)
                reached.add(time)
                snapshots.offer(number, batch, record, ended=time == times[-1])
        except HardImpactError as error:
            record = replace(record, reason=str(error))
            snapshots.offer(number, batch, record, ended=True)
        return record

    streams = np.random.SeedSequence(solver.seed).spawn(solver.batches)
    with (
        watched(progress, solver.batches * len(times)) as report,
        ThreadPoolExecutor(min(solver.thread_count, solver.batches)) as pool,
    ):
        batches = [pool.submit(run, *one) for one in enumerate(map(np.random.default_rng, streams))]
        pending = set(batches)
        try:
            while pending:
                done, pending = wait(pending, timeout=PAUSE, return_when=FIRST_COMPLETED)
                snapshots.write()
                for batch in done:
                    batch.result()  # raises the error of the batch
                report(reached.records, reached.mean_time)
        except BaseException:
            reached.stop(batches)
            raise
        records = [batch.result() for batch in batches]
    return _dataset(scene, solver, grid, gas, times, records)


def _start(scene: Scene, grid: VelocityGrid) -> tuple[float, np.ndarray, np.ndarray]:
    """ρ, u and pressure tensor at the start: as the density states them, else by the grid's sums."""
    if scene.moments is not None:
        return scene.moments.density, scene.moments.velocity, scene.moments.pressure
    start = grid.velocity_moments(scene.density(grid))
    return start.density, start.momentum / start.density, start.pressure


def _checked_times(times: Sequence[float] | np.ndarray) -> np.ndarray:
    """The times as an array; ValueError unless they are finite, at least 0, and increase."""
    checked = np.asarray(times, dtype=float)
    increasing = checked.ndim == 1 and checked.size > 0 and bool(np.all(np.diff(checked) > 0.0))
    if not (increasing and checked[0] >= 0.0 and np.isfinite(checked[-1])):
        raise ValueError(f"times={times!r}: must be increasing finite numbers of at least 0")
    return checked


def _kept(times: np.ndarray, save_every: int | None) -> set[float]:
    """Times at which the density is kept."""
    return set() if save_every is None else {*times[::save_every].tolist(), float(times[-1])}


def _dataset(
    scene: Scene,
    solver: Solver,
    grid: VelocityGrid,
    gas: Gas,
    times: np.ndarray,
    records: list[BatchRecord],
) -> xr.Dataset:
    """Dataset of all batches together, up to the time that all of them reached."""
    by_batch, reason = _common_moments(times, records)
    reached = times[: by_batch["temperature"].shape[1]]
    assert solver.particles is not None
    per_particle = gas.density / (solver.particles * grid.cell)
    snapshots = {
        time: per_particle * np.sum([record.counts[time] for record in records], axis=0)
        for time in records[0].counts
        if time in reached
    }
    bias = expected_bias(scene.dim, solver)
    warnings = bias_warning(by_batch["a2"][:, reached > 0.0], bias)
    ending = Ending(Status.DIVERGED if reason else Status.OK, reason, warnings)
    cut = errors_of(integrated(scene, grid, beyond=False), true_start(scene, grid)).a2
    health = batch_health(by_batch["temperature"], by_batch["a2"], bias, cut)
    header = Header("particles", scene, solver)
    return particle_dataset(header, grid, reached, by_batch, snapshots, health, ending)


def _common_moments(
    times: np.ndarray, records: list[BatchRecord]
) -> tuple[dict[str, np.ndarray], str]:
    """Moments in every batch, shape (batches, times, ...), up to the last time that all reached.

    Also returned is the reason of an early end, "" where there is none. A gas at rest counts as an end.

    Raises
    ------
    ValueError
        If the end comes before the first time.
    """
    count = min(len(record.moments) for record in records)
    reason = next((r.reason for r in records if r.reason and len(r.moments) == count), "")
    by_batch = {
        name: np.array([[values[name] for values in r.moments[:count]] for r in records])
        for name in (records[0].moments[0] if count else ())
    }
    if count:
        at_rest = np.flatnonzero(by_batch["temperature"].min(axis=0) < LEAST_TEMPERATURE)
        if at_rest.size:
            count = int(at_rest[0])
            reason = f"the temperature fell below {LEAST_TEMPERATURE:g}: the gas is at rest"
    if reason:
        reason = f"t = {times[count]:g}: {reason}"
    if count == 0:
        raise ValueError(f"{reason}; nothing was recorded before")
    return {name: values[:, :count] for name, values in by_batch.items()}, reason


def batch_health(T: np.ndarray, a2: np.ndarray, bias: float, cut: float) -> list[dict[str, float]]:
    """Signs of health at each time, by the names of `granstudy.trust.health.SIGNS`.

    With many batches, an error exceeds two standard errors about one time in twenty. What the box cuts off
    the initial density changes a2 by ``cut`` from the start on; T is exact at the start.

    Parameters
    ----------
    T, a2 : ndarray, shape (batches, times)
    bias : float
        Expected bias of a2.
    cut : float
        Error of a2 at the start by the part of the density that lies beyond the box.
    """
    T_noise = 2.0 * standard_error(T) / T.mean(axis=0)
    a2_noise = 2.0 * standard_error(a2) + cut
    return [
        {
            "temperature_noise": float(T_error),
            "a2_noise": float(a2_error),
            "a2_cut": cut,
            "a2_bias": bias,
        }
        for T_error, a2_error in zip(T_noise, a2_noise, strict=True)
    ]


def expected_bias(dim: int, solver: Solver) -> float:
    """Expected size of the bias of a2: 2/(dn), n the particles of a batch (docs/particles.md §3)."""
    assert solver.particles is not None
    return 2.0 * solver.batches / (dim * solver.particles)


def bias_warning(a2: np.ndarray, bias: float) -> list[str]:
    """A warning where the bias of a2 is above its standard error."""
    error = standard_error(a2)
    if not np.any(error < bias):
        return []
    return [
        f"a2 has a bias of about {bias:.1e} from the finite number of particles in a batch, above its "
        f"standard error {np.min(error):.1e}: take fewer batches or more particles"
    ]
