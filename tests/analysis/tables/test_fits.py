"""Fits recover the laws that data were made from, and refuse what has no answer."""

import numpy as np
import pytest

from granstudy.analysis.tables.fits import fit_order, growth_exponent


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


def test_the_exponent_of_a_power_leaves_out_what_is_too_small_to_measure():
    N = np.array([8, 16, 32, 64])
    assert growth_exponent(N, 3.0 * N**2.5) == pytest.approx(2.5)
    assert growth_exponent(N, np.array([9.0, 16.0**3, 32.0**3, 64.0**3]), 10.0) == pytest.approx(3)
    assert np.isnan(growth_exponent(N, np.array([0.0, 0.0, np.nan, 20.0]), 10.0))
