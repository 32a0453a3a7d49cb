"""The Carleman form: products of two filtered densities, no sum over shells (docs/method.md §2).

    Q⁺(v) = Σ_{±e} w_e Σ_j a_j(v) b_j(v),   â_j = u_j(l·e) f̂_l,   b̂_j = p_j(m·e) q_j(|m⊥|) f̂_m

with u_j, p_j, q_j from `carleman_weights` (Mouhot & Pareschi, Math. Comp. 75, 1833 (2006), eqs. 3.4 to 3.6, where
e = 1 and j takes one value). Two inverse transforms a direction and term, and none forward but that of f.
"""

import numba
import numpy as np

from granstudy.collision.carleman_weights import (
    Product,
    is_separable,
    loss_profile,
    products,
)
from granstudy.collision.operator import check_state
from granstudy.collision.rules import directions
from granstudy.collision.transforms import RealTransforms
from granstudy.collision.workers import SHARES, Workers
from granstudy.grid import VelocityGrid
from granstudy.quadrature import Rule, half
from granstudy.scene import Scene
from granstudy.solver import Solver

BATCH_BYTES = 2**17
"""Small grids are transformed several at a time, one buffer up to this size (it fits a core's cache)."""


class CarlemanOperator:
    """Q(f,f) for constant e: elastic with any kernel, inelastic where the kernel separates.

    The modes |l| < πN/2L take part: the ball keeps isotropy, and leaves out the unpaired mode.

    Raises
    ------
    ValueError
        For a restitution that depends on the impact speed, and for e < 1 but with hard spheres in 3D
        or Maxwell molecules in 2D.
    """

    def __init__(self, scene: Scene, solver: Solver) -> None:
        e = check_scene(scene)
        self.grid = grid = solver.grid(scene.dim)
        self._shape = (grid.N, grid.N if grid.dim == 3 else 1, grid.N)
        modes, self._counts = ball_modes(grid)
        self._starts = np.cumsum(self._counts.ravel()).reshape(self._counts.shape) - self._counts
        l = np.pi / grid.L * modes  # noqa: E741
        length = np.sqrt(np.square(l).sum(axis=1))

        terms = products(scene.kernel, e, grid, float(np.max(length)))
        rule = half_circle_or_quarter(half(directions(scene, solver)), scene, e)
        self._of_l, self._of_m, self._odd, loss = filters(terms, rule, l, length)
        if solver.variant == "separate":
            distinct, place = np.unique(length.round(12), return_inverse=True)
            loss = loss_profile(terms, grid, distinct)[place]
        self._loss = loss
        self.transforms = 2 * len(self._odd) + 2
        self._plan(solver.thread_count)

    def _plan(self, threads: int) -> None:
        """Divide the products, and give every thread its buffers and transforms."""
        count = len(self._odd)
        share = -(-count // SHARES)
        largest = max(1, BATCH_BYTES // (8 * self.grid.N**self.grid.dim))
        # Equal batches: no transform is spent on padding but in the last share.
        self._batch = -(-share // -(-share // largest))
        bounds = [(start, min(start + share, count)) for start in range(0, count, share)]
        self._shares = list(enumerate(bounds))
        self._gains = np.zeros((len(bounds), *self._shape))
        self._single = RealTransforms(1, self._shape)
        self._workers = Workers(threads, lambda: _Workspace(self._batch, self._shape))

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) of a real density."""
        check_state(f, self.grid)
        if np.iscomplexobj(f):
            raise ValueError(f"density has type {f.dtype}: method 'carleman' takes real densities")
        f = np.ascontiguousarray(f, dtype=np.float64).reshape(self._shape)
        f_hat = self._single.forward(f)
        f_hat /= f.size
        list(self._workers.map(lambda share, work: self._sum_share(f_hat, share, work), self._shares))
        Q = self._gains.sum(axis=0)
        filter_modes(
            f_hat, self._loss[None], NEITHER, 1, self._counts, self._starts, self._single.spectrum
        )
        self._single.execute_backward()
        Q -= f * self._single.density[0]
        return Q.reshape(self.grid.shape)

    def _sum_share(
        self, f_hat: np.ndarray, share: tuple[int, tuple[int, int]], work: "_Workspace"
    ) -> None:
        """The gain's sum over one share of the products."""
        index, (start, stop) = share
        gain = self._gains[index]
        gain[...] = 0.0
        for first in range(start, stop, self._batch):
            last = min(first + self._batch, stop)
            odd = self._odd[first:last]
            for transforms, weights, turn in (
                (work.of_l, self._of_l, -1),
                (work.of_m, self._of_m, 1),
            ):
                filter_modes(
                    f_hat,
                    weights[first:last],
                    odd,
                    turn,
                    self._counts,
                    self._starts,
                    transforms.spectrum,
                )
                transforms.execute_backward()
            add_products(work.of_l.density, work.of_m.density, last - first, gain)

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""

        def transform_share(share: tuple[int, tuple[int, int]], work: "_Workspace") -> None:
            for _ in range(*share[1], self._batch):
                work.of_l.execute_backward()
                work.of_m.execute_backward()
            work.of_l.spectrum[...] = 0.0
            work.of_m.spectrum[...] = 0.0

        list(self._workers.map(transform_share, self._shares))


def check_scene(scene: Scene) -> float:
    """The scene's restitution, where this method can do the scene."""
    e = scene.restitution
    if callable(e):
        raise ValueError(f"restitution={e!r}: method 'carleman' takes a constant")
    if e < 1.0 and not is_separable(scene.kernel, scene.dim):
        raise ValueError(
            f"restitution={e!r}, exponent={scene.kernel.exponent!r} in {scene.dim}D: method 'carleman' "
            "takes restitution below 1 only with exponent=1 in 3D or exponent=0 in 2D"
        )
    return float(e)


def ball_modes(grid: VelocityGrid) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumbers (n, d) with |l| < N/2 of the half spectrum, and how many each row (N, N') begins with."""
    k = grid.wavenumbers
    axes = [k] * (grid.dim - 1) + [k[: grid.N // 2 + 1]]
    inside = grid.wavenumber_squared(half=True) < (grid.N // 2) ** 2
    modes = np.stack([a[inside] for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    return modes, inside.sum(axis=-1).reshape(grid.N, -1)


def half_circle_or_quarter(pairs: Rule, scene: Scene, e: float) -> Rule:
    """Half of a rule on the half circle where it has right angles and e = 1: e and e⊥ swap l and m."""
    M = len(pairs)
    if scene.dim == 2 and e == 1.0 and M % 2 == 0 and pairs.degree >= 2 * M - 1:
        return Rule(pairs.points[: M // 2], 2 * pairs.weights[: M // 2], pairs.degree, pairs.name)
    return pairs


def filters(
    terms: list[Product], pairs: Rule, l: np.ndarray, length: np.ndarray  # noqa: E741
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """w_e u_j(l·e) and p_j(m·e) q_j(|m⊥|) on the ball's modes, whether j is odd, and G⁺(−m,m).

    An odd function of l·e times f̂ is −i times the spectrum of a real density, and its partner's i cancels it: see
    `filter_modes`.
    """
    shape = (len(pairs) * len(terms), len(l))
    of_l, of_m, odd, loss = np.empty(shape), np.empty(shape), np.empty(shape[0], bool), 0.0
    row = 0
    for e, w in zip(pairs.points, pairs.weights / 2, strict=True):
        along = l @ e
        beside = np.sqrt(np.maximum(length**2 - along**2, 0.0))
        along, sign = np.abs(along), np.sign(along)
        for term in terms:
            parity = sign if term.odd else 1.0
            of_l[row] = w * parity * term.of_l(along)
            of_m[row] = parity * term.of_m(along) * term.across(beside)
            odd[row] = term.odd
            loss = loss + of_l[row] * of_m[row] * (-1.0 if term.odd else 1.0)
            row += 1
    return of_l, of_m, odd, np.asarray(loss)


NEITHER = np.zeros(1, dtype=bool)
"""Parity of a filter that is even."""


@numba.njit(nogil=True, cache=True)
def filter_modes(f_hat, weights, odd, turn, counts, starts, out):
    """out[b] = weights[b] f̂ on the ball of modes, times i·turn where ``odd[b]``, and 0 elsewhere."""
    nx, ny, nz = f_hat.shape
    for b in range(weights.shape[0]):
        factor = turn * 1j if odd[b] else 1.0 + 0.0j
        for i in range(nx):
            for j in range(ny):
                count = counts[i, j]
                start = starts[i, j]
                if odd[b]:
                    for k in range(count):
                        out[b, i, j, k] = factor * (weights[b, start + k] * f_hat[i, j, k])
                else:
                    for k in range(count):
                        out[b, i, j, k] = weights[b, start + k] * f_hat[i, j, k]
                for k in range(count, nz):
                    out[b, i, j, k] = 0.0


@numba.njit(nogil=True, cache=True, fastmath={"contract"})
def add_products(first, second, count, total):
    """Add first[b]·second[b], b < count, to total; rows are padded, as an in-place transform leaves them."""
    nx, ny, nz = total.shape
    for b in range(count):
        for i in range(nx):
            for j in range(ny):
                for k in range(nz):
                    total[i, j, k] += first[b, i, j, k] * second[b, i, j, k]


class _Workspace:
    """What one thread needs: a batch's transforms for either factor."""

    def __init__(self, batch: int, shape: tuple[int, int, int]) -> None:
        self.of_l = RealTransforms(batch, shape)
        self.of_m = RealTransforms(batch, shape)
