"""Rules on the radius ρ in [0, R]."""

import numpy as np
from scipy.special import roots_jacobi

from granstudy.quadrature.rule import Rule, check_gauss_size, check_size
from granstudy.support.checks import check_positive
from granstudy.support.errors import unknown_name

RADIAL_RULES = ("legendre", "jacobi")
"""Names of the rules that `radial_rule` takes."""


def radial_rule(N_rho: int, R: float, rule: str = "legendre", exponent: float = 0.0) -> Rule:
    """N_rho nodes on [0, R] with Σ_i w_i φ(ρ_i) ≈ ∫_0^R φ(ρ) dρ for the whole integrand φ.

    legendre
        Gauss–Legendre, the paper's rule (docs/method.md §2). Degree 2 N_rho − 1 in ρ. `exponent` plays no
        part.
    jacobi
        Gauss–Jacobi in s = ρ² (Abramowitz and Stegun 25.4.33), for φ(ρ) = ρ^exponent h(ρ²) with h smooth:
        ∫ φ dρ = ½ ∫_0^{R²} s^b h(s) ds, b = (exponent − 1)/2. The factor ρ^exponent is divided out of the
        weights again. Exact for h to degree 2 N_rho − 1; `degree`, which counts h(ρ²) in ρ, is 4 N_rho − 2.

    The collision integrand averaged over the sphere has the form ρ^exponent h(ρ²), with exponent d − 1 + λ.
    Jacobi converges spectrally for every exponent, Legendre with an algebraic order where the exponent is
    not an integer.

    Points (N_rho,), increasing, in the open interval.

    Raises
    ------
    ValueError
        If `N_rho` is not a positive integer or above 4096, `R` is not positive, `exponent` is not above −1,
        or `rule` is not known.
    """
    check_size("N_rho", N_rho)
    check_gauss_size("N_rho", int(N_rho))
    check_positive("R", R)
    if not (np.isfinite(exponent) and exponent > -1):
        raise ValueError(f"exponent={exponent!r}: must be a number above -1 (integrable at 0)")
    if rule == "legendre":
        return _legendre(int(N_rho), R)
    if rule == "jacobi":
        return _jacobi(int(N_rho), R, exponent)
    raise unknown_name("radial_rule", rule, RADIAL_RULES)


def _legendre(N_rho: int, R: float) -> Rule:
    x, w = np.polynomial.legendre.leggauss(N_rho)
    return Rule(R / 2 * (1 + x), R / 2 * w, 2 * N_rho - 1, f"legendre N_rho={N_rho}, R={R:g}")


def _jacobi(N_rho: int, R: float, exponent: float) -> Rule:
    b = (exponent - 1) / 2
    x, w = roots_jacobi(N_rho, 0.0, b)  # for the weight (1 + x)^b, with s = R² (1 + x)/2
    relative = np.sqrt((1 + x) / 2)  # ρ/R
    weights = R * w / 2 ** (b + 2) / relative**exponent
    name = f"jacobi N_rho={N_rho}, R={R:g}, exponent={exponent:g}"
    return Rule(R * relative, weights, 4 * N_rho - 2, name)
