"""The start of a run to an accuracy: what the initial density tells before any grid is chosen."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.budget import clock_left, temperature_range
from granstudy.accuracy.choices import Chooser
from granstudy.accuracy.grids.sources import Initial
from granstudy.accuracy.grids.truncation import Truncation, truncation
from granstudy.accuracy.leg import Gas
from granstudy.collision.choice.grid import whole
from granstudy.evolution.frames.rescaled import Centred
from granstudy.model.isotropy import check_isotropic
from granstudy.model.scene import Scene
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import Balance, balance_of, imbalance
from granstudy.trust.initial_errors import true_start
from granstudy.trust.pair_rates import CollisionRates
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.space import VelocitySpace

RESCALED = 1.25
"""Largest temperature over the smallest one of a run, from which on velocities are rescaled."""

PROBE_SPEEDS, PROBE_RADIUS = 48, 10.0
"""Grid on which an isotropic density is probed: its speeds, and its R in units of √T."""


class Prepared(NamedTuple):
    """The gas of a run, its chooser, and whether velocities are rescaled."""

    gas: Gas
    chooser: Chooser


def prepared(
    scene: Scene, asked: Accuracy, t_final: float, memory: float, threads: int | None
) -> Prepared:
    """What the initial density tells: bulk velocity, isotropy, rates, frame.

    Raises
    ------
    ValueError
        If no box holds the density, or it has no mass.
    """
    centred, velocity = at_rest(scene)
    isotropic = is_isotropic(centred)
    probe: VelocitySpace
    cut: Truncation | None = None
    if isotropic:
        unit = float(np.sqrt(_temperature(centred)))
        probe = RadialGrid(scene.dim, PROBE_SPEEDS, PROBE_RADIUS * unit)
        f = centred.density(probe)
    else:
        probe, f = whole(centred)
        cut = truncation(centred, probe, f)
    true = true_start(centred, probe)
    exponent = scene.kernel.exponent
    heating = 2.0 * scene.diffusion / true.temperature
    now = imbalance(CollisionRates(centred, probe), f, Change(0.0, 0.0), heating)
    cooling = max(-now.cooling, 0.0)
    changes = temperature_range(cooling, heating, exponent, t_final)
    rescaled = changes > RESCALED and not callable(scene.restitution)
    gas = Gas(centred, velocity, true.density, rescaled, threads)
    exact = balance_of(now, 0.0, 0.0, scene.restitution, scene.dim, exponent, heating)
    exact = Balance(0.0, 0.0, 0.0, *exact[3:])
    left = clock_left(cooling, heating, exponent, t_final)
    chooser = Chooser(gas, asked, Initial(gas, true), exact, cut, left, memory)
    return Prepared(gas, chooser)


def at_rest(scene: Scene) -> tuple[Scene, np.ndarray]:
    """The scene as seen from its bulk velocity u, and u; a density that does not state u is summed."""
    stated = scene.moments
    if stated is not None:
        u = np.array(stated.velocity, dtype=float)
        scale = float(np.sqrt(stated.temperature))
    else:
        grid, f = whole(scene)
        m = grid.velocity_moments(f)
        u = m.momentum / m.density
        scale = float(np.sqrt(np.trace(m.pressure) / m.density / scene.dim))
    # Round-off counts as 0, so that symmetric densities keep their digits.
    u = np.where(np.abs(u) > 1e-10 * scale, u, 0.0)
    if not u.any():
        return scene, u
    centred = replace(
        scene, initial=Centred(scene.initial, tuple(map(float, u))), symmetry=scene.symmetry
    )
    return centred, u


def is_isotropic(scene: Scene) -> bool:
    """Whether the density is isotropic about v = 0, and `radial` can model the gas."""
    if callable(scene.restitution):
        return False
    try:
        check_isotropic(scene, PROBE_RADIUS * float(np.sqrt(_temperature(scene))))
    except ValueError:
        return False
    return True


def _temperature(scene: Scene) -> float:
    """T of the initial density, as it states it, else by sums."""
    stated = scene.moments
    if stated is not None:
        return stated.temperature
    grid, f = whole(scene)
    m = grid.velocity_moments(f)
    return float(np.trace(m.pressure) / m.density / scene.dim)
