"""Checks of what users give: each raises a ValueError that names field, value and allowed."""

import math
import sys
from collections.abc import Callable
from typing import Any, TypeGuard

import numpy as np

LARGEST = sys.float_info.max
"""Largest number of double precision."""


def is_real(value: object) -> TypeGuard[float]:
    """Whether ``value`` is one real number of Python or NumPy, which a float can hold.

    True and False are none, and neither is an integer beyond the largest float.
    """
    if isinstance(value, int):
        return not isinstance(value, bool) and -LARGEST <= value <= LARGEST
    return isinstance(value, (float, np.integer, np.floating))


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


def answer(what: str, function: Callable[..., Any], *at: np.ndarray) -> np.ndarray:
    """What a function of a user returns for arrays, as an array of float64 of its own.

    The function gets copies: what it does to its arguments stays with it.

    Parameters
    ----------
    what : str
        Field and value, ``restitution=<function law>``, for messages.

    Raises
    ------
    ValueError
        If the function fails, or returns anything but real numbers. No memory, no space and no file
        (MemoryError, OSError) are the machine's, and stay as they are.
    """
    try:
        found = np.array(function(*(np.array(each) for each in at)))
    except (MemoryError, OSError):
        raise
    except Exception as error:
        raise ValueError(
            f"{what}: must return an array of real numbers; it raises {type(error).__name__}: {error}"
        ) from error
    if found.dtype.kind not in "iuf":
        raise ValueError(f"{what}: must return an array of real numbers, got type {found.dtype}")
    return found.astype(np.float64)
