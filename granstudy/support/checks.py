"""Checks of numbers: each raises a ValueError that names field, value and allowed."""

import math
from typing import Any, TypeGuard

import numpy as np


def is_real(value: object) -> TypeGuard[float]:
    """Whether ``value`` is one real number of Python or NumPy; True and False are none."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def plain(value: Any) -> Any:
    """The number of Python for one of NumPy, 0.0 for −0.0; anything else as it is."""
    if isinstance(value, np.generic):
        value = value.item()
    return 0.0 if isinstance(value, float) and value == 0.0 else value


def check_positive(field: str, value: object) -> None:
    """Raise ValueError unless ``value`` is a finite number above 0."""
    if not (is_real(value) and 0.0 < value < math.inf):
        raise ValueError(f"{field}={value!r}: must be a positive number")


def is_count(value: object) -> TypeGuard[int]:
    """Whether ``value`` is an integer of at least 1; True is none."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and bool(value >= 1)


def check_count(field: str, value: object) -> None:
    """Raise ValueError unless ``value`` is an integer of at least 1."""
    if not is_count(value):
        raise ValueError(f"{field}={value!r}: must be a positive integer")
