"""What a truncation radius cuts off: sums over pairs that are farther apart."""

from typing import NamedTuple

import numpy as np
import scipy.fft

from granstudy.model.scene import Scene
from granstudy.trust.pair_rates import pair_weights
from granstudy.velocity.cartesian import VelocityGrid

NOISE = 2.0
"""A density counts where it is so many times its noise."""


class Truncation(NamedTuple):
    """Rates that pairs beyond a radius have a part in, over radii.

    Attributes
    ----------
    radii : ndarray, shape (n,)
        Increasing.
    temperature : ndarray, shape (n,)
        Largest |T'/T| by pairs with |g| above each radius, or above any larger one.
    a2 : ndarray, shape (n,)
        Likewise of a2'/(1 + a2).
    exchange : ndarray, shape (n,)
        Part of Σ|g|^{2+λ} over all pairs by those beyond. Elastic collisions change neither T nor, of some
        gases, a2; a radius must hold their pairs all the same.
    """

    radii: np.ndarray
    temperature: np.ndarray
    a2: np.ndarray
    exchange: np.ndarray

    def at(self, R: float) -> tuple[float, float, float]:
        """All three at the largest of the radii that is at most R; infinite below all."""
        place = int(np.searchsorted(self.radii, R, side="right")) - 1
        if place < 0:
            return np.inf, np.inf, np.inf
        return float(self.temperature[place]), float(self.a2[place]), float(self.exchange[place])

    def radius(self, temperature: float, a2: float, exchange: float) -> float:
        """The least radius at which both rates, and the exchange, are at most these."""
        fits = (self.temperature <= temperature) & (self.a2 <= a2) & (self.exchange <= exchange)
        return float(self.radii[int(np.argmax(fits))] if fits.any() else self.radii[-1])


def without_noise(f: np.ndarray, grid: VelocityGrid) -> np.ndarray:
    """The density where it is above its noise, else 0: what a run left far out would count as pairs.

    The noise is the larger of −min f and |f| at the border.
    """
    floor = NOISE * max(-float(f.min()), grid.edge(f))
    return np.where(f > floor, f, 0.0)


def truncation(scene: Scene, grid: VelocityGrid, f: np.ndarray) -> Truncation:
    """Rates by pairs of a density on a Cartesian grid that are farther apart than a radius.

    Energies and fourth moments that such pairs exchange (`granstudy.trust.pair_rates`), summed outwards in
    shells of half a spacing.
    """
    m = grid.velocity_moments(f)
    u = m.momentum / m.density
    V = sum(np.square(v - ui) for v, ui in zip(grid.velocities(), u, strict=True))
    size = (2 * grid.N,) * grid.dim
    f0, f1, f2 = (scipy.fft.rfftn(a, s=size) for a in (f, f * V, f * V**2))

    def pairs(spectrum: np.ndarray) -> np.ndarray:
        """Σ over pairs with the difference g, for every g."""
        return scipy.fft.irfftn(spectrum, s=size).ravel() * grid.cell**2

    step = np.fft.fftfreq(2 * grid.N, 0.5 / grid.N).round()
    squared = sum(np.square(s) for s in np.meshgrid(*(step,) * grid.dim, sparse=True)).ravel()
    distinct, place = np.unique(squared, return_inverse=True)
    speeds = grid.spacing * np.sqrt(distinct)
    K = pair_weights(scene, speeds)

    def by_speed(values: np.ndarray) -> np.ndarray:
        return np.bincount(place, weights=values, minlength=len(distinct))

    squares = by_speed(pairs(f0.real**2 + f0.imag**2))
    product = by_speed(pairs((f0 * f1.conj()).real))
    spread = by_speed(pairs((f0 * f2.conj()).real - (f1.real**2 + f1.imag**2)))
    energy = K.energy * squares
    fourth = K.constant * squares + K.linear * product + 2.0 * K.square * spread
    second = float(np.trace(m.pressure))
    cooling = energy / second
    shaping = 0.5 * fourth / m.fourth - 2.0 * cooling
    exchange = np.maximum(squares, 0.0) * speeds ** (2.0 + scene.kernel.exponent)
    exchange /= exchange.sum()
    shell = (2.0 * speeds / grid.spacing).astype(int)
    radii = (np.arange(shell[-1] + 1) + 1) * grid.spacing / 2
    outside = [
        np.abs(np.cumsum(np.bincount(shell, weights=rate)[::-1])[::-1])
        for rate in (cooling, shaping, exchange)
    ]
    # pairs beyond the outer radius of a shell: the sum from the next shell on
    beyond = [np.append(rate[1:], 0.0) for rate in outside]
    # A sum may vanish at one radius by chance: what counts is the largest from there on.
    beyond = [np.maximum.accumulate(rate[::-1])[::-1] for rate in beyond]
    return Truncation(radii, *beyond)
