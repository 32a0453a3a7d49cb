"""Values as text and as plain data, the same for equal values in every process."""

import dataclasses
import hashlib
from collections.abc import Callable
from decimal import Decimal
from enum import Enum
from functools import cached_property
from numbers import Number
from pathlib import PurePath
from types import EllipsisType
from typing import Any

import numpy as np

from granstudy.support.checks import plain

SIMPLE = (type(None), EllipsisType, str, bytes, Number, Decimal, range, slice, np.dtype)
"""Types whose ``repr`` says all of a value."""

SHOWN = 32
"""Elements up to which an array is shown whole."""


def canonical(value: Any) -> Any:
    """A value as plain data that JSON can hold: numbers, texts, tuples; else a text that identifies it."""
    value = plain(value)
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple):
        return tuple(canonical(each) for each in value)
    if isinstance(value, np.ndarray) and value.dtype != object and value.size <= SHOWN:
        return canonical(value.tolist())
    if isinstance(value, np.ndarray):
        return f"array of shape {value.shape}, SHA-256 {_array_digest(value)[:16]}"
    return getattr(value, "__name__", None) or _short(value)


def _short(value: Any) -> str:
    text = repr(value)
    return f"{type(value).__name__} object" if " at 0x" in text else text


def simple_content(value: Any) -> str | None:
    """Text that identifies a number, text or another simple value; None where the value is not simple."""
    value = plain(value)
    if isinstance(value, float) and value.is_integer() and abs(value) < 2**53:
        value = int(value)  # 2 and 2.0 are one value, as in Python
    if isinstance(value, SIMPLE) and not isinstance(value, Enum):
        return repr(value)
    if isinstance(value, PurePath):
        return f"path {str(value)!r}"
    if isinstance(value, np.ndarray) and value.dtype != object:
        return f"array {value.dtype.str}{value.shape} {_array_digest(value)}"
    return None


def content(value: Any, inside: Callable[[Any], str]) -> str | None:
    """Text that identifies a value; None for one that has no content to be known by.

    Parameters
    ----------
    inside : callable
        Identifies the parts of containers.
    """
    if (simple := simple_content(value)) is not None:
        return simple
    if isinstance(value, Enum):
        return f"{type(value).__qualname__}.{value.name}"
    if type(value) in (list, tuple):  # YAML has lists where Python has tuples
        return f"[{','.join(map(inside, value))}]"
    if type(value) in (set, frozenset):
        return f"set({','.join(sorted(map(inside, value)))})"
    if type(value) is dict:
        items = sorted(f"{inside(key)}:{inside(each)}" for key, each in value.items())
        return f"{{{','.join(items)}}}"
    return None


def state_of(value: Any) -> dict[str, Any]:
    """What an object holds: fields of a dataclass, else attributes, without values that are computed late."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    late = {
        name
        for cls in type(value).__mro__
        for name, member in vars(cls).items()
        if isinstance(member, cached_property)
    }
    slots = {
        name: getattr(value, name)
        for cls in type(value).__mro__
        for name in np.atleast_1d(getattr(cls, "__slots__", ())).tolist()
        if name not in ("__dict__", "__weakref__") and hasattr(value, name)
    }
    held = getattr(value, "__dict__", {})
    return slots | {name: each for name, each in held.items() if name not in late}


def _array_digest(array: np.ndarray) -> str:
    return hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()
