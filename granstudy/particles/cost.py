"""Cost of a simulation by particles; its collisions are counted before it runs."""

import math
from dataclasses import dataclass

import numpy as np
import scipy
from scipy.special import gamma

from granstudy.collision.choice.cost import INTERPRETER_MB, Cost
from granstudy.model.kernel import VHS
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.particles.batch import COLLISIONS_A_STEP, HEATING_SPLIT
from granstudy.support.checks import LARGEST
from granstudy.support.machine import check_memory
from granstudy.theory import gaussian_cooling_coefficient
from granstudy.velocity.sphere import sphere_area

SECONDS_PER_COLLISION = {"maxwell": 5.5e-8, "hard spheres": 1.9e-7, "between": 4.0e-7}
"""Seconds of a collision and its rejected candidates on one core of a 2021 server, by kind of kernel. Between
Maxwell molecules and hard spheres, |g|^λ takes a power for each candidate."""

CACHED_PARTICLES = 100_000
"""Most particles of a batch that a core's cache holds."""

OUT_OF_CACHE = 3.0
"""Time of a collision in a larger batch, over its time in a cached one: pairs lie anywhere in memory."""

SETUP_SECONDS = 0.05
"""Seconds of the majorants of the initial density."""

SECONDS_PER_DRAW = 6.0e-7
"""Seconds of drawing one particle from the initial density, accepted or not."""

SECONDS_PER_KICK = 1.0e-7
"""Seconds of heating one particle once."""

SECONDS_PER_RECORD = 1.0e-8
"""Seconds of one particle in the moments of one record."""

SECONDS_PER_CALL = 5.0e-5
"""Seconds of one record of one batch, whatever its size."""

LOG_COLDEST = -600.0
"""Logarithm of the temperature below which a gas counts no colder: its powers would underflow."""

MOST_COLLISIONS = 10**14
"""Collisions that a run makes at most: some months on one core."""

EFFICIENCY = 0.9
"""Speed that each thread after the first adds, in parts of the first: batches share memory only."""


@dataclass(frozen=True)
class Expected:
    """Expected collisions and heating steps of one particle, on average."""

    collisions: float
    heating_steps: float


def particle_cost(
    scene: Scene, solver: SizedSolver, t_final: float, records: int
) -> tuple[Cost, int]:
    """Cost of a run on one thread, and the number of collisions expected in it.

    Parameters
    ----------
    scene : Scene
    solver : SizedSolver
        Solver of method `dsmc`.
    t_final : float
    records : int
        Number of recorded times.
    """
    assert solver.particles is not None
    expected = expect(scene, solver, t_final)
    n = solver.particles
    collisions = math.ceil(n * expected.collisions / 2)
    seconds = collisions * _seconds_per_collision(scene.kernel, n // solver.batches)
    seconds += n * expected.heating_steps * SECONDS_PER_KICK
    seconds += records * (n * SECONDS_PER_RECORD + solver.batches * SECONDS_PER_CALL)
    memory = INTERPRETER_MB + math.ceil(particle_bytes(scene, solver) / 2**20)
    return Cost(SETUP_SECONDS + n * SECONDS_PER_DRAW, seconds, 1, memory), collisions


def particle_bytes(scene: Scene, solver: SizedSolver) -> float:
    """Bytes of a run: on each thread a batch and what it was drawn from; and the majorants of all cells."""
    assert solver.particles is not None
    at_once = min(solver.thread_count, solver.batches)
    points = (solver.N + 1) ** scene.dim
    return 160.0 * min(solver.particles * at_once // solver.batches + points, LARGEST)


def check_particles(scene: Scene, solver: SizedSolver, t_final: float) -> None:
    """Raise ValueError, before any work, for particles that memory cannot hold, or a run without end."""
    check_memory(
        f"particles={solver.particles}, batches={solver.batches}, N={solver.N}",
        particle_bytes(scene, solver),
        "take fewer particles, more batches, or a smaller N",
    )
    assert solver.particles is not None
    expected = solver.particles * expect(scene, solver, t_final).collisions / 2
    if expected > MOST_COLLISIONS:
        raise ValueError(
            f"t_final={t_final!r}, particles={solver.particles}: the run would take {expected:.1e} "
            f"collisions, and {MOST_COLLISIONS:.0e} is the most; take a shorter time, or a method on a grid"
        )


def expect(scene: Scene, solver: Solver, t_final: float) -> Expected:
    """Integrate dT/dt = 2ε − ρK T^{1+λ/2}, K of a Gaussian, and the collision rate along T(t).

    A restitution law counts by its e at the impact speed √T.
    """
    grid = solver.grid(scene.dim)
    start = grid.velocity_moments(scene.density(grid))
    T0 = float(np.trace(start.pressure)) / (scene.dim * start.density)
    rate = start.density * sphere_area(scene.dim) * scene.kernel.strength
    lam, d, eps = scene.kernel.exponent, scene.dim, float(scene.diffusion)

    def rates(t: float, y: np.ndarray) -> list[float]:
        T = math.exp(max(y[0], LOG_COLDEST))
        e = scene.restitution
        e = float(np.asarray(e(np.array([math.sqrt(T)])))[0]) if callable(e) else float(e)
        K = start.density * gaussian_cooling_coefficient(scene.kernel, e, d)
        nu = rate * (2.0 * math.sqrt(T)) ** lam * gamma((d + lam) / 2) / gamma(d / 2)
        split = math.sqrt(2.0 * eps * nu / (HEATING_SPLIT * T))
        steps = max(split, nu / COLLISIONS_A_STEP) if eps else 0.0
        return [2.0 * eps / T - K * T ** (lam / 2), nu, steps]

    start_values = [math.log(T0), 0.0, 0.0]
    run = scipy.integrate.solve_ivp(rates, (0.0, t_final), start_values, "LSODA", rtol=1e-3)
    end = run.y[:, -1]
    return Expected(collisions=float(end[1]), heating_steps=float(end[2]))


def _seconds_per_collision(kernel: VHS, n: int) -> float:
    """Seconds of a collision in a batch of n particles."""
    kind = {0.0: "maxwell", 1.0: "hard spheres"}.get(kernel.exponent, "between")
    return SECONDS_PER_COLLISION[kind] * (OUT_OF_CACHE if n > CACHED_PARTICLES else 1.0)
