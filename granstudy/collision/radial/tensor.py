"""The collision operator of isotropic densities as a bilinear form in their values at N speeds.

The formulas, with their derivation, are in docs/method.md §7.
"""

from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
from scipy.special import roots_legendre

from granstudy.collision.radial.interpolation import POINTS, SPACING, averaged_weights
from granstudy.collision.weights import alpha
from granstudy.quadrature import radial_rule
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.sphere import sphere_area, sphere_mean

SPARE_NODES = 24
"""Quadrature nodes beyond those that resolve an oscillation; from there on rules converge at once."""

ROUND = 8
"""Rules of the angle have a multiple of so many nodes, so that neighbouring modes share one."""


def unit_tensor(
    dim: int, N: int, exponent: float, restitution: float, threads: int = 1
) -> np.ndarray:
    """T of Q(f,f)(r_i) = Σ_{j≤l} T[jl, i] f_j f_l for R = 1 and C_λ = 1.

    For any R and C_λ the tensor is C_λ R^{d+λ} T: one array serves every box and every strength of the
    kernel.

    Returns
    -------
    ndarray, shape (N(N+1)/2, N)
        A row for every pair j ≤ l, in the order of ``numpy.triu_indices(N)``. A row with j < l holds the
        sum of both orders.
    """
    grid = RadialGrid(dim, N, R=1.0)
    C = mode_tensor(grid, exponent, restitution, threads)
    # From the coefficients c_n, c_m of two densities to their values f_j, f_l: c = analysis · f.
    T = np.tensordot(grid.analysis, C, axes=(0, 0))  # (j, m, i)
    T = np.tensordot(grid.analysis, T, axes=(0, 1))  # (l, j, i)
    T -= mass_correction(grid, T)
    rows, columns = np.triu_indices(N)
    packed = T[rows, columns] + T[columns, rows]
    packed[rows == columns] /= 2.0
    return packed


def mode_tensor(
    grid: RadialGrid, exponent: float, restitution: float, threads: int = 1
) -> np.ndarray:
    """C[n, m, i] = ½[q_nm + q_mn](r_i): Q at the nodes for the pair of modes M(k_n|v|), M(k_m|v|).

    l and m are two wavevectors of lengths k_n and k_m, μ is the cosine of their angle, k = |l+m|. With the
    weight G = G⁺ − G⁻ of docs/method.md §2,

        q_nm(r) = ⟨G(l,m) M(k r)⟩_μ,   G⁺ = H(αk, |m−α(l+m)|),   G⁻ = H(0, |m|),
        H(a, b) = |S|² ∫_0^R ρ^{d−1+λ} M(aρ) M(bρ) dρ,
        k² = l²+m²+2lmμ,   |m−α(l+m)|² = (1−α)m² + αl² − α(1−α)k².

    H does not depend on e. H and M(k r) are interpolated on tables (`.interpolation`).

    Shape (N, N, N).
    """
    H, waves = shell_table(grid, exponent), wave_table(grid)
    loss, k, a = loss_values(grid, exponent), grid.wavenumbers, float(alpha(restitution))
    C = np.empty((grid.N, grid.N, grid.N))

    def fill(n: int) -> None:
        mu, w = angle_rule(grid, n)
        weights = averaged_weights(k, n, a, mu, w, H, loss, grid.R, grid.L, len(waves))
        C[n, n:] = C[n:, n] = weights @ waves

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(fill, range(grid.N)))
    return C


def shell_table(grid: RadialGrid, exponent: float) -> np.ndarray:
    """H(a, b) at a, b = (j − POINTS/2) SPACING/R, up to the largest wavenumber and what a stencil needs."""
    p, w_p = shell_rule(grid, exponent)
    M = sphere_mean(grid.dim, np.multiply.outer(_stencilled(grid.wavenumbers[-1], 1.0 / grid.R), p))
    return np.ascontiguousarray((M * w_p) @ M.T)


def wave_table(grid: RadialGrid) -> np.ndarray:
    """M(k r_i) at k = (j − POINTS/2) SPACING/L, up to twice the largest wavenumber."""
    k = _stencilled(2.0 * grid.wavenumbers[-1], 1.0 / grid.L)
    return sphere_mean(grid.dim, np.multiply.outer(k, grid.nodes))


def loss_values(grid: RadialGrid, exponent: float) -> np.ndarray:
    """H(0, k_m) of every mode."""
    p, w_p = shell_rule(grid, exponent)
    return sphere_mean(grid.dim, np.multiply.outer(grid.wavenumbers, p)) @ w_p


def _stencilled(largest: float, unit: float) -> np.ndarray:
    """Equally spaced arguments from −POINTS/2 steps on to beyond ``largest``. H and M are even."""
    count = int(largest / (SPACING * unit)) + POINTS + 2
    return SPACING * unit * (np.arange(count) - POINTS // 2)


def shell_rule(grid: RadialGrid, exponent: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes ρ and weights |S|² w_ρ ρ^{d−1+λ}, so many that G is exact to round-off.

    The integrand's phase reaches R(αk + |m−α(l+m)|) ≤ 2Rk_N. A Gauss rule in ρ² needs a quarter as many
    nodes.
    """
    power = grid.dim - 1 + exponent
    count = SPARE_NODES + int(0.5 * grid.R * grid.wavenumbers[-1] * 1.1)
    rule = radial_rule(count, grid.R, "jacobi", power)
    return rule.points, sphere_area(grid.dim) ** 2 * rule.weights * rule.points**power


def angle_rule(grid: RadialGrid, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Cosines μ and weights of the mean over the angle of two wavevectors, the shorter one of length k_n.

    The rule is Gauss–Legendre in 3D, Gauss–Chebyshev in 2D. In θ = arccos μ the integrand's phase
    rk + R(αk + |m−α(l+m)|) changes by at most (L + R) k_n. Gauss rules need half as many nodes.
    """
    count = SPARE_NODES + int(0.5 * (grid.L + grid.R) * grid.wavenumbers[n] * 1.1)
    return _mean_over_angles(grid.dim, -(-count // ROUND) * ROUND)


@cache
def _mean_over_angles(dim: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    if dim == 3:
        mu, w = roots_legendre(count)
        return mu, w / 2.0
    mu = np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return mu, np.full(count, 1.0 / count)


def mass_correction(grid: RadialGrid, T: np.ndarray) -> np.ndarray:
    """The multiple of the lowest mode that has the mass Σ_i w_i T[.., i] of T[.., i].

    Without the correction mass is lost or gained through the tails of f at r = L and their images beyond.
    With it Σ_i w_i Q_i vanishes to round-off for every f.
    """
    lowest = sphere_mean(grid.dim, grid.wavenumbers[0] * grid.nodes)
    return np.multiply.outer(T @ grid.weights, lowest / (grid.weights @ lowest))
