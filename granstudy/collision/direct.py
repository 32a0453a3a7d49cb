"""The direct method: Q̂_k = Σ_{l+m=k} G(l,m) f̂_l f̂_m from exact angular weights, O(N^{2d}).

Angles are integrated exactly, so that the other methods are measured against this one. Storage stays below
O(N^{2d}), as the gain weight depends on few scalars (docs/method.md §2):

    restitution             gain weight G⁺ depends on
    constant e              |k|, |m−αk|
    law e(|g·ω|)            |k|, |m|, the angle of k and m

`Solver.circular` makes it the paper's direct method, down to how the paper's code evaluates sinc.
"""

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from scipy.special import eval_legendre, jv, spherical_jn

from granstudy.collision.protocol import check_state
from granstudy.collision.rules import converged_radial, radial_nodes
from granstudy.collision.weights import (
    RestitutionLaw,
    SphereMean,
    alpha,
    largest_phase,
    law_values,
    loss_weight,
    mean_phase,
    radial_measure,
)
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import Rule
from granstudy.support.compiled import compiled
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.sphere import paper_sphere_mean, sphere_area, sphere_mean

DEGREE = 5
"""Degree of the piecewise polynomials in |m−αk| that the gain weight is tabulated with."""

CELL = 0.05
"""Length of a polynomial's cell, in units of 1/R: the error is about 1e-15 of the largest weight."""


class DirectOperator:
    """Q(f,f) as the sum over all pairs of modes."""

    transforms = 2

    def __init__(self, scene: Scene, solver: SizedSolver) -> None:
        self.grid = grid = solver.grid(scene.dim)
        self._recipe = scene, solver
        self.circular = solver.circular
        self.radial = (
            converged_radial(scene, grid) if solver.N_rho is None else radial_nodes(scene, solver)
        )
        self.measure = radial_measure(
            scene.kernel, grid.dim, self.radial.points, self.radial.weights
        )
        mean = paper_sphere_mean if solver.circular else sphere_mean
        self.loss = loss_weight(
            scene.kernel, grid, self.radial.points, self.radial.weights, half=False, mean=mean
        ).reshape(grid.three_axis_shape)
        axes = [grid.wavenumbers[:length] for length in grid.three_axis_shape]
        self.modes = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=1)
        self.threads = solver.thread_count
        self._weight: GainTable | GainSeries
        if callable(scene.restitution):
            self._weight = GainSeries(scene.restitution, grid, self.radial, self.measure)
        else:
            self._weight = GainTable(
                float(scene.restitution), grid, self.radial, self.measure, mean
            )

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f), of the type of ``f``."""
        check_state(f, self.grid)
        f_hat = np.fft.fftn(f).reshape(self.grid.three_axis_shape) / f.size
        Q_hat = np.zeros(f_hat.size, dtype=np.complex128)
        k2 = np.square(self.modes).sum(axis=1)
        groups = [np.flatnonzero(k2 == value) for value in np.unique(k2)]

        def sum_group(group: np.ndarray) -> None:
            self._weight.sum(self.modes, group, f_hat, self.loss, self.circular, Q_hat)

        with ThreadPoolExecutor(self.threads) as pool:
            list(pool.map(sum_group, groups))
        Q = np.fft.ifftn(Q_hat.reshape(self.grid.shape)) * f.size
        return Q if np.iscomplexobj(f) else Q.real

    def transform(self) -> None:
        """Make the two transforms of one call and nothing else, for benchmarks."""
        np.fft.ifftn(np.fft.fftn(np.zeros(self.grid.shape)))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the operator is made from: the scene and the solver."""
        return type(self), self._recipe


