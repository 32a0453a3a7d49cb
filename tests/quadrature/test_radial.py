"""Radial rules: exact to their degree, jacobi spectral where legendre is algebraic."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import gamma, gammainc

from granstudy.quadrature import radial_rule


def test_legendre_is_the_papers_rule():
    x, w = np.polynomial.legendre.leggauss(30)
    rule = radial_rule(30, 7.0)
    np.testing.assert_allclose(rule.points, 3.5 + 3.5 * x, atol=1e-15)
    np.testing.assert_allclose(rule.weights, 3.5 * w, rtol=1e-15)


@pytest.mark.parametrize("N_rho", [1, 2, 5, 16])
@pytest.mark.parametrize("R", [0.3, 1.0, 7.8])
def test_legendre_exact_to_its_degree_and_no_further(N_rho, R):
    rule = radial_rule(N_rho, R)
    assert rule.degree == 2 * N_rho - 1
    for p in range(rule.degree + 1):
        relative = rule.weights @ (rule.points / R) ** p / R * (p + 1)
        assert relative == pytest.approx(1, abs=1e-13), f"p={p}"
    # ∫ P_N² over the nodes of P_N: the rule says 0, so degree 2N must fail
    square = np.polynomial.legendre.Legendre.basis(N_rho)(2 * rule.points / R - 1) ** 2
    assert rule.weights @ square < 1e-13
    assert R / (2 * N_rho + 1) > 1e-3


@given(st.integers(1, 24), st.floats(0.1, 20.0), st.floats(-0.9, 6.0))
def test_jacobi_exact_for_its_integrands(N_rho, R, exponent):
    rule = radial_rule(N_rho, R, "jacobi", exponent)
    assert rule.degree == 4 * N_rho - 2
    relative = rule.points / R
    assert np.all(np.diff(rule.points) > 0)
    assert 0 < relative[0] <= relative[-1] < 1
    for p in range(0, rule.degree + 1, 2):
        integral = rule.weights @ relative ** (exponent + p) / R * (exponent + p + 1)
        assert integral == pytest.approx(1, abs=1e-11), f"p={p}"


@pytest.mark.parametrize("exponent", [0.0, 1.0, 2.0, 2.5, 3.0])
def test_jacobi_fails_beyond_its_degree(exponent):
    rule = radial_rule(3, 1.0, "jacobi", exponent)
    p = rule.degree + 2  # the next even power
    error = rule.weights @ rule.points ** (exponent + p) * (exponent + p + 1) - 1
    assert abs(error) > 1e-4
    odd = rule.weights @ rule.points ** (exponent + 1) * (exponent + 2) - 1
    assert abs(odd) > 1e-5  # odd powers are not its integrands


def test_weights_are_positive_and_nodes_inside():
    for rule in (radial_rule(64, 8.0), radial_rule(64, 8.0, "jacobi", 2.5)):
        assert np.all(rule.weights > 0)
        assert 0 < rule.points.min() < rule.points.max() < 8


def gaussian_moment(exponent: float, R: float) -> float:
    """∫_0^R ρ^a e^{−ρ²} dρ = ½ γ((a+1)/2, R²)."""
    b = (exponent + 1) / 2
    return 0.5 * gamma(b) * gammainc(b, R**2)


def error(rule_name: str, N_rho: int, exponent: float, R: float = 2.0) -> float:
    rule = radial_rule(N_rho, R, rule_name, exponent)
    integral = rule.weights @ (rule.points**exponent * np.exp(-(rule.points**2)))
    return abs(integral / gaussian_moment(exponent, R) - 1)


def test_jacobi_is_spectral_and_legendre_algebraic_for_exponent_2_5():
    sizes = np.array([8, 16, 32, 64])
    legendre = np.array([error("legendre", N, 2.5) for N in sizes])
    jacobi = np.array([error("jacobi", N, 2.5) for N in sizes])
    rates = np.log2(legendre[1:-1] / legendre[2:])
    # Gauss–Legendre on ρ^a: order 2(a + 1) = 7
    assert np.all(np.abs(rates - 7) < 0.5), (rates, legendre)
    assert jacobi[0] < 1e-9, jacobi
    assert np.all(jacobi[1:] < 5e-14), jacobi


@pytest.mark.parametrize("rule", ["legendre", "jacobi"])
def test_both_are_spectral_for_integer_exponents(rule):
    errors = [error(rule, N, 3.0) for N in (6, 10, 24)]
    assert errors[1] < errors[0] / 100, errors
    assert errors[2] < 5e-14, errors


def test_legendre_ignores_the_exponent():
    plain, other = radial_rule(9, 3.0), radial_rule(9, 3.0, exponent=2.5)
    assert np.array_equal(plain.weights, other.weights)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0, 1.0), "N_rho=0: must be a positive integer"),
        ((3.0, 1.0), "N_rho=3.0: must be a positive integer"),
        ((True, 1.0), "N_rho=True: must be a positive integer"),
        ((10**6, 1.0), "N_rho=1000000: at most 4096; the nodes are eigenvalues"),
        ((3, 0.0), "R=0.0: must be a positive number"),
        ((3, np.nan), "R=nan: must be a positive number"),
        ((3, 1.0, "jacobi", -1.0), "exponent=-1.0: must be a number above -1"),
        ((3, 1.0, "jacobi", np.inf), "exponent=inf: must be a number above -1"),
        ((3, 1.0, "jacoby"), "unknown radial_rule 'jacoby' (did you mean 'jacobi'?)"),
    ],
)
def test_bad_input_is_named(arguments, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        radial_rule(*arguments)
