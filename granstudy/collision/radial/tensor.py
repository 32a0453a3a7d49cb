"""The collision operator of isotropic densities as a bilinear form in their values at N speeds.

The formulas, with their derivation, are in docs/method.md §7.
"""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from granstudy.collision.weights import alpha
from granstudy.quadrature import radial_rule
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.sphere import sphere_area, sphere_mean

SPARE_NODES = 24
"""Quadrature nodes beyond those that resolve an oscillation; from there on rules converge at once."""


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

        q_nm(r) = ⟨G(l,m) M(k r)⟩_μ,
        G⁺ = |S|² ∫_0^R ρ^{d−1+λ} M(αkρ) M(|m−α(l+m)|ρ) dρ,   G⁻ = |S|² ∫_0^R ρ^{d−1+λ} M(|m|ρ) dρ,
        k² = l²+m²+2lmμ,   |m−α(l+m)|² = (1−α)m² + αl² − α(1−α)k².

    Shape (N, N, N).
    """
    C = np.empty((grid.N, grid.N, grid.N))

    def fill(n: int) -> None:
        C[n, n:] = C[n:, n] = mode_products(grid, n, exponent, restitution)

    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(fill, range(grid.N)))
    return C


def mode_products(grid: RadialGrid, n: int, exponent: float, restitution: float) -> np.ndarray:
    """½[q_nm + q_mn](r_i) for mode n and all m ≥ n, shape (N−n, N)."""
    a = float(alpha(restitution))
    p, w_p = shell_rule(grid, exponent)
    mu, w_mu = angle_rule(grid, n)
    l, m = grid.wavenumbers[n], grid.wavenumbers[n:, None]  # noqa: E741
    k2 = l**2 + m**2 + 2.0 * l * m * mu  # (m, μ)
    k = np.sqrt(np.maximum(k2, 0.0))
    shift = a * (1.0 - a) * k2
    # |m−α(l+m)| and, with the two modes exchanged, |l−α(l+m)|.
    s_m = np.sqrt(np.maximum((1.0 - a) * m**2 + a * l**2 - shift, 0.0))
    s_l = np.sqrt(np.maximum((1.0 - a) * l**2 + a * m**2 - shift, 0.0))

    def mean(x: np.ndarray) -> np.ndarray:
        return sphere_mean(grid.dim, np.multiply.outer(x, p))

    gain = (mean(a * k) * (mean(s_m) + mean(s_l))) @ w_p
    loss = (mean(m) + mean(l)) @ w_p
    G = 0.5 * (gain - loss) * w_mu
    waves = sphere_mean(grid.dim, np.multiply.outer(k, grid.nodes))  # (m, μ, i)
    return np.einsum("mu,mui->mi", G, waves)


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
    if grid.dim == 3:
        mu, w = np.polynomial.legendre.leggauss(count)
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
