"""What identifies a function of a user: its own code, and all code and values that it reaches."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from granstudy.support.own_code.reach import Reach
from granstudy.support.own_code.values import canonical, state_of


@dataclass(frozen=True)
class Code:
    """A function by its content.

    Attributes
    ----------
    name : str
        Name of the function, or of the class of a callable object; ``lambda`` for a lambda.
    arguments : tuple of (str, value)
        What is bound already: keyword arguments of a `functools.partial`, or the state of an object.
    source : str
        Source of the function and of all that it reaches in its own files or notebook.
    digest : str
        SHA-256 over all of this but name and layout, in hexadecimal.
    """

    name: str
    arguments: tuple[tuple[str, Any], ...]
    source: str
    digest: str


def code_of(function: Callable[..., Any]) -> Code:
    """Identify a function by its content.

    The digest is that of the syntax tree of the function and, through its globals and closure, of the
    functions, classes and values that it reaches. It is the same in a notebook, in an imported module and in
    a file loaded by its path. Comments, docstrings, and functions that are not reached do not count. What
    belongs to an installed package counts by its name. Where the source is not known, the compiled
    instructions stand in its place, and `Code.source` says so.

    Raises
    ------
    ValueError
        If the function reaches a value that has no content to be known by: an open file, a random
        generator, an object of a library.
    """
    name = name_of(function)
    while own := getattr(function, "own_function", None):
        function = own
    reach = Reach(name)
    digest = hashlib.sha256(reach.identify(function).encode()).hexdigest()
    return Code(name, _bound(function), reach.source, digest)


def name_of(function: Callable[..., Any]) -> str:
    """A readable name: of a function its own, of a partial its function's, of an object its class's."""
    if isinstance(function, partial):
        return name_of(function.func)
    name = getattr(function, "reference", None) or getattr(function, "__name__", None)
    return str(name or type(function).__name__).replace("<lambda>", "lambda")


def _bound(function: Callable[..., Any]) -> tuple[tuple[str, Any], ...]:
    if isinstance(function, partial):
        values = dict(_bound(function.func)) | function.keywords
    elif hasattr(function, "__code__") or isinstance(function, type):
        values = {}
    else:
        values = state_of(function)
    return tuple((name, canonical(value)) for name, value in sorted(values.items()))
