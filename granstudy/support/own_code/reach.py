"""The walk from a function through all that it reaches."""

import builtins
import dataclasses
import sys
from collections.abc import Callable
from functools import partial
from inspect import unwrap
from types import BuiltinFunctionType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from granstudy.support.own_code.definitions import Definitions
from granstudy.support.own_code.installed import (
    file_is_installed,
    import_is_installed,
    is_installed,
    known_name,
)
from granstudy.support.own_code.names import (
    attributes_used,
    functions_in,
    global_names,
    imported_names,
    names_when_made,
)
from granstudy.support.own_code.syntax import (
    COPIED,
    Syntax,
    bytecode,
    class_syntax,
    syntax_of,
)
from granstudy.support.own_code.values import content, state_of

OF_EVERY_CLASS = {
    *("__module__", "__qualname__", "__doc__", "__dict__", "__weakref__", "__annotations__"),
    *("__annotate_func__", "__annotations_cache__", "__match_args__", "__slots__", "__hash__"),
    *("__dataclass_fields__", "__dataclass_params__", "__firstlineno__", "__static_attributes__"),
    *("__abstractmethods__", "_abc_impl", "__orig_bases__", "__parameters__"),
}
"""Members that Python gives a class, or that follow from others."""

OF_DATACLASSES = {
    *("__init__", "__repr__", "__eq__", "__hash__", "__setattr__", "__delattr__"),
    *("__lt__", "__le__", "__gt__", "__ge__"),
}
"""Methods that `dataclasses` makes."""

WRAPPERS = ("py_func", "__wrapped__")
"""Where compiling and caching wrappers of libraries (numba, functools) keep a user's function."""


