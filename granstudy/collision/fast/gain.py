"""The gain as a sum over nodes: real transforms, antipodal pairs, fused loops, threads.

The sum rests on facts 1 to 4 of docs/method.md §2. For real f the nodes ±g share two transforms, as
f(v)f(v+g) is f(v)f(v−g) displaced by g. The weight of a pair is real up to the half-shift e^{i½k·g}:

    Q̂⁺_k = |S|C_λ Σ_ρ w_ρ ρ^{d−1+λ} Σ_{±ĝ} w_ĝ e^{iπρ k·ĝ/2L} 2P(ρ,|k|,k·ĝ) FFT[f(v) f(v−ρĝ)]_k

    restitution             P
    constant e              mean(πρα|k|/L) cos(πρβ k·ĝ/L), β = (1−e)/4
    law e(|g·ω|)            a series in (k̂·ĝ)² (`granstudy.collision.weights.pair_series`)
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, Protocol

import numpy as np

from granstudy.collision.fast import loops
from granstudy.collision.fast.nodes import Nodes
from granstudy.collision.fourier import fftw
from granstudy.collision.fourier.threads import SHARES, Bounds, Workers, split
from granstudy.collision.fourier.transforms import REAL, RealTransforms, aligned_zeros
from granstudy.collision.weights import alpha, pair_series
from granstudy.model.scene import Scene
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.sphere import sphere_mean

SMALLEST_SHARE = 12
"""Fewest nodes of a share that are worth its overhead."""


class Gain(Protocol):
    """The gain Q̂⁺ of a real density as a sum over nodes.

    Attributes
    ----------
    grid : VelocityGrid
        The grid of n points per dimension on which the products are formed.
    nodes : Nodes
    shape : tuple of int
        Shape (n, n', n) of the densities it takes, n' = n in 3D and 1 in 2D.
    transforms : int
        Real transforms that one sum makes.
    """

    grid: VelocityGrid
    nodes: Nodes
    shape: tuple[int, int, int]
    transforms: int

    def total(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        """The sum over all nodes, a half spectrum (n, n', n/2+1).

        ``f`` has shape (n, n', n); ``f_hat`` is its half spectrum, Σ_k f̂_k e^{iπk·v/L} = f.
        """

    def transform(self) -> None:
        """Make the transforms of one sum and nothing else, for benchmarks."""


class GainSum:
    """The gain Q̂⁺ of a real density as a sum over nodes on threads, at two real transforms per node.

    Parameters
    ----------
    grid : VelocityGrid
        The grid on which the products are formed.
    shares : sequence of (start, stop), optional
        Parts of the sum, by default `equal_shares`.
    precision : str
        ``double``, or ``single`` for the nodes' transforms and loops. Shells are added in double precision.
    """

    def __init__(
        self,
        scene: Scene,
        grid: VelocityGrid,
        nodes: Nodes,
        threads: int,
        shares: Sequence[Bounds] | None = None,
        precision: str = "double",
    ) -> None:
        self._recipe = scene, grid, nodes, threads, shares, precision
        self.grid = grid
        self.real = REAL[precision]
        self.nodes = nodes
        self.shape = grid.three_axis_shape
        self._half_shape = (*self.shape[:2], grid.N // 2 + 1)
        self.shares = equal_shares(len(nodes)) if shares is None else list(shares)
        self.transforms = 2 * len(nodes)
        self._weights = nodes.weights / grid.N**grid.dim  # transforms are unnormalised
        k2, place = np.unique(grid.wavenumber_squared(half=True), return_inverse=True)
        self._place = place.reshape(grid.N, -1).astype(np.uint32)
        self._f_re, self._f_im = (aligned_zeros(self._place.shape, self.real) for _ in range(2))
        # Real and imaginary parts apart, which loops add to fastest.
        self._gains = aligned_zeros((len(self.shares), 2, *self._place.shape), np.float64)
        self._sum = self._choose_weight(scene, k2)
        self._workers = Workers(
            min(threads, max(1, len(self.shares))),
            lambda: _PairBuffers(self.shape, precision),
        )
        # The buffer of a thread that has summed is still in the cache.
        idle = self._workers.workspaces[0].transforms.spectrum
        self._total = idle if precision == "double" else np.empty(self._half_shape, np.complex128)

    def parts(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        """The sum over each share, half spectra (shares, n, n', n/2+1).

        ``f`` has shape (n, n', n); ``f_hat`` is its half spectrum, Σ_k f̂_k e^{iπk·v/L} = f.
        """
        self._sum_shares(f, f_hat)
        gains = self._gains[:, 0] + 1j * self._gains[:, 1]
        return gains.reshape(len(self.shares), *self._half_shape)

    def total(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        """The sum over all nodes, a half spectrum (n, n', n/2+1). The next call overwrites it."""
        self._sum_shares(f, f_hat)
        loops.add_shares(self._gains, self._real_parts(self._total))
        return self._total

    def _sum_shares(self, f: np.ndarray, f_hat: np.ndarray) -> None:
        """Fill `_gains` with the sum over each share."""
        f = f.astype(self.real, copy=not f.flags.writeable).reshape(-1, self.grid.N)
        loops.separate(self._real_parts(f_hat), 1.0, self._f_re, self._f_im)

        def sum_share(item: tuple[Bounds, np.ndarray], work: "_PairBuffers") -> None:
            bounds, (gain_re, gain_im) = item
            self._sum(slice(*bounds), work, f, gain_re, gain_im)

        self._workers.map(sum_share, list(zip(self.shares, self._gains, strict=True)))

    def _real_parts(self, spectrum: np.ndarray) -> np.ndarray:
        """Real and imaginary parts in turn of a half spectrum, shape (n, 2m)."""
        return spectrum.view(np.float64).reshape(self.grid.N, -1)

    def transform(self) -> None:
        """Make the transforms of one sum on the same threads and nothing else, for benchmarks."""

        def transform_share(share: Bounds, work: "_PairBuffers") -> None:
            plans = work.transforms.plans
            fftw.alternate(plans, fftw.BACKWARD, plans, fftw.FORWARD, share[1] - share[0])
            work.transforms.spectrum[...] = 0.0

        self._workers.map(transform_share, self.shares)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the sum is made from, nodes included."""
        return type(self), self._recipe

    def _choose_weight(self, scene: Scene, k2: np.ndarray) -> Callable[..., None]:
        """The compiled sum with the weight 2P of a constant restitution, or of a law."""
        nodes, grid = self.nodes, self.grid
        k = np.pi / grid.L * np.sqrt(k2)
        if callable(scene.restitution):
            series = pair_series(scene.restitution, grid.dim, nodes.radii, k)
            series *= nodes.measure[:, None, None]
            return partial(self._sum_series, series, k2, np.pi / grid.L * nodes.radii)
        means = shell_means(scene.restitution, grid.dim, nodes, k)
        return partial(self._sum_pairs, pair_shift(scene.restitution), means)

    def _sum_pairs(
        self,
        beta: float,
        means: np.ndarray,
        part: slice,
        work: "_PairBuffers",
        f: np.ndarray,
        *gain: np.ndarray,
    ) -> None:
        share = self._share(part, work, f, *gain)
        loops.sum_pairs(beta, means, work.sum_re, work.sum_im, *share)

    def _sum_series(
        self,
        series: np.ndarray,
        k2: np.ndarray,
        radii: np.ndarray,
        part: slice,
        work: "_PairBuffers",
        f: np.ndarray,
        *gain: np.ndarray,
    ) -> None:
        loops.sum_series(series, k2, radii, *self._share(part, work, f, *gain))

    def _share(
        self, part: slice, work: "_PairBuffers", f: np.ndarray, *gain: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Arguments of the sum over a part of the nodes that do not depend on the weight."""
        nodes, transforms = self.nodes, work.transforms
        return (
            *(self._f_re, self._f_im, f),
            *(nodes.vectors[part], self._weights[part], nodes.shells[part], self._place),
            *(transforms.parts, transforms.rows, transforms.plans, *gain),
        )


def shell_means(e: float, dim: int, nodes: Nodes, k: np.ndarray) -> np.ndarray:
    """|S|C_λ w_ρ ρ^{d−1+λ} mean(ραk) of every shell at magnitudes k, shape (shells, magnitudes)."""
    return nodes.measure[:, None] * sphere_mean(dim, float(alpha(e)) * nodes.radii[:, None] * k)


def pair_shift(e: float) -> float:
    """β = (1−e)/4: the gains of g and −g are displaced by (½ ± β)g."""
    return (1.0 - e) / 4.0


def equal_shares(count: int) -> list[Bounds]:
    """Shares of ``count`` nodes, whatever the thread count: 8, and of few nodes 4 or 2."""
    shares = SHARES
    while shares > 2 and count < shares * SMALLEST_SHARE:
        shares //= 2
    return split(count, shares)


class _PairBuffers:
    """Buffers of one thread: transforms of a pair's product, and the sum over the current shell."""

    def __init__(self, shape: tuple[int, int, int], precision: str) -> None:
        self.transforms = RealTransforms(shape, precision)
        modes = shape[1] * (shape[2] // 2 + 1)
        self.sum_re, self.sum_im = (
            aligned_zeros((shape[0], modes), REAL[precision]) for _ in range(2)
        )
