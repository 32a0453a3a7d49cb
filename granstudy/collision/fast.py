"""The fast operator: real transforms, antipodal pairs, fused loops, threads over nodes.

Facts 1 to 4 of docs/method.md §2. For real f the nodes ±g share one transform pair, as f(v)f(v+g) is
f(v)f(v−g) displaced by g, and the weight of both together is real up to the half-shift e^{i½k·g}:

    Q̂⁺_k = |S|C_λ Σ_ρ w_ρ ρ^{d−1+λ} Σ_{±ĝ} w_ĝ e^{iπρ k·ĝ/2L} 2P(ρ,|k|,k·ĝ) FFT[f(v) f(v−ρĝ)]_k

with P = mean(πρα|k|/L) cos(πρβ k·ĝ/L), β = (1−e)/4, for a constant restitution, and a series in (k̂·ĝ)² for
one that depends on the impact speed. The loss is one convolution in both variants, since a sum over
nodes of displaced densities is a multiplier.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from queue import SimpleQueue

import numpy as np

from granstudy.collision import kernels
from granstudy.collision.operator import check_state
from granstudy.collision.rules import directions, radial_nodes
from granstudy.collision.transforms import RealTransforms
from granstudy.collision.variable_restitution import pair_series
from granstudy.collision.weights import alpha, loss_weight, radial_measure, sphere_mean
from granstudy.quadrature import half
from granstudy.scene import Scene
from granstudy.solver import Solver

SHARES = 8
"""The sum over nodes is split in this many parts, added up in order whatever the thread count, so
that results do not depend on it."""

BATCH_BYTES = 2**17
"""Small grids are transformed several at a time, one buffer up to this size (it fits a core's cache)."""


class FastOperator:
    """Q(f,f) for real f at two real transforms an antipodal pair of nodes."""

    def __init__(self, scene: Scene, solver: Solver) -> None:
        self.grid = grid = solver.grid(scene.dim)
        radial = radial_nodes(scene, solver)
        pairs = half(directions(scene, solver))
        measure = radial_measure(scene.kernel, grid.dim, radial.points, radial.weights)

        # Arrays have three axes in both dimensions, the second of length 1 in 2D.
        self._shape = (grid.N, grid.N if grid.dim == 3 else 1, grid.N)
        ghat = np.zeros((len(pairs.weights), 3))
        ghat[:, [0, 2] if grid.dim == 2 else [0, 1, 2]] = pairs.points
        # g in units L/π, so that phases are k·g.
        # Which of ±g stands for the pair is free but for aliasing; signs that balance cancel it.
        signs = balanced_signs(pairs.points) * (-1) ** np.arange(len(radial))[:, None]
        g = np.pi / grid.L * radial.points[:, None, None] * signs[..., None] * ghat
        self._nodes = g.reshape(-1, 3)
        self._weights = np.tile(pairs.weights / 2, len(radial.points))
        self._shells = np.repeat(np.arange(len(radial.points)), len(pairs.weights))
        self.transforms = 2 * len(self._weights) + 3

        k2, place = np.unique(grid.wavenumber_squared(half=True), return_inverse=True)
        self._place = place.reshape(self._spectrum_shape)
        k = np.pi / grid.L * np.sqrt(k2)
        if callable(scene.restitution):
            series = pair_series(scene.restitution, grid.dim, radial.points, k)
            series *= measure[:, None, None]
            radii = np.pi / grid.L * radial.points
            self._accumulate = partial(self._accumulate_series, series, k2, radii)
        else:
            beta = (1.0 - scene.restitution) / 4.0
            scale = float(alpha(scene.restitution)) * radial.points[:, None]
            means = measure[:, None] * sphere_mean(grid.dim, scale * k)
            self._accumulate = partial(self._accumulate_pairs, beta, means)
        if solver.variant == "separate":
            self._loss = loss_weight(
                scene.kernel, grid, radial.points, radial.weights, half=True
            ).reshape(self._spectrum_shape)
        else:
            self._loss = np.zeros(self._spectrum_shape)
            kernels.nodal_loss(self._nodes, self._weights * measure[self._shells], self._loss)
        self._plan(solver.thread_count)

    @property
    def _spectrum_shape(self) -> tuple[int, int, int]:
        return (*self._shape[:2], self._shape[2] // 2 + 1)

    def _plan(self, threads: int) -> None:
        """Divide the nodes, and give every thread its buffers and transforms."""
        share = -(-len(self._weights) // SHARES)
        largest = max(1, BATCH_BYTES // (8 * self.grid.N**self.grid.dim))
        # Equal batches: no transform is spent on padding but in the last share.
        self._batch = -(-share // -(-share // largest))
        self._bounds = [
            (start, min(start + share, len(self._weights)))
            for start in range(0, len(self._weights), share)
        ]
        # A shell's sum is closed where the next node lies on another shell or in another share.
        self._ends = np.append(self._shells[1:] != self._shells[:-1], True)
        self._ends[[stop - 1 for _, stop in self._bounds]] = True
        self._gains = np.zeros((len(self._bounds), *self._spectrum_shape), dtype=np.complex128)
        self._single = RealTransforms(1, self._shape)
        self._workspaces: SimpleQueue[_Workspace] = SimpleQueue()
        threads = min(threads, len(self._bounds))
        for _ in range(threads):
            self._workspaces.put(_Workspace(self._batch, self._shape))
        self._pool = ThreadPoolExecutor(threads)

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) of a real density."""
        check_state(f, self.grid)
        if np.iscomplexobj(f):
            raise ValueError(f"density has type {f.dtype}: method 'fast' takes real densities")
        f = np.ascontiguousarray(f, dtype=np.float64).reshape(self._shape)
        f_hat = self._single.forward(f) / f.size
        list(self._pool.map(partial(self._sum_share, f, f_hat), range(len(self._bounds))))
        Q = self._single.backward(self._gains.sum(axis=0) / f.size)
        Q -= f * self._single.backward(self._loss * f_hat)
        return Q.reshape(self.grid.shape)

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""
        list(self._pool.map(self._transform_share, self._bounds))

    def _transform_share(self, bounds: tuple[int, int]) -> None:
        work = self._workspaces.get()
        for _ in range(*bounds, self._batch):
            work.transforms.execute_backward()
            work.transforms.execute_forward()
        work.transforms.spectrum[...] = 0.0
        self._workspaces.put(work)

    def _sum_share(self, f: np.ndarray, f_hat: np.ndarray, share: int) -> None:
        """The gain's sum over one share of the nodes."""
        gain = self._gains[share]
        gain[...] = 0.0
        work = self._workspaces.get()
        start, stop = self._bounds[share]
        for first in range(start, stop, self._batch):
            nodes = slice(first, min(first + self._batch, stop))
            kernels.shift(f_hat, -self._nodes[nodes], work.transforms.spectrum)
            work.transforms.execute_backward()
            kernels.multiply(work.transforms.density, f)
            work.transforms.execute_forward()
            self._accumulate(work, nodes, gain)
        self._workspaces.put(work)

    def _accumulate_pairs(
        self, beta: float, means: np.ndarray, work: "_Workspace", nodes: slice, gain: np.ndarray
    ) -> None:
        kernels.accumulate_pairs(
            work.transforms.spectrum,
            self._nodes[nodes],
            self._weights[nodes],
            self._shells[nodes],
            self._ends[nodes],
            beta,
            means,
            self._place,
            work.shell_sum,
            gain,
        )

    def _accumulate_series(
        self,
        series: np.ndarray,
        k2: np.ndarray,
        radii: np.ndarray,
        work: "_Workspace",
        nodes: slice,
        gain: np.ndarray,
    ) -> None:
        kernels.accumulate_series(
            work.transforms.spectrum,
            self._nodes[nodes],
            self._weights[nodes],
            self._shells[nodes],
            series,
            self._place,
            k2,
            radii,
            gain,
        )


def balanced_signs(points: np.ndarray) -> np.ndarray:
    """Signs ±1 that make the sum of the points small, chosen one after the other."""
    signs = np.ones(len(points))
    total = np.zeros(points.shape[1])
    for i, point in enumerate(points):
        signs[i] = 1.0 if total @ point <= 0.0 else -1.0
        total += signs[i] * point
    return signs


class _Workspace:
    """What one thread needs: a batch's transforms and the sum over the shell it is in."""

    def __init__(self, batch: int, shape: tuple[int, int, int]) -> None:
        self.transforms = RealTransforms(batch, shape)
        self.shell_sum = np.zeros_like(self.transforms.spectrum[0])