class GainTable:
    """Gain weight for a constant e, tabulated in |m−αk| for one |k| at a time.

    G⁺ = |S|² C_λ Σ_ρ w_ρ ρ^{d−1+λ} mean(ρα|k|) mean(ρ|m−αk|), with the mean of e^{iσ·x} over the sphere.
    """

    def __init__(
        self, e: float, grid: VelocityGrid, radial: Rule, measure: np.ndarray, mean: SphereMean
    ) -> None:
        self.alpha = float(alpha(e))
        self.unit = np.pi / grid.L
        self.radii = radial.points
        self.measure = sphere_area(grid.dim) * measure
        self.dim = grid.dim
        largest = self.unit * np.sqrt(grid.dim) * grid.N / 2 * (1 + self.alpha)
        self.width = CELL / grid.R
        cells = int(largest / self.width) + 2
        # Chebyshev points of every cell, and the matrix from values there to coefficients.
        t = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
        self.to_coefficients = np.linalg.inv(np.vander(t, increasing=True))
        s = (np.arange(cells)[:, None] + (t + 1) / 2) * self.width
        self.mean = mean
        self.means = mean(grid.dim, s.ravel()[:, None] * self.radii)

    def sum(
        self,
        modes: np.ndarray,
        group: np.ndarray,
        f_hat: np.ndarray,
        loss: np.ndarray,
        circular: bool,
        Q_hat: np.ndarray,
    ) -> None:
        """Fill Q̂ at the modes of ``group``, which share one |k|."""
        k = self.unit * np.sqrt(float(np.square(modes[group[0]]).sum()))
        profile = self.means @ (self.measure * self.mean(self.dim, self.alpha * k * self.radii))
        table = profile.reshape(-1, DEGREE + 1) @ self.to_coefficients.T
        scale = self.unit / self.width
        _sum_table(modes, group, f_hat, loss, circular, self.alpha, scale, table, Q_hat)


class GainSeries:
    """Gain weight for a law e(|g·ω|), a series in the angle of k and m for one |k| at a time.

    With `mean_phase` = Σ_l a_l P_l(k̂·ĝ), every term is integrated over ĝ in closed form:

        3D   ∫e^{−iρm·ĝ} P_l(k̂·ĝ) dĝ = 4π (−i)^l j_l(ρ|m|) P_l(k̂·m̂)
        2D   ∫e^{−iρm·ĝ} cos lθ dĝ = 2π (−i)^l J_l(ρ|m|) cos lθ_m, θ and θ_m the angles from k
    """

    def __init__(
        self,
        restitution: RestitutionLaw,
        grid: VelocityGrid,
        radial: Rule,
        measure: np.ndarray,
    ) -> None:
        self.dim = grid.dim
        self.unit = np.pi / grid.L
        self.radial = radial
        self.measure = sphere_area(grid.dim) * measure
        m2 = np.unique(grid.wavenumber_squared())
        self.place = np.full(int(m2[-1]) + 1, -1)
        self.place[m2] = np.arange(len(m2))
        largest = self.unit * np.sqrt(float(m2[-1])) * grid.R
        self.degrees = np.arange(int(largest) + 40)
        bessel = jv if grid.dim == 2 else spherical_jn
        x = self.unit * np.sqrt(m2)[:, None, None] * radial.points[:, None]
        self.bessel = bessel(self.degrees, x)  # (m2, shells, degrees)
        count = len(self.degrees) + 8
        if grid.dim == 2:
            theta = np.pi * (np.arange(count) + 0.5) / count
            self.mu = np.cos(theta)
            basis = np.cos(np.outer(self.degrees, theta))
            self.project = basis * np.where(self.degrees == 0, 1.0, 2.0)[:, None] / count
        else:
            self.mu, w = np.polynomial.legendre.leggauss(count)
            basis = eval_legendre(self.degrees[:, None], self.mu)
            self.project = basis * (self.degrees[:, None] + 0.5) * w
        # The law is asked here and not at each call: it may have changed by then.
        self.laws = {
            int(k2): law_values(
                restitution, grid.dim, radial.points[:, None], largest_phase(*self._parts(int(k2)))
            )
            for k2 in m2
        }

    def _parts(self, k2: int) -> tuple[np.ndarray, np.ndarray]:
        """K∥ and K⊥ at all radii and angles, for one |k|²."""
        scaled = self.radial.points[:, None] * (self.unit * np.sqrt(float(k2)))
        return scaled * self.mu, scaled * np.sqrt(np.maximum(1 - self.mu**2, 0.0))

    def sum(
        self,
        modes: np.ndarray,
        group: np.ndarray,
        f_hat: np.ndarray,
        loss: np.ndarray,
        circular: bool,
        Q_hat: np.ndarray,
    ) -> None:
        """Fill Q̂ at the modes of ``group``, which share one |k|."""
        k2 = int(np.square(modes[group[0]]).sum())
        phase = mean_phase(self.laws[k2], self.dim, *self._parts(k2))
        a = phase @ self.project.T * (-1j) ** self.degrees  # (shells, degrees)
        series = np.einsum("s,sl,msl->ml", self.measure, a, self.bessel).real.copy()
        _sum_series(modes, group, f_hat, loss, circular, self.dim, series, self.place, Q_hat)