class Reach:
    """All that a function reaches, each function, class and object once.

    Parameters
    ----------
    root : str
        Name of the function, for messages.
    """

    def __init__(self, root: str) -> None:
        self._root = root
        self._numbers: dict[int, int] = {}
        self._alive: list[Any] = []  # what has a number, so that no other object gets its id
        self._contents: dict[int, str] = {}
        self._definitions = Definitions()

    @property
    def source(self) -> str:
        """Source of all that was reached."""
        return self._definitions.text

    def identify(self, function: Callable[..., Any]) -> str:
        """Text that identifies a function with all that it reaches."""
        main = self._content(function, "the function")
        self._definitions.close(function)
        return "\n".join([main, *(f"#{n}: {text}" for n, text in sorted(self._contents.items()))])

    def _content(self, value: Any, where: str) -> str:
        """Text that identifies a value; functions, classes and objects of users by a number."""
        if isinstance(value, ModuleType):
            found: str | None = self._module(value)
        elif isinstance(value, FunctionType | type):
            found = self._definition(value)
        elif isinstance(value, np.ufunc):
            found = self._ufunc(value, where)
        elif isinstance(value, partial):
            parts = (value.func, value.args, {**value.keywords})
            found = f"partial{self._content(parts, where)}"
        elif isinstance(value, MethodType):
            found = f"{self._content(value.__self__, where)}.{value.__func__.__name__}"
        elif isinstance(value, BuiltinFunctionType):
            found = self._builtin(value, where)
        else:
            found = content(value, lambda each: self._content(each, where))
        return self._object(value, where) if found is None else found

    def _definition(self, value: FunctionType | type) -> str:
        """A function or class: an installed one by its name, one of the user by its number."""
        if isinstance(value, type):
            describe = partial(self._class, value)
        else:
            describe = partial(self._function, value)
        if not is_installed(value):
            return self._once(value, describe)
        if isinstance(value, FunctionType) and value.__closure__:
            return self._once(value, partial(self._made_by_library, value))
        return known_name(value)

    def _made_by_library(self, function: FunctionType) -> str:
        """A function that a library made, perhaps of a function of the user."""
        return f"{function.__code__.co_qualname}{self._around(function, bind=False)}"

    def _builtin(self, value: BuiltinFunctionType, where: str) -> str:
        owner = value.__self__
        if owner is None or isinstance(owner, ModuleType):
            return known_name(value)
        return f"{self._content(owner, where)}.{value.__name__}"

    def _object(self, value: Any, where: str) -> str:
        """Text that identifies an object by its class and by what it holds."""
        kind = type(value)
        if (own := getattr(value, "own_function", None)) is not None:
            return self._content(own, where)
        if not is_installed(kind) or _is_frozen(kind):
            held = f"the state of {where}"
            return self._once(
                value, lambda: self._content(kind, where) + self._content(state_of(value), held)
            )
        for name in WRAPPERS:
            if isinstance(inner := getattr(value, name, None), FunctionType):
                return f"{known_name(kind)}({self._content(inner, where)})"
        if isinstance(value, np.vectorize):
            held_values = [value.pyfunc, value.otypes, value.signature, value.excluded]
            return f"vectorize{self._content(held_values, where)}"
        raise ValueError(
            f"{self._root}: {where} is of type {kind.__module__}.{kind.__qualname__}, which has no content "
            "that a run can be known by; pass it as an argument of plain values, or make it inside the "
            "function"
        )

    def _once(self, value: Any, describe: Callable[[], str]) -> str:
        """The number of what is described at its first mention."""
        if id(value) not in self._numbers:
            self._alive.append(value)
            number = self._numbers[id(value)] = len(self._numbers)
            self._contents[number] = describe()
        return f"#{self._numbers[id(value)]}"

    def _function(self, function: FunctionType, is_method: bool = False) -> str:
        code, syntax = function.__code__, syntax_of(function.__code__)
        if file_is_installed(code.co_filename):  # a library's wrapper of the user's function
            return self._made_by_library(function)
        parts = [syntax.content if syntax else bytecode(code)]
        for name in dict.fromkeys([*global_names(code), *names_when_made(syntax)]):
            if name in function.__globals__:
                parts.append(f"{name}={self._global(name, function, syntax)}")
            elif not hasattr(builtins, name):
                parts.append(f"{name} is not defined")
        parts.append(self._around(function))
        for module in imported_names(code):
            if not import_is_installed(module):
                raise ValueError(
                    f"{self._root}: {function.__name__!r} imports {module!r} when it is called; import it at "
                    "the top of the file, so that its code counts"
                )
        if not is_method:
            self._definitions.define(function, syntax.text if syntax else None)
        return "\n".join(parts)

    def _around(self, function: FunctionType, bind: bool = True) -> str:
        """What a function has beside its code: closure, defaults, attributes."""
        parts = []
        for name, cell in zip(
            function.__code__.co_freevars, function.__closure__ or (), strict=True
        ):
            parts.append(f"{name}={self._free(name, cell, function, bind)}")
        for what in (function.__defaults__, function.__kwdefaults__):
            parts.append(self._content(what, f"a default of {function.__name__!r}"))
        own = {key: each for key, each in vars(function).items() if key != "__wrapped__"}
        parts.append(self._content(own, f"an attribute of {function.__name__!r}"))
        return "\n".join(parts)

    def _where(self, name: str, function: FunctionType) -> str:
        user = function.__name__.replace("<lambda>", "lambda")
        by_root = user == self._root.rpartition(":")[2]
        return repr(name) if by_root else f"{name!r}, used by {user!r},"

    def _global(self, name: str, function: FunctionType, syntax: Syntax | None) -> str:
        value, where = function.__globals__[name], self._where(name, function)
        if isinstance(value, ModuleType) and not is_installed(value):
            return self._part_of_module(name, value, syntax, where)
        text = self._content(value, where)
        self._definitions.bind(name, value)
        return text

    def _free(self, name: str, cell: Any, function: FunctionType, bind: bool) -> str:
        """A variable of an enclosing function."""
        try:
            value = cell.cell_contents
        except ValueError:
            return "empty"
        text = self._content(value, self._where(name, function))
        if bind and name != "__class__":
            self._definitions.bind(name, value)
        return text

    def _part_of_module(
        self, name: str, module: ModuleType, syntax: Syntax | None, where: str
    ) -> str:
        """What a function uses of a module of the user, as in ``widths.of(v)``; else all of it."""
        parts = []
        for chain in attributes_used(name, syntax):
            value: Any = module
            used = list[str]()
            for attribute in chain:
                if not isinstance(value, ModuleType) or is_installed(value):
                    break
                value = getattr(value, attribute, None)
                used.append(attribute)
            parts.append(f"{'.'.join(used)}={self._content(value, where)}")
            self._definitions.member(name, ".".join(used), value)
        return f"({','.join(parts)})" if parts else self._module(module)

    def _module(self, module: ModuleType) -> str:
        """A module: an installed one by its name, one of the user by all that it defines."""
        if is_installed(module):
            return f"module {module.__name__}"
        members = {key: each for key, each in vars(module).items() if not key.startswith("__")}
        return self._once(module, lambda: self._content(members, f"in module {module.__name__!r}"))

    def _class(self, cls: Any) -> str:
        parts = [
            f"class {cls.__name__}{self._content(cls.__bases__, f'a base of {cls.__name__!r}')}"
        ]
        if hasattr(cls, "__dataclass_fields__"):
            parts.append(repr(vars(cls).get("__dataclass_params__")))
            parts += [self._field(cls, field) for field in dataclasses.fields(cls)]
        file, known = "", dict[str, Any]()
        for name, member in sorted(vars(cls).items()):
            written = [each for each in functions_in(member) if not _is_generated(each, cls)]
            for function in written:
                syntax, known = syntax_of(function.__code__), function.__globals__
                file = syntax.file if syntax else file
                own = self._once(function, partial(self._function, function, is_method=True))
                parts.append(f"{name}={type(member).__name__}({own})")
            if not functions_in(member) and name not in OF_EVERY_CLASS and not _is_slot(member):
                parts.append(f"{name}={self._content(member, f'{cls.__name__}.{name}')}")
        syntax = class_syntax(file, cls.__qualname__) if file else None
        for name in names_when_made(syntax):
            if isinstance(known.get(name), ModuleType) or is_installed(known.get(name)):
                self._definitions.bind(name, known[name])
        self._definitions.define(cls, syntax.text if syntax else None)
        return "\n".join(parts)

    def _field(self, cls: type, field: "dataclasses.Field[Any]") -> str:
        defaults = [field.default, field.default_factory]
        # Not by identity: cloudpickle, where it copies a class, copies what stands for no default.
        given = [each for each in defaults if not isinstance(each, type(dataclasses.MISSING))]
        return f"{field.name}{self._content(given, f'the default of {cls.__name__}.{field.name}')}"

    def _ufunc(self, function: np.ufunc, where: str) -> str:
        name = function.__name__
        homes = [sys.modules[home] for home in ("numpy", "scipy.special") if home in sys.modules]
        if any(getattr(home, name, None) is function for home in homes):
            return f"ufunc {name}"
        raise ValueError(
            f"{self._root}: {where} is a ufunc {name!r} that neither NumPy nor SciPy has; make it inside "
            "the function"
        )


def _is_frozen(kind: Any) -> bool:
    """Whether it is a class of frozen dataclasses, whose fields are all that they hold."""
    return hasattr(kind, "__dataclass_params__") and bool(kind.__dataclass_params__.frozen)


def _is_generated(method: FunctionType, cls: type) -> bool:
    """Whether `dataclasses` made a method; cloudpickle's copies of such methods have another file."""
    if not hasattr(cls, "__dataclass_fields__"):
        return False
    code = unwrap(method).__code__
    return code.co_filename == "<string>" or (
        code.co_filename == COPIED and code.co_name in OF_DATACLASSES
    )


def _is_slot(member: Any) -> bool:
    return type(member).__name__ in ("member_descriptor", "getset_descriptor")
