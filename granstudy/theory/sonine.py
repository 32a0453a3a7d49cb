"""Kurtosis excess of the cooling and the heated state of VHS gases, by theories linear in a2.

f is taken as a Gaussian × (1 + a2 S_2), and the collision rates of ⟨|c|²⟩ and ⟨|c|⁴⟩ to first order in a2. At
T = 1, in units of ρ|S|C_λ ⟨|g|^{2+λ}⟩ of the Gaussian, with p = (1−e²)/4, k = λ(λ+2)/16 (docs/theory.md §4),

    d⟨|c|²⟩/dt = −p/2 (1 + k a2),    d⟨|c|⁴⟩/dt = −(F_0 + F_1 a2).

In the cooling state ⟨|v|⁴⟩ = d(d+2)(1 + a2) T² falls as T² does; heating, which adds 2ε to T', adds 4(d+2)dεT
to it, and both stand still:

    cooling  (d+2)p (1 + k a2)(1 + a2) = F_0 + F_1 a2,      heated  (d+2)p (1 + k a2) = F_0 + F_1 a2.

All three a2 change sign where λ = (d+1)(d+λ+2)p/d: at e = 1/√2 for hard spheres in 3D, at √(7/15) in 2D.
The kernel is the paper's, without angular factor: in 3D at λ = 1 that of hard spheres, with the results of
van Noije & Ernst; real hard disks scatter otherwise than this kernel does in 2D, and their a2 is another.
"""

from granstudy.theory.checks import check_exponent, check_restitution
from granstudy.velocity.space import check_dim


def cooling_state_a2(restitution: float, dim: int = 3, exponent: float = 1.0) -> float:
    """Kurtosis excess of the homogeneous cooling state, linear theory; products a2² dropped.

    a2 = (F_0 − (d+2)p)/((d+2)p(1+k) − F_1). Hard spheres in 3D: 16(1−e)(1−2e²)/(81−17e+30e²(1−e))
    (T. van Noije & M. Ernst, Granular Matter 1, 57 (1998)). Exact for Maxwell molecules. For other kernels
    compare with it, do not expect equality.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension not 2 or 3.
    """
    F0, F1, balance, k = _rates(restitution, dim, exponent)
    return (F0 - balance) / (balance * (1 + k) - F1)


def montanero_santos_a2(restitution: float, dim: int = 3, exponent: float = 1.0) -> float:
    """Kurtosis excess of the homogeneous cooling state, linearised after division by 1 + a2.

    (d+2)p (1 + k a2) = (F_0 + F_1 a2)/(1 + a2) to first order: a2 = (F_0 − (d+2)p)/((d+2)p k + F_0 − F_1).
    Hard spheres in 3D: 16(1−e)(1−2e²)/(97−33e−2e²(1−e)) (J. Montanero & A. Santos, Granular Matter 2, 53
    (2000)). It is not exact for Maxwell molecules, whose equation is linear before the division.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension not 2 or 3.
    """
    F0, F1, balance, k = _rates(restitution, dim, exponent)
    return (F0 - balance) / (balance * k + F0 - F1)


def heated_state_a2(restitution: float, dim: int = 3, exponent: float = 1.0) -> float:
    """Kurtosis excess of the steady state heated by diffusion, linear theory.

    a2 = (F_0 − (d+2)p)/((d+2)p k − F_1). Hard spheres in 3D: 16(1−e)(1−2e²)/(241−177e+30e²(1−e)) (T. van
    Noije & M. Ernst, Granular Matter 1, 57 (1998)). Exact for Maxwell molecules.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension not 2 or 3.
    """
    F0, F1, balance, k = _rates(restitution, dim, exponent)
    return (F0 - balance) / (balance * k - F1)


def _rates(restitution: float, dim: int, exponent: float) -> tuple[float, float, float, float]:
    """F_0, F_1, (d+2)p and k of the equations at the head of this module.

    With v, v* = G ± g/2 a collision adds 2[A G²g² + B g⁴ + C (G·g)²] to |v|⁴ + |v*|⁴, in the mean over σ.
    """
    check_dim(dim)
    check_restitution(restitution)
    check_exponent(exponent)
    d, lam, e = dim, exponent, restitution
    p, k = (1 - e**2) / 4, lam * (lam + 2) / 16
    A = (1 + e) ** 2 / (4 * d) - p
    B = -p / 4 * (1 - (d + 1) / d * p)
    C = (1 - e) ** 2 / 4 - 1
    F0 = -((A * d + C) / 2 + 2 * (d + lam + 2) * B)
    F1 = -(
        A * (lam + 2) * (d * (lam + 4) + 8) / 32
        + B * (lam + 2) * (lam + 4) * (d + lam + 2) / 8
        + C * (lam**2 + 14 * lam + 8 * (d + 2)) / 32
    )
    return F0, F1, (d + 2) * p, k
