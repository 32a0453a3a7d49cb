"""The paper's recipe: complex transforms, every node of the rule, products on the grid.

The yardstick for digits and for speed. It is fair (planned FFTW transforms on reused buffers,
vectorised NumPy, threads over nodes) but uses no symmetry, pairing or fusion.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pyfftw

from granstudy.collision.operator import check_state
from granstudy.collision.rules import directions, radial_nodes
from granstudy.collision.variable_restitution import mean_gain
from granstudy.collision.weights import alpha, loss_weight, radial_measure, sphere_mean
from granstudy.scene import Scene
from granstudy.solver import Solver


class LiteralOperator:
    """Q̂_k = Σ_{ρ,ĝ} w_ρ w_ĝ ρ^{d−1} F(k,ρ,ĝ) FFT[f · IFFT(e^{−iπρ m·ĝ/L} f̂_m)]_k (paper eqs. 43, 46).

    The state is complex, as the paper advances f̂ and never projects it on real densities.
    """

    dtype = np.complex128

    def __init__(self, scene: Scene, solver: Solver) -> None:
        self.grid = grid = solver.grid(scene.dim)
        self.scene = scene
        self.variant = solver.variant
        self.radial = radial_nodes(scene, solver)
        self.directions = directions(scene, solver)
        self.measure = radial_measure(
            scene.kernel, grid.dim, self.radial.points, self.radial.weights
        )
        self.F = self._precompute_F()
        self.loss = (
            loss_weight(scene.kernel, grid, self.radial.points, self.radial.weights, half=False)
            if solver.variant == "separate"
            else None
        )
        nodes = [
            (shell, node)
            for shell in range(len(self.radial.points))
            for node in range(len(self.directions.weights))
        ]
        self.shares = [nodes[t :: solver.thread_count] for t in range(solver.thread_count)]
        self.workspaces = [_Workspace(grid.shape) for _ in self.shares]
        self.pool = ThreadPoolExecutor(len(self.shares))
        self.transforms = 2 * len(nodes) + 2 + (2 if self.loss is not None else 0)

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f), complex where ``f`` is complex."""
        check_state(f, self.grid)
        state = np.asarray(f, dtype=np.complex128)
        work = self.workspaces[0]
        f_hat = work.forward(state).copy()
        parts = self.pool.map(
            lambda job: self._sum_nodes(state, f_hat, *job),
            zip(self.shares, self.workspaces, strict=True),
        )
        Q = work.backward(sum(parts)).copy()
        if self.loss is not None:
            Q -= state * work.backward(self.loss * f_hat)
        return Q if np.iscomplexobj(f) else Q.real

    def _sum_nodes(
        self, f: np.ndarray, f_hat: np.ndarray, share: list[tuple[int, int]], work: "_Workspace"
    ) -> np.ndarray:
        total = np.zeros(self.grid.shape, dtype=np.complex128)
        for shell, node in share:
            rho, direction = self.radial.points[shell], self.directions.points[node]
            np.copyto(work.spectrum, f_hat)
            for phase in self._phases(-rho * direction):
                work.spectrum *= phase
            work.backward()
            work.density *= f
            work.forward()
            work.spectrum *= self._weight(shell, node)
            total += work.spectrum
        return total

    def _phases(self, shift: np.ndarray) -> Iterator[np.ndarray]:
        """One-dimensional factors of e^{iπ k·shift/L}, ready to broadcast."""
        for axis, component in enumerate(shift):
            phase = np.exp(1j * np.pi / self.grid.L * component * self.grid.wavenumbers)
            yield phase.reshape([-1 if i == axis else 1 for i in range(self.grid.dim)])

    def _precompute_F(self) -> list[Any]:
        """What the weights need: the mean of F⁺'s phase a shell, or for e(|g·ω|) all F⁺, a node."""
        grid, restitution = self.grid, self.scene.restitution
        if callable(restitution):
            return [
                [mean_gain(restitution, grid, rho, ghat) for ghat in self.directions.points]
                for rho in self.radial.points
            ]
        scale = np.pi * float(alpha(restitution)) / grid.L
        k = np.sqrt(grid.wavenumber_squared())
        return [sphere_mean(grid.dim, scale * rho * k) for rho in self.radial.points]

    def _weight(self, shell: int, node: int) -> np.ndarray:
        """w_ρ w_ĝ ρ^{d−1} F(k,ρ,ĝ) on the whole spectrum (paper eqs. 42 and 45)."""
        restitution = self.scene.restitution
        if callable(restitution):
            F = self.F[shell][node]
        else:
            F = self.F[shell]
            shift = self.radial.points[shell] * self.directions.points[node]
            for phase in self._phases(float(alpha(restitution)) * shift):
                F = F * phase
        if self.variant == "full":
            F = F - 1.0
        return F * (self.measure[shell] * self.directions.weights[node])


class _Workspace:
    """Buffers and plans of one thread."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.density = pyfftw.empty_aligned(shape, dtype="complex128")
        self.spectrum = pyfftw.empty_aligned(shape, dtype="complex128")
        axes = tuple(range(len(shape)))
        # FFTW_ESTIMATE: the other planners give different bits from process to process.
        plan = {"axes": axes, "flags": ("FFTW_ESTIMATE",)}
        self._forward = pyfftw.FFTW(self.density, self.spectrum, **plan)
        self._backward = pyfftw.FFTW(
            self.spectrum, self.density, direction="FFTW_BACKWARD", **plan
        )

    def forward(self, density: np.ndarray | None = None) -> np.ndarray:
        """Transform ``density``, or what the buffer holds, to plain Fourier coefficients."""
        if density is not None:
            self.density[...] = density
        self._forward.execute()
        self.spectrum /= self.spectrum.size
        return self.spectrum

    def backward(self, spectrum: np.ndarray | None = None) -> np.ndarray:
        """Transform ``spectrum``, or what the buffer holds, back to the grid."""
        if spectrum is not None:
            self.spectrum[...] = spectrum
        self._backward.execute()
        return self.density
