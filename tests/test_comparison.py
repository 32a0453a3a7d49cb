"""Every comparison that the tests share must be able to fail."""

import numpy as np
import pytest
from comparison import (
    Gaussians,
    assert_near,
    assert_order,
    assert_printed,
    assert_spectral,
    relative_error,
)


def test_near():
    assert_near(np.array([1.0, 2.0]), np.array([1.0, 2.0 + 1e-9]), 1e-8)
    with pytest.raises(AssertionError, match=r"gain 0\.5 is above"):
        assert_near(np.array([1.0, 1.0]), np.array([1.0, 2.0]), 0.4, "gain")
    with pytest.raises(AssertionError):  # no silent broadcasting
        relative_error(np.ones(3), np.ones((3, 3)))


def test_order():
    steps = np.array([0.4, 0.2, 0.1])
    assert_order(steps, steps**3, 3, cap=1e-2)
    with pytest.raises(AssertionError, match="rates"):
        assert_order(steps, steps**2.5, 3, cap=1.0)
    with pytest.raises(AssertionError, match="errors"):
        assert_order(steps, steps**3, 3, cap=1e-4)
    with pytest.raises(AssertionError):  # one bad halving is enough
        assert_order(steps, np.array([1.0, 0.1, 0.05]), 3, cap=1.0)


def test_spectral():
    sizes = np.arange(4, 30, 4)
    errors = np.maximum(np.exp(-1.0 * sizes), 1e-8)
    assert_spectral(sizes, errors, rate=0.9, floor=2e-8)
    with pytest.raises(AssertionError, match="floor"):
        assert_spectral(sizes, errors, rate=0.9, floor=1e-9)
    with pytest.raises(AssertionError, match="rate"):
        assert_spectral(sizes, errors, rate=1.1, floor=2e-8)
    with pytest.raises(AssertionError):  # an algebraic rate is none
        assert_spectral(sizes, 1.0 * sizes**-4.0, rate=0.5, floor=1e-5)
    with pytest.raises(AssertionError, match="too few"):
        assert_spectral(sizes, np.full(7, 1e-9), rate=0.1, floor=2e-8)


def test_printed():
    assert_printed(1.0 + 5e-9, 1.0, 1e-8)
    with pytest.raises(AssertionError, match="off by"):
        assert_printed(1.0 + 2e-8, 1.0, 1e-8)
    with pytest.raises(AssertionError):
        assert_printed(1.1e-14, 1e-30, 1e-8, 1e-14)


@pytest.mark.parametrize("dim", [2, 3])
def test_gaussians_have_unit_density_and_no_symmetry(dim):
    v = np.linspace(-5, 5, 60)
    f = Gaussians(dim, 3, (0.6, 0.9), 0.6)(*np.meshgrid(*(v,) * dim, indexing="ij", sparse=True))
    assert f.sum() * (v[1] - v[0]) ** dim == pytest.approx(1.0, abs=1e-6)
    for image in (f.swapaxes(0, 1), f[::-1], np.flip(f)):
        assert relative_error(image, f) > 0.05
