"""Exact moments and tail of the states that Maxwell molecules approach: cooling, and heated.

The Fourier transform f̂(k) = ∫e^{−ik·v} f dv of an isotropic density is a function of x = |k|²/2. Let
ν = ρ|S|C_0, ρ = 1, α = (1+e)/4 and y = (1−μ)/2, μ the cosine of the angle of σ and k. Then (A. Bobylev,
Sov. Sci. Rev. C 7, 111 (1988); M. Ernst & R. Brito, J. Stat. Phys. 109, 407 (2002); docs/theory.md §2)

    ∂t f̂(x) + 2εx f̂ = ν [⟨f̂(ax) f̂(bx)⟩ − f̂(x)],    a = 1 − 4α(1−α)y,  b = 4α²y.

The moments μ_n of f̂ = Σ_n (−x)^n μ_n/n! are ⟨|v|^{2n}⟩ over their values for a Gaussian of T = 1. They obey

    μ_n' = ν [G_n − r_n μ_n] + 2nε μ_{n−1},
    G_n = Σ_{j=1}^{n−1} binom(n,j) ⟨a^j b^{n−j}⟩ μ_j μ_{n−j},    r_n = 1 − ⟨a^n⟩ − ⟨b^n⟩,

with μ_1 = T, r_1 = (1−e²)/4. In Sonine coefficients, μ_2/T² = 1 + a2 and μ_3/T³ = 1 + 3a2 − a3.
"""

from math import comb

import numpy as np
import scipy
from scipy.special import gamma, gammaln, hyp2f1, roots_jacobi

from granstudy.theory.broadcast import Result, over_arrays
from granstudy.theory.checks import check_restitution
from granstudy.velocity.space import check_dim

LARGE = 1e4
"""s from which on ⟨a^s⟩ and ⟨b^s⟩ are taken at large s; ₂F₁ loses its digits near 10⁶."""


@over_arrays(
    Result("moments μ_n/T^n of the cooling state of Maxwell molecules", r"$\mu_n/T^n$", ("order",))
)
def maxwell_cooling_moments(order: int, restitution: float, dim: int) -> np.ndarray:
    """μ_n/T^n, n = 0..order, of the cooling state (ε = 0); inf from the first moment on that diverges.

    With μ_n ~ T^n the equation of μ_n becomes (r_n − n r_1) μ_n = G_n. Where r_n ≤ n r_1, μ_n/T^n grows
    without bound, and 2n is at least the exponent of `maxwell_tail_exponent`. The moment n = 2 never
    diverges: a2 is finite for every e.

    Raises
    ------
    ValueError
        If e is not a number in [0, 1], the dimension is not 2 or 3, or the order is below 1.
    """
    moments = _first_moments(order, restitution, dim)
    r1 = (1.0 - restitution**2) / 4.0
    for n in range(2, order + 1):
        G, r = _gain_and_decay(moments, n, restitution, dim)
        if r <= n * r1:
            moments[n:] = np.inf
            break
        moments[n] = G / (r - n * r1)
    return moments


@over_arrays(
    Result("moments μ_n/T^n of the heated state of Maxwell molecules", r"$\mu_n/T^n$", ("order",))
)
def maxwell_heated_moments(order: int, restitution: float, dim: int) -> np.ndarray:
    """μ_n/T^n, n = 0..order, of the steady state with heating, 2ε = r_1 νT. All moments are finite.

    They solve r_n μ_n = G_n + n r_1 μ_{n−1}. At e = 1 no state is steady, and the moments are those of the
    limit e → 1, a Gaussian.

    Raises
    ------
    ValueError
        If e is not a number in [0, 1], the dimension is not 2 or 3, or the order is below 1.
    """
    moments = _first_moments(order, restitution, dim)
    r1 = (1.0 - restitution**2) / 4.0
    for n in range(2, order + 1):
        G, r = _gain_and_decay(moments, n, restitution, dim)
        moments[n] = (G + n * r1 * moments[n - 1]) / r
    return moments


@over_arrays(
    Result("kurtosis excess a2", "$a_2$", name="a2"),
    Result("Sonine coefficient a3", "$a_3$", name="a3"),
    core={"moments": ("order",)},
)
def sonine_coefficients(moments: np.ndarray) -> tuple[float, float]:
    """a2 and a3 from μ_n/T^n, n = 0..3 at least: a2 = μ_2 − 1, a3 = 1 + 3a2 − μ_3."""
    a2 = moments[2] - 1.0
    return float(a2), float(1.0 + 3.0 * a2 - moments[3])


