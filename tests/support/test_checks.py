"""Checks of numbers, of Python's and of NumPy's types."""

import numpy as np
import pytest

from granstudy.support.checks import check_count, check_positive, is_real
from granstudy.support.errors import nearest, unknown_name


@pytest.mark.parametrize("value", [1, 0.5, 1e-300, 10**300, np.float32(2.0), np.int64(3)])
def test_positive_numbers(value):
    check_positive("x", value)


@pytest.mark.parametrize(
    "value",
    [
        0,
        -1.0,
        10**400,
        np.nan,
        np.float64(np.nan),
        np.inf,
        True,
        "1",
        None,
        [1.0],
        1j,
        np.complex128(1.0),
    ],
    ids=lambda value: str(value)[:9],
)
def test_what_is_no_positive_number(value):
    with pytest.raises(ValueError, match="x=.*: must be a positive number"):
        check_positive("x", value)


@pytest.mark.parametrize("value", [0, -1, 2.0, True, "3", None])
def test_what_is_no_count(value):
    with pytest.raises(ValueError, match=f"n={value!r}: must be a positive integer"):
        check_count("n", value)


def test_real_numbers():
    assert is_real(-1) and is_real(np.float32(0.5)) and is_real(np.int8(1))
    assert not any(map(is_real, (True, np.bool_(True), 1j, np.complex64(1.0), "1", np.ones(1))))


def test_unknown_names_have_a_nearest_one():
    error = unknown_name("method", "fats", ["fast", "radial"])
    assert str(error) == "unknown method 'fats' (did you mean 'fast'?): allowed are fast, radial"
    assert nearest("x", ["fast", "radial"]) == ""
