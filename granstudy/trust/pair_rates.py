"""Exact rates of energy and fourth moment, as sums over all pairs of a density (docs/method.md §10).

A collision changes the relative velocity from g to g' = (1−2α)g + 2α|g|σ and leaves w = (v+v*)/2, so that
with V = |v−u|², V' after the collision,

    Δ½(V+V*) = (|g'|²−|g|²)/4,   Δ(V²+V*²) = 2[(|w|²+|g'|²/4)² − (|w|²+|g|²/4)² + (w·g')² − (w·g)²].

The mean over σ, of the components of g' along and across g, leaves polynomials in |g|,
|w|² = ½(V+V*) − |g|²/4 and w·g = ½(V−V*). Rates are integrals ½∫∫ |S|C_λ|g|^λ Δ f f* dv dv* over all pairs,
without truncation, modes or directions. Where the moments of Q differ from these rates, Q is wrong. On a
Cartesian grid the integrals are sums over pairs of nodes, less what the kink of |g|^λ at g = 0 adds to such
a sum (`granstudy.trust.lattice_sums`).
"""

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy.fft

from granstudy.model.restitution import Restitution, restitution_at
from granstudy.model.scene import Scene
from granstudy.quadrature.deflection import deflections, gauss_legendre
from granstudy.trust.lattice_sums import lattice_excess, radial_excess
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import VelocitySpace
from granstudy.velocity.sphere import sphere_area

ANGLES = 64
"""Nodes of the mean over the angle between two velocities."""


WEIGHT_POWERS = (0, 2, 4, 2, 0)
"""Powers of ρ beside ρ^λ in the fields of `PairWeights`, at constant restitution."""


class Rates(NamedTuple):
    """Rates of a density by collisions, in a unit time.

    Attributes
    ----------
    frequency : float
        Collisions of a particle, ∫∫ |S|C_λ|g|^λ f f* / ρ.
    energy : float
        Rate of ½∫|v|² f, with all of f's mass.
    fourth : float
        Rate of ∫|v−u|⁴ f.
    """

    frequency: float
    energy: float
    fourth: float


class PairWeights(NamedTuple):
    """Weights of a pair, as functions of ρ = |g|: its collision rate, and the rate times mean changes.

    Attributes
    ----------
    frequency : ndarray
        The collision rate |S|C_λ ρ^λ.
    energy : ndarray
        The rate times Δ½(V+V*).
    constant, linear, square : ndarray
        Coefficients of the rate times Δ(V²+V*²) = ``constant`` + ``linear`` (V+V*)/2 + ``square`` (V−V*)².
    """

    frequency: np.ndarray
    energy: np.ndarray
    constant: np.ndarray
    linear: np.ndarray
    square: np.ndarray


def pair_weights(scene: Scene, rho: np.ndarray) -> PairWeights:
    """The weights of pairs at relative speeds ``rho``, shape (n,)."""
    if callable(scene.restitution):
        u, _ = deflections(scene.dim, 0.0)
        e = restitution_at(scene.restitution, np.multiply.outer(rho, u))
        loss2, w2, wg2, length4 = _mean_changes(scene.dim, e)
    else:
        loss2, w2, wg2, length4 = _mean_changes_at(scene.dim, float(scene.restitution))
    g2 = rho**2
    B = sphere_area(scene.dim) * scene.kernel.strength * rho**scene.kernel.exponent
    return PairWeights(
        frequency=B,
        energy=B * g2 * loss2 / 4,
        constant=B * g2**2 * ((length4 - 1.0) / 8 - w2 / 4),
        linear=B * g2 * w2,
        square=B * wg2 / 4,
    )


def _mean_changes(dim: int, e: np.ndarray) -> tuple[np.ndarray, ...]:
    """Means over σ that the weights of a pair are made of, at restitutions ``e``, shape (n, nodes of χ).

    Returns
    -------
    tuple of ndarray, shape (n,)
        The mean of |g'|²/|g|² − 1; the factors of |w|²|g|² and of (w·g)² in the mean of Δ(V²+V*²);
        the mean of |g'|⁴/|g|⁴.
    """
    u, mean = deflections(dim, 0.0)
    # g'/|g| = 1−2α + 2α cos χ along g, 2α sin χ across it; cos χ = 1 − 2u²
    along = (1.0 - e) / 2 + (1.0 + e) / 2 * (1.0 - 2.0 * u**2)
    across = (1.0 + e) * u * np.sqrt(1.0 - u**2)
    along2, across2 = along**2 @ mean, across**2 @ mean
    length4 = (along**2 + across**2) ** 2 @ mean
    # across g, w has one direction: a (d−1)th part of the mean square of g' across g lies along it
    share = across2 / (dim - 1)
    loss2 = along2 + across2 - 1.0
    return loss2, loss2 + 2.0 * share, 2.0 * (along2 - 1.0 - share), length4


