"""Temperature of VHS gases: cooling rate of a density of given shape, Haff's law, heated steady state."""

import numpy as np
from scipy.special import gamma

from granstudy.model.kernel import VHS
from granstudy.theory.broadcast import Result, over_arrays
from granstudy.theory.checks import check_restitution
from granstudy.velocity.space import check_dim
from granstudy.velocity.sphere import sphere_area

MAXWELL_COOLING = "exponent=0: Maxwell molecules cool exponentially; Haff's law needs λ > 0"
"""Message of the error for λ = 0."""


@over_arrays(Result("cooling coefficient K of a Gaussian, T' = −ρK T^{1+λ/2}", "$K$"))
def gaussian_cooling_coefficient(kernel: VHS, restitution: float, dim: int) -> float:
    """K of dT/dt = −K T^{1+λ/2} for a Gaussian of unit density.

    The energy falls as dE/dt = −(1−e²)/16 · |S| C_λ ⟨|g|^{2+λ}⟩ (paper eq. 23; the mean of σ·ĝ is 0). The
    relative velocities of a Gaussian are those of a Gaussian of temperature 2T, so that
    ⟨|g|^p⟩ = (2T)^{p/2} 2^{p/2} Γ((d+p)/2)/Γ(d/2).
    """
    p = 2.0 + kernel.exponent
    moment = 2.0**p * gamma((dim + p) / 2) / gamma(dim / 2)
    area = sphere_area(dim)
    return (1.0 - restitution**2) / (8.0 * dim) * area * kernel.strength * moment


@over_arrays(Result("cooling rate over that of a Gaussian", "$K/K_0$"), native=True)
def cooling_correction(exponent: float, a2: float, a3: float = 0.0) -> float:
    """Cooling rate of f = Gaussian × (1 + a2 S_2 + a3 S_3) over that of the Gaussian of the same temperature.

    In first order of a2 and a3 the ratio is 1 + λ(λ+2)/16 a2 − λ(λ+2)(λ−2)/192 a3, in 2D and in 3D. The
    relative velocity has the coefficients a2/2 and a3/4, and ⟨|g|^p⟩ over that of a Gaussian is
    1 + binom(p/2, 2) a2/2 − binom(p/2, 3) a3/4 at p = 2+λ (docs/theory.md §3). For hard spheres the ratio
    is 1 + 3a2/16 + a3/64 (T. van Noije & M. Ernst, Granular Matter 1, 57 (1998); N. Brilliantov & T.
    Pöschel, Europhys. Lett. 74, 424 (2006)).
    """
    k = exponent * (exponent + 2.0)
    return 1.0 + k / 16.0 * a2 - k * (exponent - 2.0) / 192.0 * a3


@over_arrays(Result("constant C0 of Haff's law", "$C_0$"))
def haff_constant(
    kernel: VHS,
    restitution: float,
    dim: int,
    T0: float = 1.0,
    a2: float = 0.0,
    density: float = 1.0,
) -> float:
    """C0 of Haff's law T = T0 (1 + C0 t)^{−2/λ} for a gas of fixed shape, ε = 0 and λ > 0.

    C0 = (λ/2) ρK T0^{λ/2}. K is that of `gaussian_cooling_coefficient`, times the `cooling_correction` of
    the shape's kurtosis excess ``a2``. For B = |g|/(4π), ρ = 1 and a Gaussian, C0 is
    0.3761 (1−e²) √T0.

    Raises
    ------
    ValueError
        If λ = 0, where cooling is exponential.
    """
    lam = kernel.exponent
    if lam == 0.0:
        raise ValueError(MAXWELL_COOLING)
    K = gaussian_cooling_coefficient(kernel, restitution, dim) * cooling_correction(lam, a2)
    return 0.5 * lam * density * K * T0 ** (lam / 2)


@over_arrays(Result("temperature by Haff's law", "$T$"), native=True)
def haff_temperature(
    t: np.ndarray | float, T0: float, C0: float, exponent: float = 1.0
) -> np.ndarray:
    """Haff's law T = T0 (1 + C0 t)^{−2/λ}, by default for hard spheres.

    The law solves dT/dt = −(2/λ) C0 T0^{−λ/2} T^{1+λ/2} (P. Haff, J. Fluid Mech. 134, 401 (1983)).

    Raises
    ------
    ValueError
        If λ = 0, where cooling is exponential.
    """
    if np.any(np.asarray(exponent) == 0.0):
        raise ValueError(MAXWELL_COOLING)
    return T0 * (1.0 + C0 * np.asarray(t, dtype=float)) ** (-2.0 / exponent)


@over_arrays(Result("steady temperature of the heated gas", "$T$"))
def heated_temperature(
    kernel: VHS,
    restitution: float,
    dim: int,
    diffusion: float,
    a2: float = 0.0,
    density: float = 1.0,
) -> float:
    """Steady temperature of a gas heated by diffusion: 2ε = ρK T^{1+λ/2}.

    K is that of `gaussian_cooling_coefficient`, times the `cooling_correction` of the kurtosis excess
    ``a2``. For Maxwell molecules the temperature is exact, 8ε/((1−e²)ρ|S|C). For other kernels it is that
    of a Gaussian, or to first order in a2.

    Raises
    ------
    ValueError
        If ε ≤ 0 or e is not in [0, 1), where no temperature is steady, or the dimension is not 2 or 3.
    """
    check_dim(dim)
    check_restitution(restitution)
    if restitution == 1.0:
        raise ValueError("restitution=1.0: must be below 1, as elastic collisions take no energy")
    if not diffusion > 0.0:
        raise ValueError(f"diffusion={diffusion!r}: must be positive for a heated steady state")
    lam = kernel.exponent
    K = gaussian_cooling_coefficient(kernel, restitution, dim) * cooling_correction(lam, a2)
    return float((2.0 * diffusion / (density * K)) ** (2.0 / (2.0 + lam)))
