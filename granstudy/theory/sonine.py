"""Kurtosis excess of the cooling and the heated state of VHS gases, by theories linear in a2.

The density is a Gaussian × (1 + a2 S_2), and the collision rates of ⟨|c|²⟩ and ⟨|c|⁴⟩ are taken to first
order in a2. At T = 1, in units of ρ|S|C_λ ⟨|g|^{2+λ}⟩ of the Gaussian, with p = (1−e²)/4 and k = λ(λ+2)/16
(docs/theory.md §4),

    d⟨|c|²⟩/dt = −p/2 (1 + k a2),    d⟨|c|⁴⟩/dt = −(F_0 + F_1 a2).

In the cooling state ⟨|v|⁴⟩ = d(d+2)(1 + a2) T² falls as T² does. In the heated state both stand still:
heating adds 2ε to T' and 4(d+2)dεT to d⟨|v|⁴⟩/dt. Hence

    cooling  (d+2)p (1 + k a2)(1 + a2) = F_0 + F_1 a2,      heated  (d+2)p (1 + k a2) = F_0 + F_1 a2.

All three a2 change sign where λ = (d+1)(d+λ+2)p/d: for hard spheres in 3D at e = 1/√2, in 2D at √(7/15).
The kernel is the paper's, without angular factor. In 3D at λ = 1 it is the kernel of hard spheres, with the
results of van Noije & Ernst. Real hard disks scatter differently from this kernel in 2D, and have another
a2.
"""

from granstudy.theory.broadcast import Result, over_arrays
from granstudy.theory.checks import check_exponent, check_restitution
from granstudy.velocity.space import check_dim


@over_arrays(Result("kurtosis excess of the cooling state, linear theory", "$a_2$"))
def cooling_state_a2(restitution: float, dim: int = 3, exponent: float = 1.0) -> float:
    """Kurtosis excess of the homogeneous cooling state, by linear theory without products a2².

    a2 = (F_0 − (d+2)p)/((d+2)p(1+k) − F_1). For hard spheres in 3D a2 = 16(1−e)(1−2e²)/(81−17e+30e²(1−e))
    (T. van Noije & M. Ernst, Granular Matter 1, 57 (1998)). The theory is exact for Maxwell molecules, an
    approximation for other kernels.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension is not 2 or 3.
    """
    F0, F1, balance, k = _rates(restitution, dim, exponent)
    return (F0 - balance) / (balance * (1 + k) - F1)


@over_arrays(Result("kurtosis excess of the cooling state, divided by 1 + a2", "$a_2$"))
def montanero_santos_a2(restitution: float, dim: int = 3, exponent: float = 1.0) -> float:
    """Kurtosis excess of the homogeneous cooling state, linearised after division by 1 + a2.

    (d+2)p (1 + k a2) = (F_0 + F_1 a2)/(1 + a2) to first order gives

        a2 = (F_0 − (d+2)p)/((d+2)p k + F_0 − F_1).

    For hard spheres in 3D a2 = 16(1−e)(1−2e²)/(97−33e−2e²(1−e)) (J. Montanero & A. Santos, Granular Matter
    2, 53 (2000)). The theory is not exact for Maxwell molecules, whose equation is linear before the
    division.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension is not 2 or 3.
    """
    F0, F1, balance, k = _rates(restitution, dim, exponent)
    return (F0 - balance) / (balance * k + F0 - F1)


@over_arrays(Result("kurtosis excess of the heated state, linear theory", "$a_2$"))
def heated_state_a2(restitution: float, dim: int = 3, exponent: float = 1.0) -> float:
    """Kurtosis excess of the steady state heated by diffusion, by linear theory.

    a2 = (F_0 − (d+2)p)/((d+2)p k − F_1). For hard spheres in 3D a2 = 16(1−e)(1−2e²)/(241−177e+30e²(1−e))
    (T. van Noije & M. Ernst, Granular Matter 1, 57 (1998)). The theory is exact for Maxwell molecules.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension is not 2 or 3.
    """
    F0, F1, balance, k = _rates(restitution, dim, exponent)
    return (F0 - balance) / (balance * k - F1)


@over_arrays(Result("relaxation rate of a2 over the collision frequency", "$r$"))
def a2_relaxation_rate(restitution: float, dim: int = 3, exponent: float = 1.0) -> float:
    """Rate at which a small a2 relaxes while the gas cools, over the collision frequency of the Gaussian.

    With 1 + a2 = ⟨|c|⁴⟩/(d(d+2)T²) the equations above give a2' = … − r a2 for

        r = (F_1 − (d+2)p(1+k)) ⟨|g|^{2+λ}⟩ / (d(d+2) ⟨|g|^λ⟩),   ⟨|g|^{2+λ}⟩ = 2(d+λ) ⟨|g|^λ⟩.

    Heating adds 4ε/T. For Maxwell molecules in 3D r is 1/3 at e = 1, 1/24 at e = 0.

    Raises
    ------
    ValueError
        If e or λ is not a number in [0, 1], or the dimension is not 2 or 3.
    """
    _, F1, balance, k = _rates(restitution, dim, exponent)
    return 2 * (dim + exponent) * (F1 - balance * (1 + k)) / (dim * (dim + 2))


def _rates(restitution: float, dim: int, exponent: float) -> tuple[float, float, float, float]:
    """F_0, F_1, (d+2)p and k of the equations at the head of this module.

    With v, v* = G ± g/2 a collision adds, in the mean over σ, 2[A G²g² + B g⁴ + C (G·g)²] to |v|⁴ + |v*|⁴.
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
