"""What a run or a state to an accuracy will begin with, and cost, before it starts.

A run chooses its grid by measuring errors, which takes tensors and quadratures, too long for a workflow that
waits. Here a coarse look at the density stands for that: how much of the fourth moment lies beyond a radius,
and how far the spectrum reaches. Constants are fits to runs of random gases (`benchmarks/prices.py`).
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy.fft

from granstudy import theory
from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.budget import temperature_range
from granstudy.accuracy.choices import FIRST_RADIUS
from granstudy.accuracy.grids.cartesian import LARGEST_RTOL, POINTS, SMALLEST_RTOL
from granstudy.accuracy.grids.radial import RADIUS_STEP, SPEEDS
from granstudy.accuracy.run import LOOSEST, STEP_TOLERANCE, TIGHTEST
from granstudy.accuracy.setup import PROBE_RADIUS, RESCALED
from granstudy.accuracy.states.ladder import LADDER
from granstudy.collision.choice.cost import Cost, estimate
from granstudy.collision.choice.method_costs import FAST, RADIAL
from granstudy.evolution.forecast import evolution_cost, expected_evaluations
from granstudy.evolution.frames.rescaled import Centred
from granstudy.evolution.stability import largest_frequency
from granstudy.evolution.times import TimeSettings
from granstudy.model.isotropy import check_isotropic
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.states.solve import solving_seconds
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.radial import RadialGrid

LARGEST_R = 1000.0
"""R beyond which the search for a box gives up."""

COARSE = {2: 64, 3: 32}
"""Points a dimension of the grid of a look, by dimension."""

EDGE = 1e-7
"""Largest |f| on the faces of its box, over max|f|."""

FINE = 200
"""Speeds that the fourth moment of an isotropic density is summed on."""

RADII = tuple(FIRST_RADIUS * RADIUS_STEP**k for k in range(-3, 15))
"""Radii that are tried, in units of √T."""

BORDER = 0.66
"""Radius of the ball that holds the density, over R."""

TAIL = {"radial": 0.03, "fast": 1.0}
"""Part of ∫f² in the upper quarter of the wavenumbers, over the accuracy of T, at most, by method."""

CUT = 1.5
"""Part of the fourth moment's exchange by pairs beyond a radius, over the accuracy of a2, at most."""

RTOL = 1.2
"""Tolerance of a quadrature, over what the errors of a2 that it makes may grow by."""

LOOK_SECONDS = {2: 0.02, 3: 0.6}
"""Seconds in which a run looks at a density without isotropy, by dimension."""

SUM_SECONDS = {2: 0.02, 3: 0.18}
"""Seconds in which it sums the moments of a density that does not state them."""

TRIED, PLANS = 3, 1.5
"""Grids on which aliasing is measured, and quadratures that are planned."""

ALIASING_NODES = {2: 80, 3: 200}
"""Nodes of the two rough rules that measure aliasing, by dimension."""

ISOTROPIC_RATE = 0.5
"""Rate at which a gas becomes isotropic, over the collision frequency."""


class Look(NamedTuple):
    """What a coarse look tells: the scene seen from its bulk velocity, T, whether `radial` can do the gas."""

    scene: Scene
    temperature: float
    isotropic: bool


class Beginning(NamedTuple):
    """What a run to an accuracy begins with, about."""

    solver: SizedSolver
    frame: str
    found: Look


def accurate_cost(
    asked: Accuracy, settings: TimeSettings, begins: Beginning, each: float | None = None
) -> Cost:
    """Cost of a run to an accuracy on one thread, by what it begins with.

    Parameters
    ----------
    each : float, optional
        Seconds of an evaluation, where the operator is known.
    """
    solver, scene = begins.solver, begins.found.scene
    tolerance = STEP_TOLERANCE * min(asked.temperature, asked.a2)
    steps = float(np.clip(tolerance, TIGHTEST, LOOSEST))
    isotropic = solver.traits.radial
    look_seconds = SUM_SECONDS[scene.dim] if scene.moments is None else 0.0
    until = settings.t_final
    if not isotropic and not callable(scene.restitution):
        until = min(until, _isotropic_from(scene, begins.found, asked))
    marched = TimeSettings(until, time_rtol=steps, frame=begins.frame)
    evaluations = expected_evaluations(scene, solver, marched)
    cost = estimate(RADIAL if isotropic else FAST, scene, solver, evaluations)
    cost = evolution_cost(
        cost if each is None else replace(cost, each=each), scene, solver, marched
    )
    if isotropic:
        tried = [replace(solver, N=N) for N in SPEEDS if N < solver.N]
        kept = [one for other in tried for one in RADIAL.kept(scene, other)]
        return replace(cost, setup=cost.setup + look_seconds, kept=(*kept, *cost.kept))
    transforms = 2 * TRIED * ALIASING_NODES[scene.dim]
    setup = FAST.seconds(scene, solver, transforms, solver.N)
    setup += look_seconds + LOOK_SECONDS[scene.dim]
    setup += (PLANS - 1.0) * FAST.setup(scene, solver, cost.each)
    return replace(cost, setup=cost.setup + setup)


