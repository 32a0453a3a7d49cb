"""Exact states of Maxwell molecules: moments against sums over discrete measures, tail exponents."""

import numpy as np
import pytest
from discrete_measure import collision_rate, directions

from granstudy import theory
from granstudy.theory.maxwell_states import LARGE, decay_rate

each_dim = pytest.mark.parametrize("dim", [2, 3])


def speed_power(power):
    return lambda v: np.sum(v**2, axis=-1) ** (power // 2)


def isotropic_measure(moments, dim):
    """Two shells with ⟨|v|^{2n}⟩ of the states' moments n = 0..3 at T = 1, isotropic to degree 7."""
    gaussian = np.cumprod([1, dim, dim + 2, dim + 4])
    m = np.asarray(moments)[:4] * gaussian
    # nodes of the two-point Gauss rule in |v|²: roots of the quadratic orthogonal to 1 and |v|²
    c0, c1 = np.linalg.solve([[m[0], m[1]], [m[1], m[2]]], [-m[2], -m[3]])
    squares = np.roots([1.0, c1, c0])
    shares = np.linalg.solve([[1, 1], squares], m[:2])
    sigma = directions(dim)
    v = np.concatenate([np.sqrt(square) * sigma for square in squares])
    return np.repeat(shares / len(sigma), len(sigma)), v


@each_dim
@pytest.mark.parametrize("e", [0.5, 0.8, 1.0])
def test_cooling_state_keeps_its_moments_but_for_the_temperature(dim, e):
    measure = isotropic_measure(theory.maxwell_cooling_moments(3, e, dim), dim)
    for power in (2, 4, 6):
        moment = speed_power(power)
        rate = -power / 2 * (1 - e**2) / 4 * (measure[0] @ moment(measure[1]))
        assert collision_rate(measure, moment, e) == pytest.approx(rate, rel=1e-10, abs=1e-12)


@each_dim
@pytest.mark.parametrize("e", [0.0, 0.3, 0.9])
def test_heated_state_is_steady(dim, e):
    measure = isotropic_measure(theory.maxwell_heated_moments(3, e, dim), dim)
    epsilon = (1 - e**2) / 8  # T = 1
    for power in (2, 4, 6):
        diffused = power * (power - 2 + dim) * (measure[0] @ speed_power(power - 2)(measure[1]))
        rate = -epsilon * diffused
        assert collision_rate(measure, speed_power(power), e) == pytest.approx(rate, rel=1e-12)


@each_dim
def test_elastic_states_are_gaussian(dim):
    for state in (theory.maxwell_cooling_moments, theory.maxwell_heated_moments):
        moments = state(5, 1.0, dim)
        np.testing.assert_allclose(moments, 1.0, rtol=1e-14)
        assert theory.sonine_coefficients(moments) == pytest.approx((0.0, 0.0), abs=1e-13)


def test_sonine_coefficients_are_those_of_a_sonine_series():
    # moments of a Gaussian × (1 + a2 S_2 + a3 S_3): 1 + a2, 1 + 3a2 − a3
    assert theory.sonine_coefficients([1, 1, 1.2, 1.5]) == pytest.approx((0.2, 0.1))


@each_dim
def test_sticky_kurtosis(dim):
    a2 = theory.maxwell_cooling_moments(2, 0.0, dim)[2] - 1.0
    assert a2 == pytest.approx({2: 6.0, 3: 2.0}[dim], rel=1e-12)
    assert np.all(np.isinf(theory.maxwell_cooling_moments(5, 0.0, dim)[3:]))


def test_tail_exponent_as_published():
    # uniform impact parameters on the disk are isotropic scattering in 2D: Krapivsky & Ben-Naim
    # print f ~ v^{−6.28753} for e = 0
    assert 2 + theory.maxwell_tail_exponent(0.0, 2) == pytest.approx(6.28753, abs=5e-6)


@each_dim
@pytest.mark.parametrize("e", [0.0, 0.25, 0.5, 0.7])
def test_a_moment_is_finite_where_the_tail_exponent_says(dim, e):
    p = theory.maxwell_tail_exponent(e, dim)
    finite = np.isfinite(theory.maxwell_cooling_moments(10, e, dim))
    np.testing.assert_array_equal(finite, 2 * np.arange(11) < p)
    assert not finite.all()


@each_dim
@pytest.mark.parametrize("e", [0.0, 0.6, 0.999])
def test_tail_exponent_solves_its_equation_by_quadrature(dim, e):
    """The means over the angle θ of σ and k by the midpoint rule."""
    s, alpha = theory.maxwell_tail_exponent(e, dim) / 2, (1 + e) / 4
    theta = np.pi * (np.arange(200_000) + 0.5) / 200_000
    w = np.sin(theta) ** (dim - 2)
    a = (1 - alpha) ** 2 + alpha**2 + 2 * alpha * (1 - alpha) * np.cos(theta)
    b = 2 * alpha**2 * (1 - np.cos(theta))
    means = [np.average(power, weights=w) for power in (a**s, b**s)]
    assert 1 - sum(means) == pytest.approx(s * (1 - e**2) / 4, rel=1e-8)
    assert decay_rate(s, e, dim) == pytest.approx(1 - sum(means), rel=1e-8)


@each_dim
def test_elastic_molecules_have_no_such_tail(dim):
    assert theory.maxwell_tail_exponent(1.0, dim) == np.inf
    assert theory.maxwell_tail_exponent(1 - 1e-6, dim) > 1e6


def test_arguments_outside_their_range():
    for law in (theory.maxwell_cooling_moments, theory.maxwell_heated_moments):
        with pytest.raises(ValueError, match="restitution=1.2"):
            law(3, 1.2, 2)
        with pytest.raises(ValueError, match="dim=4"):
            law(3, 0.2, 4)
        with pytest.raises(ValueError, match="order=0: must be at least 1"):
            law(0, 0.2, 2)
    with pytest.raises(ValueError, match="restitution=-0.1"):
        theory.maxwell_tail_exponent(-0.1, 2)


@pytest.mark.parametrize("s", [50.0, 0.99 * LARGE, 1.01 * LARGE, 1e7])
@pytest.mark.parametrize("e", [0.5, 0.999, 1.0 - 1e-9])
def test_rates_of_decay_are_right_at_any_order(e, s):
    """In 3D, y is uniform on (0, 1): both means are known in closed form."""
    z, b = (1.0 + e) * (3.0 - e) / 4, ((1.0 + e) / 2) ** 2
    exact = 1.0 - ((1.0 - (1.0 - z) ** (s + 1)) / z + np.exp(s * np.log(b))) / (s + 1)
    assert decay_rate(s, e, 3) == pytest.approx(exact, abs=2.0 / s**2 + 1e-11)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_tail_exponent_goes_over_into_that_of_an_elastic_gas(dim):
    """p → 2/r_1 = 8/(1 − e²), with which it grows without bound."""
    ratios = [
        theory.maxwell_tail_exponent(e, dim) * (1.0 - e**2) / 8.0
        for e in (0.99, 0.9999, 1.0 - 1e-9, 1.0 - 2.0**-53)
    ]
    assert ratios == sorted(ratios)
    assert ratios[-1] == pytest.approx(1.0, abs=1e-7)
