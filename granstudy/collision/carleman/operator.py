"""The Carleman form: products of two filtered densities, no sum over shells (docs/method.md §8).

    Q⁺(v) = Σ_{±e} w_e Σ_j a_j(v) b_j(v),   â_j = u_j(l·e) f̂_l,   b̂_j = p_j(m·e) q_j(|m⊥|) f̂_m

with u_j, p_j, q_j from `carleman_weights`. At e = 1 with hard spheres in 3D or Maxwell molecules in 2D j is
one value (Mouhot & Pareschi, Math. Comp. 75, 1833 (2006); Wu, White, Scanlon, Reese & Zhang, J. Comput.
Phys. 250, 27 (2013)). Two inverse transforms a pair ±e and product, none forward but that of f.
"""

from dataclasses import dataclass

import numba
import numpy as np

from granstudy.collision.carleman.scenes import check_scene
from granstudy.collision.carleman.weights import Product, loss_profile, mirrored, products
from granstudy.collision.fourier.fftw import BACKWARD, alternate, execute
from granstudy.collision.fourier.threads import SHARES, Workers
from granstudy.collision.fourier.transforms import RealTransforms
from granstudy.collision.protocol import check_state
from granstudy.collision.rules import directions
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.quadrature import Rule, half
from granstudy.velocity.cartesian import VelocityGrid


class CarlemanOperator:
    """Q(f,f) for constant e: elastic with any kernel, inelastic where the kernel separates.

    The modes |l| < N/2 take part: the ball keeps isotropy, and leaves out the unpaired mode. The ``full``
    loss has the gain's own directions and products, so that mass is conserved to round-off; the ``separate``
    one integrates over directions to convergence.

    Raises
    ------
    ValueError
        For a restitution that depends on the impact speed, and for e < 1 but with hard spheres in 3D
        or Maxwell molecules in 2D.
    """

    def __init__(self, scene: Scene, solver: Solver) -> None:
        e = check_scene(scene)
        self.grid = grid = solver.grid(scene.dim)
        # Arrays have three axes in both dimensions, the second of length 1 in 2D.
        self._shape = (grid.N, grid.N if grid.dim == 3 else 1, grid.N)
        wavenumbers, self._counts = ball_modes(grid)
        self._starts = np.cumsum(self._counts.ravel()).reshape(self._counts.shape) - self._counts
        k2, place = np.unique(np.square(wavenumbers).sum(axis=1), return_inverse=True)
        k = np.pi / grid.L * np.sqrt(k2)
        terms = products(scene.kernel, e, grid, float(k[-1]))
        rule = half_rule(scene, solver)
        self._filters = tabulate(terms, rule, np.pi / grid.L * wavenumbers)
        self._loss = (
            self._filters.loss if solver.variant == "full" else loss_profile(terms, grid, k)[place]
        )
        self.transforms = 2 * len(self._filters.odd) + 2
        self._plan(solver.thread_count)

    def _plan(self, threads: int) -> None:
        """Divide the products, and give every thread its buffers and transforms."""
        count = len(self._filters.odd)
        share = -(-count // SHARES)
        bounds = [(start, min(start + share, count)) for start in range(0, count, share)]
        self._shares = list(enumerate(bounds))
        self._gains = np.empty((len(bounds), *self._shape))
        self._single = RealTransforms(self._shape)
        self._workers = Workers(threads, lambda: _Workspace(self._shape))

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) of a real density."""
        check_state(f, self.grid)
        if np.iscomplexobj(f):
            raise ValueError(f"density has type {f.dtype}: method 'carleman' takes real densities")
        f = np.ascontiguousarray(f, dtype=np.float64).reshape(self._shape)
        f_hat = self._single.forward(f)
        f_hat /= f.size
        self._workers.map(lambda share, work: self._sum_share(f_hat, share, work), self._shares)
        Q = self._gains.sum(axis=0)
        filter_modes(f_hat, self._loss, False, 1, self._counts, self._starts, self._single.spectrum)
        self._single.execute_backward()
        Q -= f * self._single.density
        return Q.reshape(self.grid.shape)

    def _sum_share(
        self, f_hat: np.ndarray, share: tuple[int, tuple[int, int]], work: "_Workspace"
    ) -> None:
        """The gain's sum over one share of the products."""
        index, (start, stop) = share
        sum_products(
            f_hat,
            self._filters.of_l[start:stop],
            self._filters.of_m[start:stop],
            self._filters.odd[start:stop],
            self._counts,
            self._starts,
            work.of_l.spectrum,
            work.of_m.spectrum,
            work.of_l.rows,
            work.of_m.rows,
            work.of_l.plans,
            work.of_m.plans,
            self._gains[index].reshape(-1, self.grid.N),
        )

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""

        def transform_share(share: tuple[int, tuple[int, int]], work: "_Workspace") -> None:
            start, stop = share[1]
            alternate(work.of_l.plans, BACKWARD, work.of_m.plans, BACKWARD, stop - start)
            work.of_l.spectrum[...] = 0.0
            work.of_m.spectrum[...] = 0.0

        self._single.execute_forward()
        self._workers.map(transform_share, self._shares)
        self._single.execute_backward()