def state_cost(scene: Scene, asked: Accuracy, heated: bool) -> Cost:
    """Cost of a state to an accuracy: of all grids of the ladder up to the last."""
    solvers = [
        Solver(N=N, R=R, method="radial").sized() for N, R in LADDER[: _rungs(scene, asked, heated)]
    ]
    costs = [estimate(RADIAL, scene, solver, 0) for solver in solvers]
    seconds = sum(map(solving_seconds, solvers))
    kept = tuple(one for cost in costs for one in cost.kept)
    return Cost(seconds, 0.0, 1, max(cost.memory_mb for cost in costs), kept)


def state_solver(scene: Scene, asked: Accuracy, heated: bool) -> SizedSolver:
    """The solver that a state to an accuracy ends with, about."""
    N, R = LADDER[_rungs(scene, asked, heated) - 1]
    return Solver(N=N, R=R, method="radial").sized()


def _rungs(scene: Scene, asked: Accuracy, heated: bool) -> int:
    """Grids of the ladder that a state takes, a fit: tails that fall slowly take many."""
    e, slow = _restitution(scene), 1.0 - scene.kernel.exponent
    digits = math.log10(1.0 / min(asked.temperature, asked.a2 / 10, 0.1))
    if heated:
        more = 0.5 * (digits - 3.5)
    elif slow == 1.0 and theory.maxwell_tail_exponent(e, scene.dim) <= scene.dim + 5:
        return len(LADDER)
    else:
        tail = (1.0 - e) * (1.0 + 1.5 * slow + 3.5 * slow**2)
        more = (0.45 + 0.35 * tail) * (digits - 3.0) + 0.45 * tail**2 - 0.35
    return int(np.clip(2 + round(more), 2, len(LADDER)))


def beginning(scene: Scene, asked: Accuracy, t_final: float) -> Beginning:
    """The solver and the frame that a run begins with, about."""
    found = look(scene)
    e, lam = _restitution(scene), scene.kernel.exponent
    density = 1.0 if scene.moments is None else scene.moments.density
    K = density * gaussian_rate(scene, e)
    cooling = K * found.temperature ** (lam / 2)
    heating = 2.0 * scene.diffusion / found.temperature
    changes = temperature_range(cooling, heating, lam, t_final)
    frame = "rescaled" if changes > RESCALED and not callable(scene.restitution) else "fixed"
    if found.isotropic:
        N, R = _radial(found, asked)
        return Beginning(Solver(N=N, R=R, method="radial").sized(), frame, found)
    relaxing = 0.5 * theory.a2_relaxation_rate(e, scene.dim, lam) * _frequency(scene, found)
    growth = asked.a2 * max(relaxing + 2.0 * heating, 1.0 / t_final)
    rtol = float(np.clip(RTOL * growth, SMALLEST_RTOL, LARGEST_RTOL))
    N, R = _cartesian(found, asked)
    return Beginning(Solver(N=N, R=R, rtol=rtol, method="fast").sized(), frame, found)


def gaussian_rate(scene: Scene, e: float) -> float:
    """K of dT/dt = −ρK T^{1+λ/2}, of a Gaussian."""
    return float(theory.gaussian_cooling_coefficient(scene.kernel, e, scene.dim))


def _isotropic_from(scene: Scene, found: Look, asked: Accuracy) -> float:
    """Time from which a gas without isotropy goes on as its mean over directions, about."""
    digits = math.log(1.0 / min(asked.temperature, asked.a2))
    return (1.0 + 0.5 * digits) / (ISOTROPIC_RATE * _frequency(scene, found))


