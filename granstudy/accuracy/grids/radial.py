"""The grid of an isotropic gas: the fewest speeds, and the radius, whose imbalance is allowed.

The tensor of `radial` serves every R, and there is no quadrature to plan: so the imbalance of a grid is not
predicted but measured, in milliseconds.
"""

from collections.abc import Iterator

from granstudy.accuracy.grids.sources import Present, Source
from granstudy.accuracy.leg import Gas, Need, Tried, make_leg
from granstudy.evolution.frames.rescaled import Place
from granstudy.model.solver import Solver
from granstudy.velocity.radial import RadialGrid

SPEEDS = (16, 20, 24, 28, 32, 40, 48, 64, 80, 96)
"""Numbers of speeds that are tried; few, so that runs share tensors."""

RADIUS_STEP = 1.12
"""Factor between radii that are tried."""

RADII_TRIED = 6
"""Most radii that are tried with a number of speeds."""

DEAR = 64
"""Speeds from which on a tensor takes seconds: tried only where fewer do not do."""

GAIN = 0.7
"""Growth of errors over that on a grid with fewer speeds, above which more speeds gain nothing."""

OUTWARDS = 3
"""Numbers of speeds that are tried with the present ones kept."""

UNRESOLVED = 3e-2
"""Part of ∫f² in the upper quarter of the modes above which speeds are too few to try."""


def radial_grid(
    gas: Gas, source: Source, place: Place, need: Need, radius: float, target: float
) -> Tried:
    """The fewest speeds with a radius at which errors grow by ``target`` of what is allowed.

    Where no number of speeds does, the grid with the least growth.

    Parameters
    ----------
    radius : float
        Radius to start the search from.
    """
    best: Tried | None = None
    in_vain = 0
    for N in SPEEDS:
        if _unresolved(source, RadialGrid(gas.scene.dim, N, radius)):
            continue
        if best is not None and (in_vain == 2 or (N >= DEAR and best.ratio <= 1.0)):
            break
        found = _best_radius(gas, source, place, need, N, radius, target)
        radius = found.leg.solver.R
        in_vain = in_vain + 1 if best is not None and found.ratio > GAIN * best.ratio else 0
        if best is None or found.ratio < best.ratio:
            best = found
        if best.ratio <= target:
            break
    if best is None:
        best = try_radial(gas, source, place, need, SPEEDS[-1], radius)
    return best


def further_out(gas: Gas, source: Present, place: Place, need: Need, target: float) -> Tried | None:
    """A grid with the present speeds and more beyond, the fewest with ``target``; None where none gains.

    Nothing is interpolated: the speeds stay where they are.
    """
    grid = source.grid
    assert isinstance(grid, RadialGrid)
    best: Tried | None = None
    for N in [N for N in SPEEDS if N > grid.N][:OUTWARDS]:
        tried = try_radial(gas, source, place, need, N, extended_radius(grid, N))
        if best is not None and tried.ratio > GAIN * best.ratio:
            break
        best = tried
        if best.ratio <= target:
            break
    return best


def extended_radius(grid: RadialGrid, N: int) -> float:
    """R of the grid that has N speeds, the first of which are those of another grid."""
    unit = RadialGrid(grid.dim, N, 1.0)
    return float(grid.nodes[0] / unit.nodes[0])


def try_radial(gas: Gas, source: Source, place: Place, need: Need, N: int, R: float) -> Tried:
    """Measure the growth of errors on a grid of N speeds."""
    leg = make_leg(gas, Solver(N=N, R=R, method="radial", threads=gas.threads))
    f = source.on(leg.grid)
    balance = leg.balance(leg.start(f, place))
    return Tried(leg, f, need.ratio(balance, source.lost(leg.grid)), balance)


def _best_radius(
    gas: Gas,
    source: Source,
    place: Place,
    need: Need,
    N: int,
    radius: float,
    target: float,
) -> Tried:
    """The radius with the least growth of errors, or the first below the target; outwards, then inwards."""
    best = try_radial(gas, source, place, need, N, radius)
    for radii in (_steps(radius, RADIUS_STEP), _steps(radius, 1.0 / RADIUS_STEP)):
        improved = False
        for R in radii:
            if best.ratio <= target:
                return best
            tried = try_radial(gas, source, place, need, N, R)
            if not tried.ratio < best.ratio:
                break
            best, improved = tried, True
        if improved:
            break
    return best


def _steps(radius: float, factor: float) -> Iterator[float]:
    for k in range(1, RADII_TRIED):
        yield radius * factor**k


def _unresolved(source: Source, grid: RadialGrid) -> bool:
    """Whether the density has much in the last modes of a grid."""
    return grid.spectral_tail(source.on(grid)) > UNRESOLVED
