"""Checks of numbers that several rooms make: each raises a ValueError that names field, value and allowed."""

import numpy as np


def check_positive(field: str, value: object) -> None:
    """Raise ValueError unless ``value`` is a finite number above 0."""
    is_number = isinstance(value, (int, float, np.number)) and not isinstance(value, bool)
    if not (is_number and np.isfinite(value) and value > 0):  # type: ignore[call-overload, operator]
        raise ValueError(f"{field}={value!r}: must be a positive number")


def check_count(field: str, value: object) -> None:
    """Raise ValueError unless ``value`` is an integer of at least 1."""
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise ValueError(f"{field}={value!r}: must be a positive integer")
