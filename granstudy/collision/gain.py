"""The sum over nodes: real transforms, antipodal pairs, fused loops, threads.

Facts 1 to 4 of docs/method.md §2. For real f the nodes ±g share one transform pair, as f(v)f(v+g) is
f(v)f(v−g) displaced by g, and the weight of both together is real up to the half-shift e^{i½k·g}:

    Q̂⁺_k = |S|C_λ Σ_ρ w_ρ ρ^{d−1+λ} Σ_{±ĝ} w_ĝ e^{iπρ k·ĝ/2L} 2P(ρ,|k|,k·ĝ) FFT[f(v) f(v−ρĝ)]_k

with P = mean(πρα|k|/L) cos(πρβ k·ĝ/L), β = (1−e)/4, for a constant restitution, and a series in (k̂·ĝ)²
for one that depends on the impact speed.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

import numpy as np

from granstudy.collision import kernels
from granstudy.collision.nodes import Nodes
from granstudy.collision.transforms import REAL, RealTransforms, largest_batch
from granstudy.collision.variable_restitution import pair_series
from granstudy.collision.weights import alpha, sphere_mean
from granstudy.collision.workers import SHARES, Workers
from granstudy.grid import VelocityGrid
from granstudy.scene import Scene

SMALLEST_SHARE = 12
"""Nodes below which a share of the sum is not worth its overhead."""

Bounds = tuple[int, int]


class Gain(Protocol):
    """Q̂⁺ of a real density on a grid, as a sum over nodes.

    Attributes
    ----------
    shape : tuple of int
        Of the densities it takes, (n, n', n), n' = 1 in two dimensions.
    transforms : int
        Real transforms that the sum makes.
    """

    grid: VelocityGrid
    nodes: Nodes
    shape: tuple[int, int, int]
    transforms: int

    def total(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        """The sum over all nodes, a half spectrum, of f and its half spectrum f̂."""

    def transform(self) -> None:
        """Make the transforms of one sum and nothing else, for benchmarks."""


class GainSum:
    """Q̂⁺ of a real density as a sum over given nodes, at two real transforms a node.

    Parameters
    ----------
    grid : VelocityGrid
        The grid on which the products are formed.
    shares : sequence of (start, stop), optional
        Parts of the sum, by default about equal ones for threads.
    precision : str
        ``double``, or ``single`` for the nodes' transforms and loops; shells are added in double.
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
        self.grid = grid
        self.real = REAL[precision]
        self.nodes = nodes
        self.shape = (grid.N, grid.N if grid.dim == 3 else 1, grid.N)
        self.shares = equal_shares(len(nodes)) if shares is None else list(shares)
        self.transforms = 2 * len(nodes)
        longest = max((stop - start for start, stop in self.shares), default=1)
        largest = largest_batch(grid.N**grid.dim, precision)
        # Equal batches: no transform is spent on padding but in the last share.
        self._batch = -(-longest // -(-longest // largest))
        self._displacements = -nodes.vectors
        self._weights = nodes.weights / grid.N**grid.dim  # transforms are unnormalised
        # A shell's sum is closed where the next node lies on another shell or in another share.
        self._ends = np.zeros(len(nodes), dtype=bool)
        self._ends[nodes.ends[: len(nodes)] - 1] = True
        self._ends[[stop - 1 for _, stop in self.shares]] = True
        self._starts = np.roll(self._ends, 1)
        k2, place = np.unique(grid.wavenumber_squared(half=True), return_inverse=True)
        self._place = place.reshape(grid.N, -1).astype(np.uint32)
        self._accumulate = self._choose_weight(scene, k2)
        self._workers = Workers(
            min(threads, max(1, len(self.shares))),
            lambda: _Workspace(self._batch, self.shape, precision),
        )

    def parts(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        """The sum over each share, half spectra (shares, n, n', n/2+1).

        ``f`` has shape (n, n', n); ``f_hat`` is its half spectrum, Σ_k f̂_k e^{iπk·v/L} = f.
        """
        f_rows = np.ascontiguousarray(f, dtype=self.real).reshape(-1, self.grid.N)
        f_re, f_im = (
            np.ascontiguousarray(part, dtype=self.real).reshape(self.grid.N, -1)
            for part in (f_hat.real, f_hat.imag)
        )
        gains = np.empty((len(self.shares), *f_hat.shape), dtype=np.complex128)
        views = gains.view(np.float64).reshape(len(self.shares), self.grid.N, -1)

        def sum_share(item: tuple[Bounds, np.ndarray], work: "_Workspace") -> None:
            (start, stop), gain = item
            gain[...] = 0.0
            transforms = work.transforms
            for first in range(start, stop, self._batch):
                part = slice(first, min(first + self._batch, stop))
                kernels.shift(f_re, f_im, self._displacements[part], transforms.parts)
                transforms.execute_backward()
                kernels.multiply(transforms.rows, f_rows)
                transforms.execute_forward()
                self._accumulate(work, part, gain)

        self._workers.map(sum_share, list(zip(self.shares, views, strict=True)))
        return gains

    def total(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        """The sum over all nodes, as `parts`."""
        parts = self.parts(f, f_hat)
        for part in parts[1:]:
            parts[0] += part
        return parts[0]

    def transform(self) -> None:
        """Make the transforms of one sum on the same threads and nothing else, for benchmarks."""

        def transform_share(share: Bounds, work: "_Workspace") -> None:
            for _ in range(*share, self._batch):
                work.transforms.execute_backward()
                work.transforms.execute_forward()
            work.transforms.spectrum[...] = 0.0

        self._workers.map(transform_share, self.shares)

    def _choose_weight(
        self, scene: Scene, k2: np.ndarray
    ) -> Callable[["_Workspace", slice, np.ndarray], None]:
        """The pairs' weight 2P: closed for a constant restitution, else a series."""
        nodes, grid = self.nodes, self.grid
        k = np.pi / grid.L * np.sqrt(k2)
        if callable(scene.restitution):
            series = pair_series(scene.restitution, grid.dim, nodes.radii, k)
            series *= nodes.measure[:, None, None]
            return partial(self._accumulate_series, series, k2, np.pi / grid.L * nodes.radii)
        means = shell_means(scene.restitution, grid.dim, nodes, k)
        return partial(self._accumulate_pairs, pair_shift(scene.restitution), means)

    def _accumulate_pairs(
        self, beta: float, means: np.ndarray, work: "_Workspace", part: slice, gain: np.ndarray
    ) -> None:
        kernels.accumulate_pairs(
            work.transforms.parts,
            self.nodes.vectors[part],
            self._weights[part],
            self.nodes.shells[part],
            self._starts[part],
            self._ends[part],
            beta,
            means,
            self._place,
            work.sum_re,
            work.sum_im,
            gain,
        )

    def _accumulate_series(
        self,
        series: np.ndarray,
        k2: np.ndarray,
        radii: np.ndarray,
        work: "_Workspace",
        part: slice,
        gain: np.ndarray,
    ) -> None:
        kernels.accumulate_series(
            work.transforms.parts,
            self.nodes.vectors[part],
            self._weights[part],
            self.nodes.shells[part],
            series,
            self._place,
            k2,
            radii,
            gain,
        )


def shell_means(e: float, dim: int, nodes: Nodes, k: np.ndarray) -> np.ndarray:
    """|S|C_λ w_ρ ρ^{d−1+λ} mean(ραk) of every shell at magnitudes k, shape (shells, k)."""
    return nodes.measure[:, None] * sphere_mean(dim, float(alpha(e)) * nodes.radii[:, None] * k)


def pair_shift(e: float) -> float:
    """β = (1−e)/4: the gains of ±g are displaced by (½ ± β)g."""
    return (1.0 - e) / 4.0


def equal_shares(count: int) -> list[Bounds]:
    """About equal parts of so many nodes, whatever the thread count: 8, or 4 or 2 of few nodes."""
    shares = SHARES
    while shares > 2 and count < shares * SMALLEST_SHARE:
        shares //= 2
    size = max(1, -(-count // shares))
    return [(start, min(start + size, count)) for start in range(0, count, size)]


class _Workspace:
    """What one thread needs: a batch's transforms and the sum over the shell it is in."""

    def __init__(self, batch: int, shape: tuple[int, int, int], precision: str) -> None:
        self.transforms = RealTransforms(batch, shape, precision)
        modes = shape[1] * (shape[2] // 2 + 1)
        self.sum_re, self.sum_im = np.zeros((2, shape[0], modes), dtype=REAL[precision])
