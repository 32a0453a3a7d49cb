"""Exact and asymptotic laws of the homogeneous granular gas, each with its source."""

import numpy as np
from scipy.special import gamma

from granstudy.kernel import VHS, sphere_area


def maxwell_temperature(
    t: np.ndarray | float,
    T0: float,
    restitution: float,
    diffusion: float = 0.0,
    density: float = 1.0,
    cross_section: float = 1.0,
) -> np.ndarray:
    """Exact temperature of Maxwell molecules, T = (T0 − T∞) e^{−rt} + T∞ with r = (1−e²)/4 · ρ|S|C.

    From dT/dt = 2ε − (1−e²)/4 · ρ|S|C · T (paper eqs. 24 to 28; docs/method.md §4), in any dimension and
    for any density; T∞ = 2ε/r is 8ε/(1−e²) at ρ = |S|C = 1. At e = 1, T = T0 + 2εt.

    Parameters
    ----------
    cross_section : float
        |S^{d−1}| C_0: the kernel's strength times 2π (2D) or 4π (3D).
    """
    rate = (1.0 - restitution**2) / 4.0 * density * cross_section
    t = np.asarray(t, dtype=float)
    if rate == 0.0:
        return T0 + 2.0 * diffusion * t
    # T∞ (1 − e^{−rt}) in a form that holds as r → 0, where T∞ is beyond all bounds.
    return T0 * np.exp(-rate * t) - 2.0 * diffusion * np.expm1(-rate * t) / rate


def maxwell_anisotropy_rate(
    restitution: float, dim: int, density: float = 1.0, cross_section: float = 1.0
) -> float:
    """Exact decay rate of the traceless pressure tensor of Maxwell molecules, 2α(1−α) in 2D and 3D.

    One collision takes P_ij of the pair to P − α(1−α)·2gg/2 + isotropic part, as the mean of σσ over the
    sphere is isotropic and that of σ vanishes: v'v' + v*'v*' − vv − v*v* = −2α(1−α)·(gg − ..), so
    the traceless part of ½∫∫ decays at 2α(1−α)·ρ|S|C in any dimension (docs/method.md §4).
    """
    if dim not in (2, 3):
        raise ValueError(f"dim={dim!r}: allowed are 2 and 3")
    a = (1.0 + restitution) / 4.0
    return 2.0 * a * (1.0 - a) * density * cross_section


def gaussian_cooling_coefficient(kernel: VHS, restitution: float, dim: int) -> float:
    """K of dT/dt = −K T^{1+λ/2} for a Gaussian of unit density.

    From dE/dt = −(1−e²)/16 · |S| C_λ ⟨|g|^{2+λ}⟩ (paper eq. 23, the mean of σ·ĝ being 0) with the relative
    velocity of a Gaussian of temperature 2T: ⟨|g|^p⟩ = (2T)^{p/2} 2^{p/2} Γ((d+p)/2)/Γ(d/2).
    """
    p = 2.0 + kernel.exponent
    moment = 2.0**p * gamma((dim + p) / 2) / gamma(dim / 2)
    area = sphere_area(dim)
    return (1.0 - restitution**2) / (8.0 * dim) * area * kernel.strength * moment


def haff_constant(
    kernel: VHS, restitution: float, dim: int, T0: float = 1.0, a2: float = 0.0
) -> float:
    """C0 of Haff's law T = T0 (1 + C0 t)^{−2/λ} for a gas of fixed shape, ε = 0 and λ > 0.

    C0 = (λ/2) K T0^{λ/2} with K of `gaussian_cooling_coefficient`; 0.3761 (1−e²) √T0 for B = |g|/(4π).
    ``a2`` is the shape's kurtosis excess: in first order ⟨|g|³⟩ takes the factor 1 + 3a2/16
    (van Noije & Ernst, Granular Matter 1, 57 (1998)), known for hard spheres in 3D.

    Raises
    ------
    ValueError
        For λ = 0, where cooling is exponential, or ``a2`` with another kernel than 3D hard spheres.
    """
    lam = kernel.exponent
    if lam == 0.0:
        raise ValueError("exponent=0: Maxwell molecules cool exponentially; Haff's law needs λ > 0")
    if a2 != 0.0 and (dim != 3 or lam != 1.0):
        raise ValueError(f"a2={a2!r}: the correction is known for hard spheres in 3D only")
    K = gaussian_cooling_coefficient(kernel, restitution, dim)
    return 0.5 * lam * K * T0 ** (lam / 2) * (1.0 + 3.0 * a2 / 16.0)


def haff_temperature(t: np.ndarray | float, T0: float, C0: float) -> np.ndarray:
    """Haff's law for hard spheres, T = T0 (1 + C0 t)^{−2} (P. Haff, J. Fluid Mech. 134, 401 (1983))."""
    return T0 * (1.0 + C0 * np.asarray(t, dtype=float)) ** -2


def cooling_state_a2(restitution: float) -> float:
    """Kurtosis excess of the homogeneous cooling state of hard spheres in 3D, linear theory.

    a2 = 16(1−e)(1−2e²)/(81−17e+30e²(1−e)) (van Noije & Ernst, Granular Matter 1, 57 (1998)). The theory
    drops a2²: compare with it, do not expect equality.
    """
    e = restitution
    return 16 * (1 - e) * (1 - 2 * e**2) / (81 - 17 * e + 30 * e**2 * (1 - e))


def heated_state_a2(restitution: float) -> float:
    """Kurtosis excess of the steady state of hard spheres in 3D heated by diffusion, linear theory.

    a2 = 16(1−e)(1−2e²)/(241−177e+30e²(1−e)) (van Noije & Ernst, Granular Matter 1, 57 (1998)).
    """
    e = restitution
    return 16 * (1 - e) * (1 - 2 * e**2) / (241 - 177 * e + 30 * e**2 * (1 - e))
