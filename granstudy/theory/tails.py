"""Tails of the cooling and the heated state, exp(−A c^λ) and exp(−B c^{1+λ/2}) with c = |v|/√T.

A grain far faster than the rest collides ρ|S|C_λ |v|^λ times per unit time. Collisions bring fewer grains to
such speeds than they take, by a power of c, and their gain is left out. The equations of the cooling state
f = T^{−d/2} g(c) and of the heated state are then (S. Esipov & T. Pöschel, J. Stat. Phys. 86, 1385 (1997);
T. van Noije & M. Ernst, Granular Matter 1, 57 (1998), both for λ = 1)

    −½ T'/T c g'(c) = −ρ|S|C_λ T^{λ/2} c^λ g,    T' = −ρK T^{1+λ/2},
    ε f''(v) = ρ|S|C_λ |v|^λ f,                  2ε = ρK T^{1+λ/2}.

Density, temperature and the kernel's strength drop out of A and B. The rates are of leading order: powers
of c before the exponential, and lower powers in it, are not known. For λ = 0 the cooling state's tail is a
power (`maxwell_tail_exponent`).
"""

import numpy as np

from granstudy.model.kernel import VHS
from granstudy.theory.broadcast import Result, over_arrays
from granstudy.theory.checks import check_exponent, check_restitution
from granstudy.theory.cooling import cooling_correction, gaussian_cooling_coefficient
from granstudy.velocity.space import check_dim
from granstudy.velocity.sphere import sphere_area


@over_arrays(Result("rate A of the cooling state's tail exp(−A c^λ)", "$A$"))
def cooling_tail_rate(
    restitution: float, dim: int = 3, exponent: float = 1.0, a2: float = 0.0
) -> float:
    """Rate A = 2|S|C_λ/(λK) of the cooling state's tail exp(−A c^λ), c = |v|/√T.

    K is the cooling coefficient, corrected for the kurtosis excess ``a2``. For hard spheres in 3D
    A = 3√π/(2(1−e²)(1 + 3a2/16)). At e = 1 the tail is that of a Gaussian, and A is inf.

    Raises
    ------
    ValueError
        If λ = 0, e or λ is not a number in [0, 1], or the dimension is not 2 or 3.
    """
    if exponent == 0.0:
        raise ValueError(
            "exponent=0: Maxwell molecules have a power-law tail; exp(−A c^λ) needs λ > 0"
        )
    return 2.0 / exponent * _loss_over_cooling(restitution, dim, exponent, a2)


@over_arrays(Result("rate B of the heated state's tail exp(−B c^{1+λ/2})", "$B$"))
def heated_tail_rate(
    restitution: float, dim: int = 3, exponent: float = 1.0, a2: float = 0.0
) -> float:
    """Rate B = 2/(2+λ) √(2|S|C_λ/K) of the heated state's tail exp(−B c^{1+λ/2}), c = |v|/√T.

    B follows from (1+λ/2)² B² = ρ|S|C_λ T^{1+λ/2}/ε and 2ε = ρK T^{1+λ/2}, with K as in
    `cooling_tail_rate`. For Maxwell molecules the tail is exp(−c √(8/(1−e²))). At e = 1, B is inf.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension is not 2 or 3.
    """
    ratio = _loss_over_cooling(restitution, dim, exponent, a2)
    return float(2.0 / (2.0 + exponent) * np.sqrt(2.0 * ratio))


def _loss_over_cooling(restitution: float, dim: int, exponent: float, a2: float) -> float:
    """|S|C_λ/K with K corrected for a2. The kernel's strength drops out."""
    check_dim(dim)
    check_restitution(restitution)
    check_exponent(exponent)
    if restitution == 1.0:
        return float("inf")
    kernel = VHS(exponent, 1.0 / sphere_area(dim))
    K = gaussian_cooling_coefficient(kernel, restitution, dim) * cooling_correction(exponent, a2)
    return float(1.0 / K)
