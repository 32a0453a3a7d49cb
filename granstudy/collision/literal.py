"""The paper's recipe, method `literal`: complex transforms, every node of the rule, products on the grid.

Other methods are measured against this one, in digits and in speed. The yardstick is fair: FFTW transforms
are planned on reused buffers, phases are products of stored one-dimensional vectors, NumPy works on whole
arrays, threads share the nodes. Symmetry, pairs ±g and fused loops are left to the method `fast`.
"""

from typing import Any

import numpy as np
import pyfftw

from granstudy.collision.fourier.threads import SHARES, OneAtATime, Workers, planning
from granstudy.collision.protocol import check_state
from granstudy.collision.rules import directions, radial_nodes
from granstudy.collision.weights import alpha, loss_weight, mean_gain, radial_measure
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import Rule
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.sphere import paper_sphere_mean

BATCH = 2**15
"""Grid points transformed together. A small grid takes several nodes at a time."""


class LiteralOperator:
    """Q̂_k = Σ_{ρ,ĝ} w_ρ w_ĝ ρ^{d−1} F(k,ρ,ĝ) FFT[f · IFFT(e^{−iπρ m·ĝ/L} f̂_m)]_k (paper eqs. 43, 46).

    A run advances f̂ itself, as the paper's does, and never projects f on real densities.

    Parameters
    ----------
    sphere : Rule, optional
        Directions, by default the solver's.
    """

    def __init__(self, scene: Scene, solver: SizedSolver, sphere: Rule | None = None) -> None:
        self.grid = grid = solver.grid(scene.dim)
        radial = radial_nodes(scene, solver)
        sphere = directions(scene, solver) if sphere is None else sphere
        self._recipe = scene, solver, sphere
        self._one_at_a_time = OneAtATime()
        measure = radial_measure(scene.kernel, grid.dim, radial.points, radial.weights)
        g = (radial.points[:, None, None] * sphere.points).reshape(-1, grid.dim)
        self.weights = np.outer(measure, sphere.weights).ravel()
        self.shells = np.repeat(np.arange(len(radial)), len(sphere))
        self.shift_phases = phase_factors(grid, -g)

        # For a constant e, F⁺ is a phase times a function of |k|, one function per shell. For a law
        # e(|g·ω|) it is an array per node.
        self.gain_phases, self.F = None, None
        if callable(scene.restitution):
            self.F = np.array(
                [
                    mean_gain(scene.restitution, grid, rho, direction)
                    for rho in radial.points
                    for direction in sphere.points
                ]
            )
        else:
            a = float(alpha(scene.restitution))
            self.gain_phases = phase_factors(grid, a * g)
            k = np.pi / grid.L * np.sqrt(grid.wavenumber_squared())
            self.means = np.array(
                [paper_sphere_mean(grid.dim, a * rho * k) for rho in radial.points]
            )
        self.full = solver.variant == "full"
        self.loss = (
            None
            if self.full
            else loss_weight(
                scene.kernel,
                grid,
                radial.points,
                radial.weights,
                half=False,
                mean=paper_sphere_mean,
            )
        )

        batch = max(1, BATCH // grid.N**grid.dim)
        batches = [slice(i, i + batch) for i in range(0, len(g), batch)]
        self.shares = [batches[i::SHARES] for i in range(SHARES)]
        self.workers = Workers(solver.thread_count, lambda: _BatchBuffers(batch, grid.shape))
        self.transforms = 2 * len(g) + (2 if self.full else 3)

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f), complex where ``f`` is complex."""
        check_state(f, self.grid)
        Q = np.fft.ifftn(self.spectrum(np.fft.fftn(f) / f.size)) * f.size
        return Q if np.iscomplexobj(f) else Q.real

    def spectrum(self, f_hat: np.ndarray) -> np.ndarray:
        """Q̂ from f̂: the rate of change of the spectrum that a run advances."""
        check_state(f_hat, self.grid)
        f = np.fft.ifftn(f_hat) * f_hat.size
        with self._one_at_a_time:
            parts = self.workers.map(
                lambda share, work: self._sum_nodes(f, f_hat, share, work), self.shares
            )
        Q_hat = np.sum(parts, axis=0) / f.size
        if self.loss is not None:
            Q_hat -= np.fft.fftn(f * np.fft.ifftn(self.loss * f_hat))
        return Q_hat

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""

        def transform_share(share: list[slice], work: "_BatchBuffers") -> None:
            # The transforms are unnormalised: of anything else, repeated ones would overflow.
            work.spectrum[...] = 0.0
            for _ in share:
                work.backward()
                work.forward()

        with self._one_at_a_time:
            self.workers.map(transform_share, self.shares)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the operator is made from: the scene, the solver, the directions."""
        return type(self), self._recipe

    def _sum_nodes(
        self, f: np.ndarray, f_hat: np.ndarray, share: list[slice], work: "_BatchBuffers"
    ) -> np.ndarray:
        total = np.zeros(self.grid.shape, dtype=np.complex128)
        for nodes in share:
            count = len(self.weights[nodes])
            spectrum, density = work.spectrum[:count], work.density[:count]
            spectrum[...] = f_hat
            for phases in self.shift_phases:
                spectrum *= phases[nodes]
            work.backward()
            density *= f
            work.forward()
            spectrum *= self._weight(nodes)
            total += spectrum.sum(axis=0)
        return total

    def _weight(self, nodes: slice) -> np.ndarray:
        """w_ρ w_ĝ ρ^{d−1} F(k,ρ,ĝ) of a batch of nodes on the whole spectrum (paper eqs. 42 and 45)."""
        if self.gain_phases is None:
            assert self.F is not None
            F = self.F[nodes]
        else:
            F = self.means[self.shells[nodes]]
            for phases in self.gain_phases:
                F = F * phases[nodes]
        if self.full:
            F = F - 1.0
        return F * self.weights[nodes].reshape(-1, *(1,) * self.grid.dim)


def phase_factors(grid: VelocityGrid, displacements: np.ndarray) -> list[np.ndarray]:
    """Factors of e^{iπ k·x/L} for every displacement x: one array per axis, ready to broadcast."""
    return [
        np.exp(1j * np.pi / grid.L * np.outer(component, grid.wavenumbers)).reshape(
            -1, *(grid.N if i == axis else 1 for i in range(grid.dim))
        )
        for axis, component in enumerate(displacements.T)
    ]


class _BatchBuffers:
    """A batch's densities and spectra, with planned transforms between them, for one thread.

    The transforms are unnormalised.
    """

    def __init__(self, batch: int, shape: tuple[int, ...]) -> None:
        self.density = pyfftw.zeros_aligned((batch, *shape), dtype="complex128")
        self.spectrum = pyfftw.zeros_aligned((batch, *shape), dtype="complex128")
        # FFTW_ESTIMATE: the other planners give different bits from process to process.
        plan = {"axes": tuple(range(1, len(shape) + 1)), "flags": ("FFTW_ESTIMATE",)}
        with planning:
            self.forward = pyfftw.FFTW(self.density, self.spectrum, **plan).execute
            self.backward = pyfftw.FFTW(
                self.spectrum, self.density, direction="FFTW_BACKWARD", **plan
            ).execute