def _frequency(scene: Scene, found: Look) -> float:
    """Collisions of a particle in a unit of time, of a Gaussian."""
    d, lam = scene.dim, scene.kernel.exponent
    density = 1.0 if scene.moments is None else scene.moments.density
    speed = (4.0 * found.temperature) ** (lam / 2) * math.gamma((d + lam) / 2) / math.gamma(d / 2)
    return largest_frequency(scene.kernel, d, 1.0, density) * speed


def _restitution(scene: Scene) -> float:
    law = scene.restitution
    return float(law(np.ones(1))[0]) if callable(law) else float(law)


def look(scene: Scene) -> Look:
    """What a coarse look at the initial density tells.

    Raises
    ------
    ValueError
        If no box of reasonable size holds the density.
    """
    grid, f = _coarse(scene)
    m = grid.velocity_moments(f)
    stated = scene.moments
    if stated is not None:
        velocity, temperature = np.array(stated.velocity, dtype=float), stated.temperature
    else:
        velocity = m.momentum / m.density
        temperature = float(np.trace(m.pressure) / m.density / scene.dim)
    velocity = np.where(np.abs(velocity) > 1e-6 * math.sqrt(temperature), velocity, 0.0)
    centred = scene
    if velocity.any():
        seen = Centred(scene.initial, tuple(map(float, velocity)))
        centred = replace(scene, initial=seen, symmetry=scene.symmetry)
    try:
        check_isotropic(centred, PROBE_RADIUS * math.sqrt(temperature))
    except ValueError:
        return Look(centred, temperature, False)
    return Look(centred, temperature, True)


def _coarse(scene: Scene) -> tuple[VelocityGrid, np.ndarray]:
    """A coarse grid that holds the density, and the density on it."""
    R = 4.0
    while R < LARGEST_R:
        grid = VelocityGrid(scene.dim, COARSE[scene.dim], R)
        f = scene.density(grid)
        if grid.edge(f) <= EDGE * np.max(np.abs(f)):
            return grid, f
        R *= 1.25
    raise ValueError(
        f"initial={scene.initial!r}: does not vanish within R={LARGEST_R:g}; give a solver"
    )


def _radial(found: Look, asked: Accuracy) -> tuple[int, float]:
    """Speeds and radius of an isotropic density, about."""
    scene, unit = found.scene, math.sqrt(found.temperature)
    fine = RadialGrid(scene.dim, FINE, RADII[-1] * unit)
    speeds = fine.velocities()[0]
    fourth = np.asarray(fine.measure) * scene.density(fine) * speeds**4
    beyond = np.cumsum(fourth[::-1])[::-1] / np.sum(fourth)
    R = next(
        (R * unit for R in RADII if np.interp(BORDER * R * unit, speeds, beyond) <= asked.a2),
        RADII[-1] * unit,
    )
    for N in SPEEDS:
        grid = RadialGrid(scene.dim, N, R)
        if grid.spectral_tail(scene.density(grid)) <= TAIL["radial"] * asked.temperature:
            return N, R
    return SPEEDS[-1], R


def _cartesian(found: Look, asked: Accuracy) -> tuple[int, float]:
    """Points a dimension and radius of a density without isotropy, about."""
    scene = found.scene
    grid, f = _coarse(scene)
    size = (2 * grid.N,) * grid.dim
    pairs = scipy.fft.irfftn(np.abs(scipy.fft.rfftn(f, s=size)) ** 2, s=size)
    steps = np.fft.fftfreq(2 * grid.N, 0.5 / grid.N / grid.spacing)
    distance = np.sqrt(sum(np.square(s) for s in np.meshgrid(*(steps,) * grid.dim, sparse=True)))
    fourth = np.maximum(pairs, 0.0) * distance ** (4.0 + scene.kernel.exponent)
    place = (distance / grid.spacing).astype(int).ravel()
    beyond = 1.0 - np.cumsum(np.bincount(place, weights=fourth.ravel())) / np.sum(fourth)
    R = float(grid.spacing * (1 + np.argmax(beyond <= CUT * asked.a2)))
    for N in POINTS[scene.dim]:
        there = VelocityGrid(scene.dim, N, R)
        if there.spectral_tail(scene.density(there)) <= TAIL["fast"] * asked.temperature:
            return N, R
    return POINTS[scene.dim][-1], R
