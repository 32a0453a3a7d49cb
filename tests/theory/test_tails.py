"""Tail rates: the exact heated tail of Maxwell molecules, and the equations at large speed."""

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("e", [0.0, 0.5, 0.9])
def test_heated_maxwell_tail_is_that_of_the_exact_moments(dim, e):
    """Of e^{−Bc} the moments grow as μ_n/(n μ_{n−1}) → 2/B², apart from 1/n and higher powers."""
    n, (low, high) = np.array([80, 160]), (0, 1)
    moments = np.array([theory.maxwell_heated_moments(k, e, dim)[-2:] for k in n])
    ratios = moments[:, 1] / (n * moments[:, 0])
    # the prefactor's power of c makes (1 + β/n^q): Richardson in n^{−1/2} (2D) or n^{−1} (3D)
    weight = np.sqrt(2.0) if dim == 2 else 2.0
    limit = (weight * ratios[high] - ratios[low]) / (weight - 1)
    assert limit == pytest.approx(2 / theory.heated_tail_rate(e, dim, 0.0) ** 2, rel=0.02)


def test_hard_spheres_in_3D():
    e, a2 = 0.4, 0.08
    A = 3 * np.sqrt(np.pi) / (2 * (1 - e**2) * (1 + 3 * a2 / 16))
    assert theory.cooling_tail_rate(e, a2=a2) == pytest.approx(A, rel=1e-14)
    assert theory.heated_tail_rate(e, a2=a2) == pytest.approx(2 / 3 * np.sqrt(2 * A / 2), rel=1e-14)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("exponent", [0.3, 1.0])
def test_they_solve_the_equations_at_large_speed_for_any_strength_and_density(dim, exponent):
    e, rho, strength, T, c, h = 0.6, 1.7, 0.3, 2.3, 1e5, 1e-3
    kernel, area = gs.VHS(exponent, strength), 2 * np.pi if dim == 2 else 4 * np.pi
    loss = rho * area * strength * (np.sqrt(T) * c) ** exponent
    cooling = rho * theory.gaussian_cooling_coefficient(kernel, e, dim) * T ** (exponent / 2)
    A = theory.cooling_tail_rate(e, dim, exponent)
    assert 0.5 * cooling * c * A * exponent * c ** (exponent - 1) == pytest.approx(loss, rel=1e-12)
    # f'' = (log f)'² f to leading order, by differences of log f in v = √T c
    B, epsilon = theory.heated_tail_rate(e, dim, exponent), cooling * T / 2
    slope = B * ((c + h) ** (1 + exponent / 2) - c ** (1 + exponent / 2)) / (h * np.sqrt(T))
    assert epsilon * slope**2 == pytest.approx(loss, rel=1e-6)


def test_arguments_outside_their_range():
    assert theory.cooling_tail_rate(1.0) == theory.heated_tail_rate(1.0) == np.inf
    with pytest.raises(ValueError, match="exponent=0: Maxwell molecules have a power-law tail"):
        theory.cooling_tail_rate(0.5, 2, 0.0)
    for law in (theory.cooling_tail_rate, theory.heated_tail_rate):
        with pytest.raises(ValueError, match="restitution=1.2"):
            law(1.2)
        with pytest.raises(ValueError, match="exponent=1.5"):
            law(0.2, 3, 1.5)
