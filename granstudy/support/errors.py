"""One way to say that a name is not known."""

import difflib
from collections.abc import Sequence


def unknown_name(what: str, name: object, allowed: Sequence[str]) -> ValueError:
    """Error naming ``what``, the value, what is allowed, and the nearest name if one is near."""
    return ValueError(
        f"unknown {what} {name!r}{nearest(str(name), allowed)}: allowed are {', '.join(allowed)}"
    )


def nearest(name: str, allowed: Sequence[str]) -> str:
    """`` (did you mean 'x'?)`` for the allowed name nearest to ``name``, or nothing."""
    close = difflib.get_close_matches(name, allowed, n=1)
    return f" (did you mean {close[0]!r}?)" if close else ""


class NotFiniteError(ValueError):
    """A density holds NaN or infinite values."""


class ToleranceError(ValueError):
    """A tolerance cannot be reached on the solver's grid."""