def ball_modes(grid: VelocityGrid) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumbers (n, d) with |l| < N/2 of the half spectrum, and how many each row (N, N') begins with."""
    k = grid.wavenumbers
    axes = [k] * (grid.dim - 1) + [k[: grid.N // 2 + 1]]
    inside = grid.wavenumber_squared(half=True) < (grid.N // 2) ** 2
    modes = np.stack([a[inside] for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    return modes, inside.sum(axis=-1).reshape(grid.N, -1)


def half_rule(scene: Scene, solver: Solver) -> Rule:
    """One of each pair ±e; at e = 1 in 2D one of each four where the rule has right angles.

    There x and y, and with them l and m, play the same part, so that e⊥ gives what e gives.
    """
    pairs = half(directions(scene, solver))
    if scene.dim == 2 and scene.restitution == 1.0 and solver.M_cir % 4 == 0:
        quarter = slice(solver.M_cir // 4)
        return Rule(pairs.points[quarter], 2 * pairs.weights[quarter], pairs.degree, pairs.name)
    return pairs


@dataclass(frozen=True)
class Filters:
    """The filters of l and m on the ball's modes, a row a direction and product, and the loss weight.

    A real odd function of l·e times f̂ is the spectrum of i times a real density. ``odd`` tells where both
    filters are odd; they take factors −i and i, which leaves their product as it is.
    """

    of_l: np.ndarray
    of_m: np.ndarray
    odd: np.ndarray
    loss: np.ndarray


def tabulate(terms: list[Product], rule: Rule, modes: np.ndarray) -> Filters:
    """w_e u_j(l·e), p_j(m·e) q(|m⊥|) and G⁻(m) = G⁺(−m,m) with this rule, which conserves mass.

    ``modes`` (n, d) are l and m in units of 1/velocity.
    """
    shape = (len(rule), len(terms), len(modes))
    of_l, of_m = np.empty(shape), np.empty(shape)
    loss = np.zeros(len(modes))
    square = np.square(modes).sum(axis=1)
    # ∫_{−r}^{r} dρ has both of ±e: the integral is over half a sphere
    for i, (e, w) in enumerate(zip(rule.points, rule.weights / 2, strict=True)):
        along = modes @ e
        beside = np.sqrt(np.maximum(square - along**2, 0.0))
        along, sign = np.abs(along), np.sign(along)
        for j, term in enumerate(terms):
            parity = sign if term.odd else 1.0
            of_l[i, j] = w * parity * term.of_l(along)
            of_m[i, j] = parity * term.of_m(along) * term.across(beside)
            loss += w * mirrored(term, along, beside)
    odd = np.tile([term.odd for term in terms], len(rule))
    return Filters(of_l.reshape(-1, len(modes)), of_m.reshape(-1, len(modes)), odd, loss)


@numba.njit(nogil=True, cache=True)
def filter_modes(f_hat, weights, odd, turn, counts, starts, out):
    """Out = weights f̂ on the ball of modes, times i·turn where ``odd``, and 0 elsewhere."""
    nx, ny, nz = f_hat.shape
    factor = turn * 1j if odd else 1.0 + 0.0j
    for i in range(nx):
        for j in range(ny):
            count = counts[i, j]
            start = starts[i, j]
            if odd:
                for k in range(count):
                    out[i, j, k] = factor * (weights[start + k] * f_hat[i, j, k])
            else:
                for k in range(count):
                    out[i, j, k] = weights[start + k] * f_hat[i, j, k]
            for k in range(count, nz):
                out[i, j, k] = 0.0


@numba.njit(nogil=True, cache=True, fastmath={"contract"})
def add_product(first, second, total):
    """Add first·second to total (n n', n); rows of both are padded by in-place transforms."""
    rows, n = total.shape
    for j in range(rows):
        for k in range(n):
            total[j, k] += first[j, k] * second[j, k]


@numba.njit(nogil=True, cache=True)
def sum_products(
    f_hat, of_l, of_m, odd, counts, starts, a_spectrum, b_spectrum, a, b, a_plans, b_plans, gain
):
    """Gain (n n', n) = Σ ab, where a and b are transformed from f̂ times the filters of l and of m."""
    gain[:] = 0.0
    for i in range(len(odd)):
        filter_modes(f_hat, of_l[i], odd[i], -1, counts, starts, a_spectrum)
        execute(a_plans, BACKWARD)
        filter_modes(f_hat, of_m[i], odd[i], 1, counts, starts, b_spectrum)
        execute(b_plans, BACKWARD)
        add_product(a, b, gain)


class _Workspace:
    """What one thread needs: transforms of either factor."""

    def __init__(self, shape: tuple[int, int, int]) -> None:
        self.of_l = RealTransforms(shape)
        self.of_m = RealTransforms(shape)
