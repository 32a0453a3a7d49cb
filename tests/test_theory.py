import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import granstudy as gs
from granstudy import theory

E = st.floats(0.0, 1.0)


@given(E, st.floats(0.1, 5.0), st.floats(0.0, 0.5), st.floats(0.5, 2.0), st.floats(0.5, 2.0))
def test_maxwell_temperature_solves_its_equation(e, T0, epsilon, density, cross_section):
    def T(t):
        return theory.maxwell_temperature(t, T0, e, epsilon, density, cross_section)

    assert T(0.0) == pytest.approx(T0, rel=1e-6)
    h = 1e-4
    derivative = (T(1.0 + h) - T(1.0 - h)) / (2 * h)
    law = 2 * epsilon - (1 - e**2) / 4 * density * cross_section * T(1.0)
    assert derivative == pytest.approx(law, abs=1e-6)


def test_maxwell_temperature_as_the_paper_writes_it():
    t, e, epsilon, T0 = np.linspace(0, 3, 7), 0.2, 1e-6, 1.425
    steady = 8 * epsilon / (1 - e**2)
    expected = (T0 - steady) * np.exp(-(1 - e**2) * t / 4) + steady
    np.testing.assert_allclose(theory.maxwell_temperature(t, T0, e, epsilon), expected, rtol=1e-15)
    np.testing.assert_array_equal(theory.maxwell_temperature(t, T0, 1.0, 0.1), T0 + 0.2 * t)


def test_anisotropy_rate():
    assert theory.maxwell_anisotropy_rate(1.0, 3) == pytest.approx(0.5)
    assert theory.maxwell_anisotropy_rate(0.0, 2) == pytest.approx(2 * 0.25 * 0.75)
    assert theory.maxwell_anisotropy_rate(0.5, 3, density=2.0) == 2 * (
        theory.maxwell_anisotropy_rate(0.5, 3)
    )


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_gaussian_cooling_of_maxwell_molecules_is_their_exact_rate(dim, e):
    K = theory.gaussian_cooling_coefficient(gs.maxwell(dim), e, dim)
    assert K == pytest.approx((1 - e**2) / 4, rel=1e-14)


def test_haff_constant_of_hard_spheres():
    # 0.3761 (1−e²) √T0 (docs/method.md §4): 4/(3√π)·½
    exact = 2 / (3 * np.sqrt(np.pi))
    assert exact == pytest.approx(0.3761, abs=5e-5)
    C0 = theory.haff_constant(gs.hard_spheres(3), 0.2, 3, T0=2.0)
    assert C0 == pytest.approx(exact * 0.96 * np.sqrt(2.0), rel=1e-14)
    # the paper's Figure 4 fits 0.19058 and 0.5159; the Gaussian's are 0.1915 and 0.5106
    assert C0 == pytest.approx(0.5159, rel=0.02)
    assert theory.haff_constant(gs.hard_spheres(3), 0.8, 3, T0=2.0) == pytest.approx(
        0.19058, rel=0.01
    )
    corrected = theory.haff_constant(gs.hard_spheres(3), 0.2, 3, T0=2.0, a2=0.16)
    assert corrected == pytest.approx(1.03 * C0, rel=1e-14)


@given(E, st.floats(0.2, 4.0))
def test_haff_law_solves_the_cooling_equation(e, T0):
    kernel = gs.hard_spheres(3)
    K = theory.gaussian_cooling_coefficient(kernel, e, 3)
    T = theory.haff_temperature(3.0, T0, theory.haff_constant(kernel, e, 3, T0))
    numerical = solve_ivp(lambda t, T: -K * T**1.5, (0, 3), [T0], rtol=1e-10, atol=1e-12).y[0, -1]
    assert numerical == pytest.approx(T, rel=1e-7)


def test_kurtosis_of_the_steady_states():
    for a2 in (theory.cooling_state_a2, theory.heated_state_a2):
        assert a2(1.0) == 0.0
        assert a2(np.sqrt(0.5)) == pytest.approx(0.0, abs=1e-15)  # both change sign at e = 1/√2
        assert a2(0.9) < 0.0 < a2(0.5)
    assert theory.cooling_state_a2(0.2) == pytest.approx(0.15, abs=0.01)  # docs/method.md §5
    assert theory.heated_state_a2(0.0) == pytest.approx(16 / 241)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: theory.maxwell_anisotropy_rate(0.5, 4), "dim=4: allowed are 2 and 3"),
        (lambda: theory.haff_constant(gs.maxwell(3), 0.5, 3), "exponent=0: .* λ > 0"),
        (lambda: theory.haff_constant(gs.hard_spheres(2), 0.5, 2, a2=0.1), r"a2=0\.1: .* 3D only"),
    ],
)
def test_laws_outside_their_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
