"""Exact moment equations of Maxwell molecules, any density in 2D and 3D, heated or not.

The moments are central. Momentum is conserved, so that u = 0 may be assumed. With ν = ρ|S|C_0 and α = (1+e)/4
(docs/theory.md §1):

    T' = −r_1 νT + 2ε                                                  r_1 = 2α(1−2α) = (1−e²)/4
    P_ij' = ν [−2α(1−α) P_ij + 2α²/d P_kk δ_ij] + 2ερ δ_ij             P_ij = ∫v_i v_j f dv
    M_ijk' = ν [−3α(1−α) M_ijk + α²/d (s_i δ_jk + s_j δ_ik + s_k δ_ij)]    M_ijk = ∫v_i v_j v_k f, s_i = M_ikk
    M' = −r_2 νM + |S|C_0 [c_1 P_ii P_jj + c_2 P_ij P_ij] + 4(d+2) ε P_ii     M = ∫|v|⁴ f
"""

from typing import NamedTuple

import numpy as np
import scipy

from granstudy.theory.broadcast import Result, over_arrays
from granstudy.theory.checks import check_restitution, check_tensor
from granstudy.velocity.space import check_dim


class MomentRates(NamedTuple):
    """Time derivatives of the central moments of a density."""

    pressure: np.ndarray
    """d/dt of ∫v_i v_j f, shape (d, d)"""
    third: np.ndarray
    """d/dt of ∫v_i v_j v_k f, shape (d, d, d)"""
    fourth: float
    """d/dt of ∫|v|⁴ f"""


@over_arrays(
    Result("rate of ∫v_i v_j f", r"$\dot P$", ("component", "component_"), "pressure"),
    Result(
        "rate of ∫v_i v_j v_k f",
        r"$\dot M_{ijk}$",
        ("component", "component_", "component__"),
        "third",
    ),
    Result("rate of ∫|v|⁴ f", r"$\dot M$", name="fourth"),
    core={
        "pressure": ("component", "component_"),
        "third": ("component", "component_", "component__"),
    },
)
def maxwell_moment_rates(
    density: float,
    pressure: np.ndarray,
    third: np.ndarray,
    fourth: float,
    restitution: float,
    diffusion: float = 0.0,
    cross_section: float = 1.0,
) -> MomentRates:
    """Exact time derivatives of the central moments up to fourth order (equations at the module's head).

    Parameters
    ----------
    density : float
        ρ.
    pressure, third : array_like, shapes (d, d) and (d, d, d)
        ∫v_i v_j f and ∫v_i v_j v_k f about u.
    fourth : float
        ∫|v|⁴ f about u.
    cross_section : float
        |S^{d−1}| C_0: the kernel's strength times 2π (2D) or 4π (3D).

    Raises
    ------
    ValueError
        If e is not a number in [0, 1], or a tensor is not of its order in 2D or 3D.
    """
    P, M3 = check_tensor("pressure", pressure, 2), check_tensor("third", third, 3)
    check_restitution(restitution)
    d, a, nu = len(P), (1.0 + restitution) / 4.0, density * cross_section
    unit, trace = np.eye(d), np.trace(P)

    P_rate = (
        nu * (-2 * a * (1 - a) * P + 2 * a**2 / d * trace * unit) + 2 * diffusion * density * unit
    )
    M3_rate = nu * (-3 * a * (1 - a) * M3 + a**2 / d * _vector_part(np.einsum("ikk", M3)))
    r2, c1, c2 = _fourth_coefficients(restitution, d)
    sources = c1 * trace**2 + c2 * np.sum(P * P)
    M_rate = -r2 * nu * fourth + cross_section * sources + 4 * (d + 2) * diffusion * trace
    return MomentRates(P_rate, M3_rate, float(M_rate))


