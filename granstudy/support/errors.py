"""Errors that several rooms raise, and how a message says that a name is not known."""

import difflib
from collections.abc import Sequence

import numpy as np


class NotFiniteError(ValueError):
    """A density holds NaN or infinite values."""


RAN_AWAY = (NotFiniteError, ArithmeticError, np.linalg.LinAlgError)
"""What arithmetic raises where a density runs away: overflow, division by zero, a singular matrix."""


class LawRangeError(NotFiniteError):
    """A law of restitution is asked for speeds at which it has no value; the message says which."""


class ToleranceError(ValueError):
    """A tolerance cannot be reached on the solver's grid."""


class DamagedFileError(ValueError):
    """A file of a dataset is damaged, or is none of granstudy's; the message names it and the remedy."""


def unknown_name(what: str, name: object, allowed: Sequence[str]) -> ValueError:
    """Error that says what is unknown, its value, the names allowed, and the nearest of them."""
    return ValueError(
        f"unknown {what} {name!r}{nearest(str(name), allowed)}: allowed are {', '.join(allowed)}"
    )


def nearest(name: str, allowed: Sequence[str]) -> str:
    """Text `` (did you mean 'x'?)`` for the allowed name nearest to ``name``; "" where none is near."""
    close = difflib.get_close_matches(name, allowed, n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""
