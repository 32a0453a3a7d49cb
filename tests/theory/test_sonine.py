"""The linear theories of a2 against `radial`, the exact Maxwell states and the published formulas."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from perturbed import collision_moments

from granstudy import theory

THEORIES = (theory.cooling_state_a2, theory.heated_state_a2, theory.montanero_santos_a2)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("exponent", [0.4, 1.0])
def test_balances_of_the_collision_moments_that_radial_computes(dim, exponent, e=0.3):
    """Rates of ⟨v²⟩ and ⟨v⁴⟩, quadratic in a2: their linear parts by central differences."""
    (E0, F0), (E_plus, F_plus), (E_minus, F_minus) = (
        collision_moments(dim, exponent, e, a2) for a2 in (0.0, 0.2, -0.2)
    )
    E1, F1 = (E_plus - E_minus) / 0.4, (F_plus - F_minus) / 0.4
    # of ⟨v⁴⟩ = d(d+2)(1 + a2) T² the cooling at T'/T = ⟨v²⟩'/d makes 2(d+2)(1 + a2) ⟨v²⟩'
    balance, slope = 2 * (dim + 2) * E0, 2 * (dim + 2) * E1
    cooling = (F0 - balance) / (balance + slope - F1)
    heated = (F0 - balance) / (slope - F1)
    divided = (F0 - balance) / (slope + F0 - F1)
    expected = [law(e, dim, exponent) for law in THEORIES]
    np.testing.assert_allclose([cooling, heated, divided], expected, rtol=1e-5)


@pytest.mark.parametrize("e", [0.0, 0.2, 0.5, 0.8, 0.95])
def test_hard_spheres_in_3D_as_published(e):
    numerator = 16 * (1 - e) * (1 - 2 * e**2)
    denominators = (
        81 - 17 * e + 30 * e**2 * (1 - e),
        241 - 177 * e + 30 * e**2 * (1 - e),
        97 - 33 * e - 2 * e**2 * (1 - e),
    )
    for law, denominator in zip(THEORIES, denominators, strict=True):
        assert law(e) == pytest.approx(numerator / denominator, rel=1e-12)


@given(st.floats(0.0, 1.0), st.sampled_from([2, 3]))
def test_exact_for_maxwell_molecules(e, dim):
    exact = theory.maxwell_cooling_moments(2, e, dim)[2] - 1
    assert theory.cooling_state_a2(e, dim, 0.0) == pytest.approx(exact, rel=1e-11, abs=1e-14)
    exact = theory.maxwell_heated_moments(2, e, dim)[2] - 1
    assert theory.heated_state_a2(e, dim, 0.0) == pytest.approx(exact, rel=1e-11, abs=1e-14)


@pytest.mark.parametrize("law", THEORIES)
@pytest.mark.parametrize(("dim", "zero"), [(3, np.sqrt(1 / 2)), (2, np.sqrt(7 / 15))])
def test_signs_of_hard_spheres(law, dim, zero):
    assert law(1.0, dim) == 0.0
    assert law(zero, dim) == pytest.approx(0.0, abs=1e-15)
    assert law(0.9, dim) < 0.0 < law(0.5, dim)


def test_an_array_of_restitutions():
    e = np.array([0.0, 0.5, 1.0])
    np.testing.assert_array_equal(
        theory.cooling_state_a2(e), [theory.cooling_state_a2(x) for x in e]
    )


@pytest.mark.parametrize("law", THEORIES)
def test_arguments_outside_their_range(law):
    with pytest.raises(ValueError, match="restitution=1.2: must be a number between 0 and 1"):
        law(1.2)
    with pytest.raises(ValueError, match="dim=4: allowed are 2 and 3"):
        law(0.5, 4)
    with pytest.raises(ValueError, match="exponent=2.0: must lie between 0 and 1"):
        law(0.5, 3, 2.0)


@given(st.floats(0.0, 1.0), st.sampled_from([2, 3]))
def test_the_relaxation_of_a2_is_exact_for_maxwell_molecules(e, dim):
    # a2' = const − r a2 at ε = 0 and ν = 1: the difference of two gases decays at r
    pressure = np.eye(dim)
    first, second = (theory.maxwell_a2(np.array([0.0, 2.0]), pressure, a2, e) for a2 in (0.0, 0.3))
    decay = -np.log((second[1] - first[1]) / 0.3) / 2.0
    assert theory.a2_relaxation_rate(e, dim, 0.0) == pytest.approx(decay, rel=1e-8)


def test_the_relaxation_of_a2_of_hard_spheres_as_published():
    # van Noije & Ernst: a2' = (4/d) μ_2 [.. − ((T_2)/(d+2) − 19/16) a2], T'/T = −(2/d) μ_2 = −(1 − e²)ν/3
    e = 0.4
    T2 = 3 / 32 * (69 + 10 * e**2) + 2 / (1 - e)
    cooling = (1 - e**2) / 3
    expected = 2 * cooling * (T2 / 5 - 19 / 16)
    assert theory.a2_relaxation_rate(e) == pytest.approx(expected, rel=1e-12)