@over_arrays(Result("exact temperature of Maxwell molecules", "$T$"), native=True)
def maxwell_temperature(
    t: np.ndarray | float,
    T0: float,
    restitution: float,
    diffusion: float = 0.0,
    density: float = 1.0,
    cross_section: float = 1.0,
) -> np.ndarray:
    """Exact temperature of Maxwell molecules, T = (T0 − T∞) e^{−rt} + T∞ with r = (1−e²)/4 · ρ|S|C.

    T solves dT/dt = 2ε − (1−e²)/4 · ρ|S|C · T (paper eqs. 24 to 28; docs/method.md §4), in any dimension
    and for any density. T∞ = 2ε/r is 8ε/(1−e²) at ρ = |S|C = 1. At e = 1 the temperature is T0 + 2εt.

    Parameters
    ----------
    cross_section : float
        |S^{d−1}| C_0: the kernel's strength times 2π (2D) or 4π (3D).
    """
    rate = (1.0 - restitution**2) / 4.0 * density * cross_section
    t = np.asarray(t, dtype=float)
    elastic = np.asarray(rate) == 0.0
    if elastic.all():
        return T0 + 2.0 * diffusion * t
    # T∞ (1 − e^{−rt}) in a form that holds for r → 0, where T∞ grows without bound.
    r = np.where(elastic, 1.0, rate) if elastic.ndim else rate
    T = T0 * np.exp(-r * t) - 2.0 * diffusion * np.expm1(-r * t) / r
    return np.where(elastic, T0 + 2.0 * diffusion * t, T) if elastic.any() else T


@over_arrays(Result("decay rate of the traceless pressure of Maxwell molecules", "$r$"))
def maxwell_anisotropy_rate(
    restitution: float, dim: int, density: float = 1.0, cross_section: float = 1.0
) -> float:
    """Exact decay rate 2α(1−α)·ρ|S|C of the traceless pressure tensor of Maxwell molecules, 2D and 3D.

    Write v' = w + α|g|σ with w = (1−α)v + αv*. The mean over σ of v'v' is ww plus a multiple of the unit
    tensor. The cross terms of ww integrate to 0, so that (1−α)² + α² − 1 = −2α(1−α) remains
    (docs/theory.md §1).
    """
    check_dim(dim)
    a = (1.0 + restitution) / 4.0
    return 2.0 * a * (1.0 - a) * density * cross_section


@over_arrays(
    Result("exact pressure tensor of Maxwell molecules", "$P$", ("component", "component_")),
    core={"pressure": ("component", "component_")},
)
def maxwell_pressure(
    t: np.ndarray | float,
    pressure: np.ndarray,
    restitution: float,
    diffusion: float = 0.0,
    density: float = 1.0,
    cross_section: float = 1.0,
) -> np.ndarray:
    """Exact pressure tensor at the times t, shape t.shape + (d, d), from the pressure tensor at t = 0.

    P_ij = ρT δ_ij + D_ij. T follows `maxwell_temperature`, D_ij decays at `maxwell_anisotropy_rate`.

    Raises
    ------
    ValueError
        If e is not a number in [0, 1], or a tensor is not of its order in 2D or 3D.
    """
    T0, D0 = _split(pressure, density)
    check_restitution(restitution)
    t = np.asarray(t, dtype=float)[..., None, None]
    T = maxwell_temperature(t, T0, restitution, diffusion, density, cross_section)
    rate = maxwell_anisotropy_rate(restitution, len(D0), density, cross_section)
    return density * T * np.eye(len(D0)) + D0 * np.exp(-rate * t)


@over_arrays(
    Result(
        "exact third moments of Maxwell molecules",
        "$M_{ijk}$",
        ("component", "component_", "component__"),
    ),
    core={"third": ("component", "component_", "component__")},
)
def maxwell_third_moments(
    t: np.ndarray | float,
    third: np.ndarray,
    restitution: float,
    density: float = 1.0,
    cross_section: float = 1.0,
) -> np.ndarray:
    """Exact ∫v_i v_j v_k f about u at the times t, shape t.shape + (d, d, d), with or without heating.

    s_i = M_ikk is twice the heat flux. Two parts of M_ijk decay at rates of their own:

        (s_i δ_jk + s_j δ_ik + s_k δ_ij)/(d+2)      ν[3α(1−α) − α²(d+2)/d]
        the rest, which is traceless                ν·3α(1−α)

    Raises
    ------
    ValueError
        If e is not a number in [0, 1], or a tensor is not of its order in 2D or 3D.
    """
    M3 = check_tensor("third", third, 3)
    check_restitution(restitution)
    d, a, nu = len(M3), (1.0 + restitution) / 4.0, density * cross_section
    t = np.asarray(t, dtype=float)[..., None, None, None]
    vector = _vector_part(np.einsum("ikk", M3)) / (d + 2)
    rate = 3 * a * (1 - a)
    vector_rate = rate - a**2 * (d + 2) / d
    return (M3 - vector) * np.exp(-rate * nu * t) + vector * np.exp(-vector_rate * nu * t)