@lru_cache(maxsize=16)
def _mean_changes_at(dim: int, e: float) -> tuple[np.ndarray, ...]:
    """`_mean_changes` at a constant e, kept: a radial run asks for them at each angle; shapes (1,)."""
    u, _ = deflections(dim, 0.0)
    return _mean_changes(dim, np.full((1, len(u)), e))


class CollisionRates:
    """Rates of any density on one grid. The weights of pairs are computed once.

    Parameters
    ----------
    scene : Scene
        Kernel and restitution count.
    grid : VelocityGrid or RadialGrid

    Attributes
    ----------
    grid : VelocitySpace
    """

    def __init__(self, scene: Scene, grid: VelocitySpace) -> None:
        self.grid = grid
        self._pairs = _pairs(scene, grid)

    def __call__(self, f: np.ndarray) -> Rates:
        """All three rates of a real density."""
        m = self.grid.velocity_moments(f)
        u = m.momentum / m.density
        V = sum(np.square(v - ui) for v, ui in zip(self.grid.velocities(), u, strict=True))
        frequency, energy, fourth = self._pairs.sums(f, np.broadcast_to(V, self.grid.shape))
        return Rates(frequency / m.density, energy / 2, fourth / 2)

    def energy(self, f: np.ndarray) -> float:
        """Rate of energy alone, in a third of the time."""
        return self._pairs.energy(f) / 2


class RatesAt:
    """Rates of a scene's collisions at any restitution; the weights of the last restitution are kept."""

    def __init__(self, scene: Scene, grid: VelocitySpace) -> None:
        self._scene, self._grid = scene, grid
        self._last: tuple[Restitution, CollisionRates] | None = None

    def __call__(self, restitution: Restitution) -> CollisionRates:
        """The rates with ``restitution`` in place of the scene's."""
        if self._last is None or self._last[0] != restitution:
            scene = replace(self._scene, restitution=restitution)
            self._last = restitution, CollisionRates(scene, self._grid)
        return self._last[1]


class _CartesianPairs:
    """Sums over all pairs of Cartesian nodes, by transforms on twice the box, where nothing wraps around.

    A sum over nodes is an integral to the accuracy of the midpoint rule, once the excess O(h^{d+2+λ}) of the
    kink at ρ = 0 is subtracted, h the spacing. At constant restitution nothing of it is left. A restitution
    law is taken to be constant near ρ = 0, at its value for ρ = h/2.
    """

    def __init__(self, scene: Scene, grid: VelocityGrid) -> None:
        self._size = (2 * grid.N,) * grid.dim
        step = np.abs(np.fft.fftfreq(2 * grid.N, 0.5 / grid.N).round().astype(int))
        squared = sum(np.square(s) for s in np.meshgrid(*(step,) * grid.dim, sparse=True))
        distinct, place = np.unique(squared, return_inverse=True)
        weights = pair_weights(scene, grid.spacing * np.sqrt(distinct))
        inner = pair_weights(scene, np.array([0.5 * grid.spacing]))
        powers = [scene.kernel.exponent + power for power in WEIGHT_POWERS]
        distinct_powers = sorted(set(powers))
        excesses = lattice_excess(grid.dim, grid.N, distinct_powers)
        excess = dict(zip(distinct_powers, excesses, strict=True))
        half = np.ix_(*(step,) * (grid.dim - 1), step[: grid.N + 1])
        transforms = [
            self._transform(w[place], float(near[0]) * 2.0**s * excess[s][half], grid.cell)
            for w, near, s in zip(weights, inner, powers, strict=True)
        ]
        self._weights = PairWeights(*transforms)

    def _transform(self, weight: np.ndarray, excess: np.ndarray, cell: float) -> np.ndarray:
        """K̂ with Σ_k K̂_k Re(â_k b̂_k*) = ∫∫ K a b* dv dv*, the sum over a half spectrum.

        Inner modes of the half spectrum count twice.
        """
        K_hat = scipy.fft.rfftn(weight.reshape(self._size)).real - excess
        K_hat *= cell**2 / weight.size
        K_hat[..., 1:-1] *= 2.0
        return K_hat

    def energy(self, f: np.ndarray) -> float:
        """∫∫ of Δ½(V+V*) f f*."""
        f_hat = scipy.fft.rfftn(f, s=self._size)
        return float(np.vdot(self._weights.energy, f_hat.real**2 + f_hat.imag**2))

    def sums(self, f: np.ndarray, V: np.ndarray) -> tuple[float, float, float]:
        """∫∫ of the frequency, of Δ½(V+V*) and of Δ(V²+V*²), each times f f*; V at the nodes."""
        f0, f1, f2 = (scipy.fft.rfftn(a, s=self._size) for a in (f, f * V, f * V**2))
        K = self._weights
        squares = f0.real**2 + f0.imag**2
        fourth = np.vdot(K.constant, squares) + np.vdot(K.linear, _product(f0, f1))
        # (V−V*)² = V² + V*² − 2VV*
        fourth += 2.0 * np.vdot(K.square, _product(f0, f2) - _product(f1, f1))
        return (
            float(np.vdot(K.frequency, squares)),
            float(np.vdot(K.energy, squares)),
            float(fourth),
        )


