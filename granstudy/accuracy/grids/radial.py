"""The grid of an isotropic gas: the fewest speeds, and the radius, whose imbalance is allowed.

The tensor of `radial` serves every R, and there is no quadrature to plan: so the imbalance of a grid is not
predicted but measured, in milliseconds.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from granstudy.accuracy.grids.sources import Source
from granstudy.accuracy.leg import Gas, Need, Tried, make_leg
from granstudy.evolution.frames.rescaled import Place
from granstudy.model.solver import SizedSolver, Solver
from granstudy.velocity.radial import RadialGrid

SPEEDS = (16, 20, 24, 28, 32, 40, 48, 64, 80, 96)
"""Numbers of speeds that are tried; few, so that runs share tensors."""

RADIUS_STEP = 1.12
"""Factor between radii that are tried."""

RADII_TRIED = 6
"""Most radii that are tried with a number of speeds."""

RADIUS_GROWTH = 0.6
"""R grows as this power of the number of speeds."""

DEAR = 64
"""Speeds from which on a tensor takes seconds: tried only where fewer do not do."""

GAIN = 0.7
"""Growth of errors over that on a grid with fewer speeds, above which more speeds gain nothing."""

UNRESOLVED = 3e-2
"""Part of ∫f² in the upper quarter of the modes above which speeds are too few to try."""


Measure = Callable[[int, float], Tried]
"""N, R ↦ the grid, tried."""


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
    measure = partial(try_radial, gas, source, place, need)
    speeds = [
        N for N in SPEEDS if not _unresolved(source, RadialGrid(gas.scene.dim, N, radius))
    ] or SPEEDS[-1:]
    return _fewest(measure, speeds, radius, target)


def larger_grid(
    gas: Gas, source: Source, place: Place, need: Need, too_small: SizedSolver, target: float
) -> Tried | None:
    """The next grid after one on which errors grew too fast; None after the last.

    The grid that made the errors cannot tell what the density is like there. So speeds become closer and R
    larger, as `RADIUS_GROWTH` says.
    """
    more = [N for N in SPEEDS if N > too_small.N]
    if not more:
        return None
    N = more[0]
    R = too_small.R * (N / too_small.N) ** RADIUS_GROWTH
    return _best_radius(partial(try_radial, gas, source, place, need), N, R, target)


def try_radial(gas: Gas, source: Source, place: Place, need: Need, N: int, R: float) -> Tried:
    """Measure the growth of errors on a grid of N speeds."""
    leg = make_leg(gas, Solver(N=N, R=R, method="radial", threads=gas.threads))
    f = source.on(leg.grid)
    balance = leg.balance(leg.start(f, place))
    return Tried(leg, f, need.ratio(balance, source.lost(leg.grid)), balance)


def _fewest(measure: Measure, speeds: Sequence[int], radius: float, target: float) -> Tried:
    """The fewest speeds with a radius at which errors grow by ``target`` of what is allowed, or least."""
    best: Tried | None = None
    in_vain = 0
    for N in speeds:
        if best is not None and (in_vain == 2 or (N >= DEAR and best.ratio <= 1.0)):
            break
        found = _best_radius(measure, N, radius, target)
        radius = found.leg.solver.R
        in_vain = in_vain + 1 if best is not None and found.ratio > GAIN * best.ratio else 0
        if best is None or found.ratio < best.ratio:
            best = found
        if best.ratio <= target:
            break
    assert best is not None
    return best


def _best_radius(measure: Measure, N: int, radius: float, target: float) -> Tried:
    """The radius with the least growth of errors, or the first below the target; outwards, then inwards."""
    best = measure(N, radius)
    for radii in (_steps(radius, RADIUS_STEP), _steps(radius, 1.0 / RADIUS_STEP)):
        improved = False
        for R in radii:
            if best.ratio <= target:
                return best
            tried = measure(N, R)
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