@compiled()
def _sum_table(modes, group, f_hat, loss, circular, alpha, scale, table, Q_hat):
    """Σ_m [table(|m−αk|) − loss_m] f̂_{k−m} f̂_m for each k of the group."""
    nx, ny, nz = f_hat.shape
    for p in group:
        kx, ky, kz = modes[p]
        px, py, pz = _partners(modes[p], f_hat.shape, circular)
        total = 0.0 + 0.0j
        for i in range(nx):
            for j in range(ny):
                if px[i] < 0 or py[j] < 0:
                    continue
                mx, my = _wavenumber(i, nx), _wavenumber(j, ny)
                across = (mx - alpha * kx) ** 2 + (my - alpha * ky) ** 2
                partner = f_hat[px[i], py[j]]
                for k in range(nz):
                    if pz[k] < 0:
                        continue
                    s = scale * np.sqrt(across + (_wavenumber(k, nz) - alpha * kz) ** 2)
                    cell = int(s)
                    t = 2.0 * (s - cell) - 1.0
                    c = table[cell]
                    weight = ((((c[5] * t + c[4]) * t + c[3]) * t + c[2]) * t + c[1]) * t + c[0]
                    total += (weight - loss[i, j, k]) * (partner[pz[k]] * f_hat[i, j, k])
        Q_hat[p] = total


@compiled()
def _sum_series(modes, group, f_hat, loss, circular, dim, series, place, Q_hat):
    """Σ_m [Σ_l series[|m|², l] P_l(k̂·m̂) − loss_m] f̂_{k−m} f̂_m for each k of the group.

    In 2D cos lθ stands for P_l.
    """
    nx, ny, nz = f_hat.shape
    for p in group:
        kx, ky, kz = modes[p]
        px, py, pz = _partners(modes[p], f_hat.shape, circular)
        total = 0.0 + 0.0j
        for i in range(nx):
            for j in range(ny):
                if px[i] < 0 or py[j] < 0:
                    continue
                mx, my = _wavenumber(i, nx), _wavenumber(j, ny)
                partner = f_hat[px[i], py[j]]
                for k in range(nz):
                    if pz[k] < 0:
                        continue
                    mz = _wavenumber(k, nz)
                    m2 = mx * mx + my * my + mz * mz
                    length = np.sqrt(float(m2 * (kx * kx + ky * ky + kz * kz)))
                    mu = (kx * mx + ky * my + kz * mz) / length if length > 0.0 else 1.0
                    weight = _sum_polynomials(dim, series[place[m2]], mu)
                    total += (weight - loss[i, j, k]) * (partner[pz[k]] * f_hat[i, j, k])
        Q_hat[p] = total


@compiled(forceinline=True)
def _partners(mode, shape, circular):
    """FFT indices of k − m for all m, one array per axis; −1 where k − m lies outside the spectrum."""
    return (
        _axis_partners(mode[0], shape[0], circular),
        _axis_partners(mode[1], shape[1], circular),
        _axis_partners(mode[2], shape[2], circular),
    )


@compiled(forceinline=True)
def _axis_partners(k, N, circular):
    """FFT index of k − m for the N wavenumbers m of one axis; −1 where k − m lies outside the spectrum."""
    out = np.empty(N, np.int64)
    for i in range(N):
        difference = k - _wavenumber(i, N)
        inside = -(N // 2) <= difference < (N + 1) // 2
        out[i] = difference % N if inside or circular else -1
    return out


@compiled(forceinline=True)
def _wavenumber(i, N):
    """Wavenumber at FFT index i of N."""
    return i if i < (N + 1) // 2 else i - N


@compiled(forceinline=True)
def _sum_polynomials(dim, coefficients, mu):
    """Σ_l coefficients[l] P_l(mu) by the three-term recurrence; in 2D T_l(mu) = cos lθ for P_l."""
    before, now = 1.0, mu
    total = coefficients[0]
    for degree in range(1, coefficients.size):
        total += coefficients[degree] * now
        if dim == 2:
            before, now = now, 2.0 * mu * now - before
        else:
            before, now = now, ((2 * degree + 1) * mu * now - degree * before) / (degree + 1)
    return total