class _RadialPairs:
    """Sums over pairs of speeds, each with the mean over the angle between the velocities, less their excess.

    The grid is known by its nodes and weights alone, so that runs on a Cartesian grid do not depend on the
    radial one.
    """

    def __init__(self, scene: Scene, grid: VelocitySpace) -> None:
        x, w = gauss_legendre(ANGLES)
        if grid.dim == 2:
            x = np.cos(np.pi / 2 * (x + 1))
        speeds, weights = grid.velocities()[0], np.asarray(grid.measure)
        r = speeds[:, None]
        V, V_ = r**2, r.T**2
        inner = pair_weights(scene, np.array([0.5 * grid.spacing]))
        powers = [scene.kernel.exponent + power for power in WEIGHT_POWERS]
        near = [float(w[0]) / (0.5 * grid.spacing) ** s for w, s in zip(inner, powers, strict=True)]
        excess = {s: radial_excess(grid.dim, speeds, s) for s in set(powers)}
        kink = PairWeights(*(a * excess[s] for a, s in zip(near, powers, strict=True)))
        forms = -_form(kink, V, V_)
        for cosine, weight in zip(x, w / 2, strict=True):
            rho = np.sqrt(np.maximum(V + V_ - 2.0 * cosine * r * r.T, 0.0))
            K = PairWeights(*(a.reshape(rho.shape) for a in pair_weights(scene, rho.ravel())))
            forms += weight * _form(K, V, V_)
        self._forms = weights[:, None] * forms * weights

    def energy(self, f: np.ndarray) -> float:
        """∫∫ of Δ½(V+V*) f f*."""
        return float(f @ self._forms[1] @ f)

    def sums(self, f: np.ndarray, V: np.ndarray) -> tuple[float, float, float]:
        """The sums of `_CartesianPairs.sums`; V is known from the nodes."""
        frequency, energy, fourth = f @ self._forms @ f
        return float(frequency), float(energy), float(fourth)


def _pairs(scene: Scene, grid: VelocitySpace) -> _CartesianPairs | _RadialPairs:
    """The sums over pairs on a grid of either kind."""
    if isinstance(grid, VelocityGrid):
        return _CartesianPairs(scene, grid)
    return _RadialPairs(scene, grid)


def _form(K: PairWeights, V: np.ndarray, V_: np.ndarray) -> np.ndarray:
    """Weights of a pair's frequency, Δ½(V+V*) and Δ(V²+V*²)."""
    fourth = K.constant + K.linear * (V + V_) / 2 + K.square * (V - V_) ** 2
    return np.array([K.frequency, K.energy, fourth])


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Re(a b*)."""
    return a.real * b.real + a.imag * b.imag
