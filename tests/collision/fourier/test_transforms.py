"""FFTW's plans as compiled loops execute them, against another library's transforms."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import scipy.fft

from granstudy.collision.fourier import fftw
from granstudy.collision.fourier.transforms import CACHE_LINE, RealTransforms

ROUND_OFF = {"double": 1e-14, "single": 1e-6}
"""Over the largest value of the result."""


def axes_of(shape):
    return [axis for axis, points in enumerate(shape) if points > 1]


@pytest.mark.parametrize("precision", ROUND_OFF)
@pytest.mark.parametrize("shape", [(16, 16, 16), (6, 6, 6), (20, 1, 20)], ids=str)
def test_they_are_the_real_transforms_and_their_inverse(shape, precision):
    f = np.random.default_rng(1).standard_normal(shape)
    made = RealTransforms(shape, precision)
    expected = scipy.fft.rfftn(f, axes=axes_of(shape))
    spectrum = made.forward(f)
    limit = ROUND_OFF[precision]
    assert np.max(np.abs(spectrum - expected)) < limit * np.max(np.abs(expected))
    assert np.max(np.abs(made.backward(spectrum) / f.size - f)) < limit * np.max(np.abs(f))
    assert made.made == 2
    assert made.spectrum.ctypes.data % CACHE_LINE == 0


def test_all_plans_of_a_shape_give_the_same_bits():
    f = np.random.default_rng(2).standard_normal((12, 12, 12))
    first, second = (RealTransforms(f.shape).forward(f) for _ in range(2))
    assert np.array_equal(first, second)


def test_plans_are_made_and_executed_by_threads_beside_each_other():
    f = np.random.default_rng(3).standard_normal((16, 16, 16))
    expected = RealTransforms(f.shape).forward(f)

    def many(_):
        return all(np.array_equal(RealTransforms(f.shape).forward(f), expected) for _ in range(20))

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(many, range(8)))


def test_a_process_plans_a_shape_once(monkeypatch):
    first = RealTransforms((8, 8, 8))
    monkeypatch.setattr(fftw, "make_plans", lambda *arguments: pytest.fail("planned again"))
    second = RealTransforms((8, 8, 8))
    assert list(first.plans[:3]) == list(second.plans[:3])
    assert first.plans[fftw.BUFFER] == first.spectrum.ctypes.data != second.plans[fftw.BUFFER]