@over_arrays(Result("exponent p of the tail |v|^(−d−p) of Maxwell molecules", "$p$"))
def maxwell_tail_exponent(restitution: float, dim: int) -> float:
    """Exponent p of the cooling state's tail f ~ |v|^{−d−p}: ⟨|v|^q⟩ is finite for q < p alone.

    A term x^s of f̂(xT(t)), s not an integer, makes the tail |v|^{−d−2s} (P. Krapivsky & E. Ben-Naim, J.
    Phys. A 35, L147 (2002); M. Ernst & R. Brito, Europhys. Lett. 58, 182 (2002)). The equation of f̂, to
    first order in this term and with other factors at x = 0, gives

        r_s = 1 − ⟨a^s⟩ − ⟨b^s⟩ = s r_1,    p = 2s,    s > 1.

    r_s − s r_1 is concave in s: 0 at s = 1, positive at 2, negative at 1/r_1. One root lies between 2 and
    1/r_1. At e = 1 the tail is no power, and p is inf.

    Raises
    ------
    ValueError
        If e is not a number in [0, 1], or the dimension is not 2 or 3.
    """
    check_dim(dim)
    check_restitution(restitution)
    r1 = (1.0 - restitution**2) / 4.0
    if r1 == 0.0:
        return float("inf")
    s = scipy.optimize.brentq(
        lambda s: decay_rate(s, restitution, dim) - s * r1, 2.0, 1.0 / r1, xtol=1e-13
    )
    return 2.0 * float(s)


def decay_rate(s: float, restitution: float, dim: int) -> float:
    """r_s = 1 − ⟨a^s⟩ − ⟨b^s⟩ for real s > 0.

    y has the Beta(δ, δ) distribution on (0, 1), δ = (d−1)/2. With z = 4α(1−α), ⟨y^s⟩ = (δ)_s/(2δ)_s and
    ⟨(1 − zy)^s⟩ = ₂F₁(−s, δ; 2δ; z). For large s both are those of y near 0, ⟨y^s⟩ = s^{−δ} Γ(2δ)/Γ(δ) and
    ⟨(1 − zy)^s⟩ = (zs)^{−δ} Γ(2δ)/Γ(δ), up to a relative 1/s.
    """
    alpha, delta = (1.0 + restitution) / 4.0, (dim - 1) / 2
    z = 4 * alpha * (1 - alpha)
    if s > LARGE:
        a_mean = z**-delta
        b_mean = np.exp(2 * s * np.log(2 * alpha))
        return float(1.0 - (a_mean + b_mean) * s**-delta * gamma(2 * delta) / gamma(delta))
    pochhammers = gammaln(delta + s) - gammaln(delta) - gammaln(2 * delta + s) + gammaln(2 * delta)
    b_mean = np.exp(2 * s * np.log(2 * alpha) + pochhammers)
    return float(1.0 - hyp2f1(-s, delta, 2 * delta, z) - b_mean)


def _first_moments(order: int, restitution: float, dim: int) -> np.ndarray:
    """An array for the moments, in which μ_0 = 1 and μ_1/T = 1 are already right."""
    check_dim(dim)
    check_restitution(restitution)
    if order < 1:
        raise ValueError(f"order={order!r}: must be at least 1")
    return np.ones(order + 1)


def _gain_and_decay(
    moments: np.ndarray, n: int, restitution: float, dim: int
) -> tuple[float, float]:
    """G_n from the moments below n, and r_n. Gauss–Jacobi rules for the means are exact to degree n in y."""
    alpha, delta = (1.0 + restitution) / 4.0, (dim - 1) / 2
    nodes, weights = roots_jacobi(n // 2 + 1, delta - 1, delta - 1)
    y, w = (1.0 - nodes) / 2.0, weights / weights.sum()
    a, b = 1.0 - 4 * alpha * (1 - alpha) * y, 4 * alpha**2 * y
    G = sum(
        comb(n, j) * (w @ (a**j * b ** (n - j))) * moments[j] * moments[n - j] for j in range(1, n)
    )
    return float(G), float(1.0 - w @ (a**n + b**n))