@over_arrays(
    Result("exact kurtosis excess of Maxwell molecules", "$a_2$", ("time",)),
    core={"t": ("time",), "pressure": ("component", "component_")},
)
def maxwell_a2(
    t: np.ndarray,
    pressure: np.ndarray,
    a2: float,
    restitution: float,
    diffusion: float = 0.0,
    density: float = 1.0,
    cross_section: float = 1.0,
) -> np.ndarray:
    """Exact kurtosis excess at the times t from the pressure tensor and a2 at t = 0.

    The equation of M at the head of this module for 1 + a2 = M/(d(d+2)ρT²), with Δ_ij = P_ij/(ρT) − δ_ij,

        a2' = ν [2⟨ab⟩ + c_2 Δ_ij Δ_ij/(d(d+2)) − (r_2 − 2r_1)(1 + a2)] − 4ε/T a2.

    T and Δ are known in closed form. The equation, linear in a2, is integrated to 1e-11. As an equation for
    the quotient it keeps its accuracy however far T has fallen.

    Parameters
    ----------
    t : array_like, shape (n,)
        Times from 0 on, increasing.
    pressure : array_like, shape (d, d)
        ∫v_i v_j f about u at t = 0.
    a2 : float
        d/(d+2) ⟨|v−u|⁴⟩/⟨|v−u|²⟩² − 1 at t = 0.

    Raises
    ------
    ValueError
        If t is not as stated, e is not a number in [0, 1], or the temperature is not positive, or
        underflows by the last time.
    """
    times = np.asarray(t, dtype=float)
    if times.ndim != 1 or times.size == 0 or times[0] < 0.0 or np.any(np.diff(times) <= 0.0):
        raise ValueError(f"t={t!r}: must be times from 0 on, one or more, increasing")
    T0, D0 = _split(pressure, density)
    if not T0 > 0.0:
        raise ValueError(f"pressure: temperature {T0!r} must be positive")
    check_restitution(restitution)
    if maxwell_temperature(times[-1], T0, restitution, diffusion, density, cross_section) == 0.0:
        raise ValueError(f"t={t!r}: the last temperature is below the smallest number there is")
    d, nu = len(D0), density * cross_section
    r1 = (1.0 - restitution**2) / 4.0
    r2, c1, c2 = _fourth_coefficients(restitution, d)
    isotropic = (c1 * d + c2) / (d + 2)  # 2⟨ab⟩, docs/theory.md §2
    anisotropic = c2 * np.sum(D0**2) / (density**2 * d * (d + 2))
    anisotropy_rate = maxwell_anisotropy_rate(restitution, d, density, cross_section)

    def slope(s: float, a2: np.ndarray) -> np.ndarray:
        T = maxwell_temperature(s, T0, restitution, diffusion, density, cross_section)
        source = isotropic + anisotropic * (np.exp(-anisotropy_rate * s) / T) ** 2
        return nu * (source - (r2 - 2 * r1) * (1 + a2)) - 4 * diffusion / T * a2

    if times[-1] == 0.0:
        return np.array([float(a2)])
    run = scipy.integrate.solve_ivp(
        slope, (0.0, times[-1]), [a2], "LSODA", times, rtol=1e-12, atol=1e-13
    )
    if not run.success:
        raise ValueError(f"t={t!r}: a2 could not be integrated that far: {run.message}")
    return run.y[0]


def _fourth_coefficients(restitution: float, dim: int) -> tuple[float, float, float]:
    """r_2, c_1, c_2 of the equation of M, from the mean of |v'|⁴ over σ (docs/theory.md §1)."""
    alpha = (1.0 + restitution) / 4.0
    product, squares = alpha * (1 - alpha), alpha**2 + (1 - alpha) ** 2
    kappa = 2 * (dim + 2) / dim * alpha**2
    r2 = 1.0 - alpha**4 - (1 - alpha) ** 4 - kappa * squares - 2 * alpha**4
    c1 = 2 * product**2 + kappa * squares + 2 * alpha**4
    c2 = 4 * product**2 - 4 * kappa * product + 4 * alpha**4
    return r2, c1, c2


def _split(pressure: np.ndarray, density: float) -> tuple[float, np.ndarray]:
    """Temperature and traceless part of a pressure tensor."""
    P = check_tensor("pressure", pressure, 2)
    mean = np.trace(P) / len(P)
    return float(mean / density), P - mean * np.eye(len(P))


def _vector_part(s: np.ndarray) -> np.ndarray:
    """s_i δ_jk + s_j δ_ik + s_k δ_ij."""
    outer = np.multiply.outer(s, np.eye(len(s)))
    return outer + outer.transpose(1, 0, 2) + outer.transpose(1, 2, 0)
