"""The source of all that a function reaches, as one text that can be read and run."""

import sys
from functools import partial
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from granstudy.support.checks import plain
from granstudy.support.own_code.installed import is_installed
from granstudy.support.own_code.values import simple_content

SHOWN = 1000
"""Elements up to which an array stands in the text."""


class Definitions:
    """Imports, constants, functions and classes, each after those that it needs."""

    def __init__(self) -> None:
        self._imports: dict[str, None] = {}
        self._entries: dict[str, str] = {}
        self._lambdas: dict[int, str] = {}

    @property
    def text(self) -> str:
        """All of it."""
        blocks = ["\n".join(sorted(self._imports)), *self._entries.values()]
        return "\n\n".join(block.strip("\n") for block in blocks if block) + "\n"

    def define(self, value: FunctionType | type, text: str | None) -> None:
        """A function or class with its source, None where that is not known."""
        name = value.__name__
        if text is None:
            text = f"# {name}: source not known, identified by its compiled code"
        elif name == "<lambda>":
            self._lambdas[id(value)] = text
            return
        self._put(name, text)

    def bind(self, name: str, value: Any) -> None:
        """A global or a variable of an enclosing function, with its value."""
        if isinstance(value, ModuleType):
            whole = value.__name__ == name
            self._imports[f"import {name}" if whole else f"import {value.__name__} as {name}"] = (
                None
            )
        elif (line := _import_of(name, value)) is not None:
            self._imports[line] = None
        elif id(value) in self._lambdas:
            self._put(name, f"{name} = {self._lambdas[id(value)]}")
        elif getattr(value, "__name__", None) != name:
            self._put(name, f"{name} = {self._literal(value)}")

    def member(self, module: str, name: str, value: Any) -> None:
        """What is used of a module of the user: ``module.name``."""
        self.bind(name.rpartition(".")[2], value)
        self._imports["from types import SimpleNamespace"] = None
        known = self._entries.pop(module, f"{module} = SimpleNamespace()")
        self._entries[module] = f"{known}\n{module}.{name} = {name.rpartition('.')[2]}"

    def close(self, function: Any) -> None:
        """The function that all of this is reached from; a lambda gets a name here."""
        while isinstance(function, partial):
            function = function.func
        if id(function) in self._lambdas:
            self.bind("function", function)

    def _put(self, name: str, text: str) -> None:
        if self._entries.get(name, text) != text:
            name, text = f"another {name}", f"# another {name}, of another file:\n{text}"
        self._entries[name] = text

    def _literal(self, value: Any) -> str:
        """A value as Python writes it, dots where it cannot be written."""
        value = getattr(value, "own_function", value)
        if isinstance(value, partial):
            bound = "".join(
                f", {key}={self._literal(each)}" for key, each in value.keywords.items()
            )
            placed = "".join(f", {self._literal(each)}" for each in value.args)
            self._imports["from functools import partial"] = None
            return f"partial({self._literal(value.func)}{placed}{bound})"
        if isinstance(value, FunctionType | type):
            return self._lambdas.get(id(value), value.__name__)
        if isinstance(value, np.ndarray):
            self._imports["from numpy import array, float32, float64, int64"] = None
            if value.size > SHOWN:
                return f"...  # {simple_content(value)}"
            with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
                return repr(value)
        text = repr(plain(value))
        return f"...  # {type(value).__name__}" if text.startswith("<") else text


def _import_of(name: str, value: Any) -> str | None:
    """The line that imports an installed object, None for all else."""
    if isinstance(value, np.ufunc):
        module = "numpy" if getattr(np, value.__name__, None) is value else "scipy.special"
        original = value.__name__
    elif is_installed(value) and hasattr(value, "__name__"):
        module, original = value.__module__, value.__name__
    else:
        return None
    return f"from {module} import {original}" + ("" if original == name else f" as {name}")
