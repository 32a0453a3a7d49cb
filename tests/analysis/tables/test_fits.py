"""Fits recover the laws that data were made from, and refuse what has no answer."""

import numpy as np
import pytest

from granstudy.analysis.tables.fits import fit_haff, fit_order, growth_exponent, local_slope
from granstudy.theory import haff_temperature


@pytest.mark.parametrize(("order", "prefactor"), [(3.0, 0.2), (-2.5, 7.0), (0.0, 1e-6)])
def test_an_order_is_recovered(order, prefactor):
    x = np.array([0.5, 0.25, 0.1, 0.01])
    assert fit_order(x, prefactor * x**order) == pytest.approx((order, prefactor), abs=1e-12)


def test_an_order_weighs_ratios_not_differences():
    x = np.array([1.0, 0.1, 0.01])
    # twice too large at the largest error, half at the smallest: a slope larger by log10(4)/2
    order, _ = fit_order(x, x**2 * np.array([2.0, 1.0, 0.5]))
    assert order == pytest.approx(2.0 + np.log10(4.0) / 2.0)


@pytest.mark.parametrize("error", [[1.0, 0.0], [1.0, -1.0], [1.0, np.nan], [1.0, np.inf]])
def test_an_order_needs_positive_errors(error):
    with pytest.raises(ValueError, match="error=.*positive, finite"):
        fit_order([1.0, 2.0], error)


def test_an_order_needs_two_different_x():
    with pytest.raises(ValueError, match="two different"):
        fit_order([1.0, 1.0], [1.0, 2.0])


@pytest.mark.fault("A3")
@pytest.mark.parametrize(("C0", "T0"), [(0.19058, 2.0), (0.5159, 2.0), (5.0, 0.01)])
def test_a_haff_constant_is_recovered(C0, T0):
    t = np.linspace(0.0, 3.0, 301)
    fitted, error = fit_haff(t, haff_temperature(t, T0, C0))
    assert fitted == pytest.approx(C0, rel=1e-7)
    assert error < 1e-7 * C0


@pytest.mark.fault("A3")
def test_the_initial_temperature_is_held():
    t = np.linspace(0.0, 3.0, 301)
    T = haff_temperature(t, 2.0, 0.5)
    from_start, _ = fit_haff(t[100:] - 0.0, T[100:], T0=2.0)
    assert from_start == pytest.approx(0.5, rel=1e-7)
    too_warm, error = fit_haff(t, T, T0=2.2)
    assert too_warm > 0.52
    assert error > 1e-4


def test_the_standard_error_covers_noise():
    t = np.linspace(0.0, 3.0, 301)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    C0, error = fit_haff(t, haff_temperature(t, 2.0, 0.5) + noise, T0=2.0)
    assert abs(C0 - 0.5) < 4.0 * error
    assert error < 1e-3


@pytest.mark.fault("A3")
@pytest.mark.parametrize(
    ("t", "T", "message"),
    [([0.0, 1.0], [1.0, 0.5], "three"), ([0.0, 1.0, 2.0], [1.0, 0.5, np.nan], "finite")],
)
def test_a_cooling_law_needs_data(t, T, message):
    with pytest.raises(ValueError, match=message):
        fit_haff(t, T)


def test_the_local_slope_of_a_power_and_of_haffs_law():
    t = np.geomspace(1e-2, 1e6, 81)
    at, slope = local_slope(t, 3.0 * t**-1.7)
    np.testing.assert_allclose(slope, -1.7, rtol=1e-12)
    assert np.all((t[:-1] < at) & (at < t[1:]))
    C0 = 0.2
    at, slope = local_slope(t, (1.0 + C0 * t) ** -2)
    np.testing.assert_allclose(slope, -2 * C0 * at / (1 + C0 * at), atol=2e-3)
    np.testing.assert_allclose((slope + 2)[-5:] * C0 * at[-5:], 2.0, rtol=0.02)


def test_the_exponent_of_a_power_leaves_out_what_is_too_small_to_measure():
    N = np.array([8, 16, 32, 64])
    assert growth_exponent(N, 3.0 * N**2.5) == pytest.approx(2.5)
    assert growth_exponent(N, np.array([9.0, 16.0**3, 32.0**3, 64.0**3]), 10.0) == pytest.approx(3)
    assert np.isnan(growth_exponent(N, np.array([0.0, 0.0, np.nan, 20.0]), 10.0))
