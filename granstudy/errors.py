"""One way to say that a name is not known."""

import difflib
from collections.abc import Sequence


def unknown_name(what: str, name: object, allowed: Sequence[str]) -> ValueError:
    """Error naming ``what``, the value, what is allowed, and the nearest name if one is near."""
    close = difflib.get_close_matches(str(name), allowed, n=1)
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    return ValueError(f"unknown {what} {name!r}{hint}: allowed are {', '.join(allowed)}")
