"""The Carleman form: products of two filtered densities, no sum over shells (docs/method.md §8).

    Q⁺(v) = Σ_{±e} w_e Σ_j a_j(v) b_j(v),   â_j = u_j(l·e) f̂_l,   b̂_j = p_j(m·e) q_j(|m⊥|) f̂_m

The functions u_j, p_j, q_j come from `granstudy.collision.carleman.weights`. One product is enough at e = 1
with hard spheres in 3D or Maxwell molecules in 2D (Mouhot & Pareschi, Math. Comp. 75, 1833 (2006); Wu, White,
Scanlon, Reese & Zhang, J. Comput. Phys. 250, 27 (2013)). Every product takes two inverse transforms
for each pair ±e; f alone is transformed forward.
"""

from typing import Any

import numpy as np

from granstudy.collision.carleman.filters import ball_modes, half_rule, tabulate
from granstudy.collision.carleman.loops import filter_modes, sum_products
from granstudy.collision.carleman.scenes import check_scene
from granstudy.collision.carleman.weights import loss_profile, products
from granstudy.collision.fourier.fftw import BACKWARD, alternate
from granstudy.collision.fourier.threads import SHARES, Bounds, OneAtATime, Workers, split
from granstudy.collision.fourier.transforms import RealTransforms
from granstudy.collision.protocol import check_state
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import Rule


class CarlemanOperator:
    """Q(f,f) for a constant e: elastic with any kernel, inelastic where the kernel separates.

    The modes |l| < N/2 take part. This ball of modes is isotropic, and excludes the unpaired mode.

        variant    loss                                            mass
        full       the gain's directions and products              conserved to round-off
        separate   integrated over directions to convergence       conserved as far as the gain has converged

    Parameters
    ----------
    rule : Rule, optional
        One direction of each pair ±e, by default of the solver's rule (`half_rule`).

    Raises
    ------
    ValueError
        If the restitution depends on the impact speed, or e < 1 and the kernel is neither hard spheres in 3D
        nor Maxwell molecules in 2D.
    """

    def __init__(self, scene: Scene, solver: SizedSolver, rule: Rule | None = None) -> None:
        e = check_scene(scene)
        self.grid = grid = solver.grid(scene.dim)
        self._shape = grid.three_axis_shape
        wavenumbers, self._counts = ball_modes(grid)
        self._starts = np.cumsum(self._counts.ravel()).reshape(self._counts.shape) - self._counts
        k2, place = np.unique(np.square(wavenumbers).sum(axis=1), return_inverse=True)
        k = np.pi / grid.L * np.sqrt(k2)
        terms = products(scene.kernel, e, grid, float(k[-1]))
        rule = half_rule(scene, solver) if rule is None else rule
        self._recipe = scene, solver, rule
        self._one_at_a_time = OneAtATime()
        self._filters = tabulate(terms, rule, np.pi / grid.L * wavenumbers)
        self._loss = (
            self._filters.loss if solver.variant == "full" else loss_profile(terms, grid, k)[place]
        )
        self.transforms = 2 * len(self._filters.odd) + 2
        self._plan(solver.thread_count)

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) of a real density."""
        check_state(f, self.grid)
        if np.iscomplexobj(f):
            raise ValueError(f"density has type {f.dtype}: method 'carleman' takes real densities")
        f = np.ascontiguousarray(f, dtype=np.float64).reshape(self._shape)
        with self._one_at_a_time:
            f_hat = self._single.forward(f)
            f_hat /= f.size
            self._workers.map(lambda share, work: self._sum_share(f_hat, share, work), self._shares)
            Q = self._gains.sum(axis=0)
            filter_modes(
                f_hat, self._loss, False, 1, self._counts, self._starts, self._single.spectrum
            )
            self._single.execute_backward()
            Q -= f * self._single.density
        return Q.reshape(self.grid.shape)

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""

        def transform_share(share: tuple[int, Bounds], work: "_FactorBuffers") -> None:
            start, stop = share[1]
            alternate(work.of_l.plans, BACKWARD, work.of_m.plans, BACKWARD, stop - start)
            work.of_l.spectrum[...] = 0.0
            work.of_m.spectrum[...] = 0.0

        with self._one_at_a_time:
            self._single.execute_forward()
            self._workers.map(transform_share, self._shares)
            self._single.execute_backward()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the operator is made from: the scene, the solver, the directions."""
        return type(self), self._recipe

    @property
    def fftw_wisdom(self) -> str:
        """Hash of the wisdom that FFTW planned with; "" where it had none."""
        return self._single.wisdom

    def _plan(self, threads: int) -> None:
        """Divide the products into shares, and give every thread its buffers and transforms."""
        self._shares = list(enumerate(split(len(self._filters.odd), SHARES)))
        self._gains = np.empty((len(self._shares), *self._shape))
        self._single = RealTransforms(self._shape)
        self._workers = Workers(threads, lambda: _FactorBuffers(self._shape))

    def _sum_share(
        self, f_hat: np.ndarray, share: tuple[int, Bounds], work: "_FactorBuffers"
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


class _FactorBuffers:
    """Transforms of the two factors of a product, for one thread."""

    def __init__(self, shape: tuple[int, int, int]) -> None:
        self.of_l = RealTransforms(shape)
        self.of_m = RealTransforms(shape)
