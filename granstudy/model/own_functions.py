"""Densities and restitution laws of users: functions with their arguments, known by their content."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from granstudy.support.checks import plain
from granstudy.support.own_code.code import Code, code_of, name_of
from granstudy.support.own_code.installed import OWN_PACKAGE
from granstudy.support.own_code.signature import (
    REQUIRED,
    arguments_of,
    dimension,
    parameters_left,
)


@dataclass(frozen=True, eq=False, repr=False)
class OwnFunction:
    """A function of a user with its arguments. Equal content makes equal functions.

    Attributes
    ----------
    function : callable
        The function as the user wrote it.
    arguments : tuple of (str, value)
        All its arguments, defaults included.
    made : callable or object
        What is called: the function with its arguments, or what the function returned where it makes the
        density or the law.
    """

    function: Callable[..., Any]
    arguments: tuple[tuple[str, Any], ...]
    made: Any
    _digest: str | None = field(init=False)

    def __post_init__(self) -> None:
        try:
            digest: str | None = self.code.digest
        except ValueError:  # such a function is itself alone
            digest = None
        object.__setattr__(self, "_digest", digest)

    @property
    def code(self) -> Code:
        """The content of the function and its arguments; ValueError where it has none to be known by."""
        if not self.arguments:
            return code_of(self.function)
        return code_of(partial(self.function, **dict(self.arguments)))

    @property
    def own_function(self) -> Callable[..., Any]:
        """The function with its arguments."""
        return partial(self.function, **dict(self.arguments)) if self.arguments else self.function

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)) or self._digest is None:
            return self is other
        return self._digest == other._digest

    def __hash__(self) -> int:
        return hash(self._digest)

    def __dask_tokenize__(self) -> tuple[str, str]:
        """What Dask knows the function by."""
        return type(self).__name__, self._digest or str(id(self))

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={value!r}" for name, value in self.arguments)
        return f"{name_of(self.function)}({given})"


@dataclass(frozen=True, eq=False, repr=False)
class OwnDensity(OwnFunction):
    """An initial density of a user.

    Attributes
    ----------
    dim : int
        Velocity dimension.
    """

    dim: int

    @property
    def scene(self) -> Any:
        """The whole scene where the function makes one, else None."""
        return self.made if _is_scene(self.made) else None

    @property
    def density(self) -> Callable[..., np.ndarray]:
        """The density itself."""
        density: Callable[..., np.ndarray] = self.made.initial if self.scene else self.made
        return density

    @property
    def symmetry(self) -> Any:
        """The symmetry that the function, or what it made, declares; ``none`` where none is declared."""
        return self._declared("symmetry") or "none"

    @property
    def moments(self) -> Any:
        """The moments that the function, or what it made, states; None where none are stated."""
        return self._declared("moments")

    def _declared(self, name: str) -> Any:
        found = getattr(self.made, name, None)
        return getattr(_innermost(self.function), name, None) if found is None else found

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """Density at the velocities ``v``."""
        return self.density(*v)

    def __eq__(self, other: object) -> bool:
        return super().__eq__(other) and getattr(other, "dim", None) == self.dim

    __hash__ = OwnFunction.__hash__

    def __reduce__(self) -> tuple[Any, ...]:
        return own_density, (self.function, dict(self.arguments), self.dim)


@dataclass(frozen=True, eq=False, repr=False)
class OwnLaw(OwnFunction):
    """A restitution law of a user."""

    def __call__(self, impact_speed: np.ndarray) -> np.ndarray:
        """Restitution at the normal impact speeds."""
        law: np.ndarray = self.made(impact_speed)
        return law

    def __reduce__(self) -> tuple[Any, ...]:
        return own_law, (self.function, dict(self.arguments))


def own_density(
    function: Callable[..., Any], arguments: Mapping[str, Any] | None = None, dim: int | None = None
) -> OwnDensity:
    """A density out of a function and arguments given by name.

    Parameters of the function that have neither a value nor a default are the components of the velocity:
    they stand first, and their number is the dimension. A function that takes ``*v`` needs ``dim``. A
    function of which no parameter is left makes the density: it returns a function of the components, an
    object that is one (`granstudy.model.densities.InitialDensity`), or a `granstudy.Scene`.

    Raises
    ------
    ValueError
        For an unknown or a missing argument, for components that are not 2 or 3, or where the function that
        makes a density fails or returns something else.
    """
    function, given, left = _prepared(function, arguments)
    if left.open or left.any_number:
        dim = dimension(function, left, dim)
        return OwnDensity(function, given, partial(function, **dict(given)), dim)
    made = _made(function, given)
    if not callable(made) and not _is_scene(made):
        raise ValueError(
            f"{name_of(function)}: returns {made!r}; a function without velocity components must return a "
            "density, which is a function of them, or a Scene"
        )
    own = getattr(made, "dim", None)
    if own is None:
        own = dimension(made, parameters_left(made, {}), dim)
    if dim not in (None, own):
        raise ValueError(f"{name_of(function)}: makes a density of dim {own}, not of dim={dim}")
    return OwnDensity(function, given, made, own)


def own_law(function: Callable[..., Any], arguments: Mapping[str, Any] | None = None) -> OwnLaw:
    """A restitution law out of a function of the normal impact speed and arguments given by name.

    The impact speed is the first parameter, and the only one without a value. A function or class of which no
    parameter is left makes the law.

    Raises
    ------
    ValueError
        For an unknown or a missing argument, or where what makes a law fails or returns something else.
    """
    function, given, left = _prepared(function, arguments)
    name = name_of(function)
    if len(left.open) > 1:
        raise ValueError(
            f"{name}: argument {left.open[1]!r} is missing; of a law the impact speed alone, "
            f"{left.open[0]!r}, has no value"
        )
    if left.open or left.any_number:
        return OwnLaw(function, given, partial(function, **dict(given)))
    made = _made(function, given)
    if not callable(made):
        raise ValueError(
            f"{name}: returns {made!r}; without an impact speed it must return a law, which is a function of "
            "it"
        )
    return OwnLaw(function, given, made)


def settled(function: Any, dim: int | None = None) -> Any:
    """A plain function of the user as `OwnDensity` (with ``dim``) or `OwnLaw`, which know its defaults.

    Anything else is returned as it is: what granstudy makes, objects with a class, functions of unusual
    parameters.
    """
    if not hasattr(_innermost(function), "__code__") or isinstance(function, OwnFunction):
        return function
    try:
        left = parameters_left(function, {})
        if not (left.open or left.any_number):
            return function
        return own_law(function) if dim is None else own_density(function, dim=dim)
    except ValueError:
        return function


def is_granstudys(value: object) -> bool:
    """Whether an object is of a class of granstudy, whose ``repr`` says all of it."""
    module = type(value).__module__.partition(".")[0]
    return module == OWN_PACKAGE and not isinstance(value, OwnFunction)


def _prepared(function: Callable[..., Any], arguments: Mapping[str, Any] | None) -> Any:
    """The function, all its arguments with their values, and the parameters that are left."""
    arguments = dict(arguments or {})
    if isinstance(function, partial) and not function.args:
        return _prepared(function.func, function.keywords | arguments)
    left = parameters_left(function, arguments)
    defaults = {
        name: value for name, value in arguments_of(function).items() if value is not REQUIRED
    }
    given = {name: _value(value) for name, value in (defaults | arguments).items()}
    return function, tuple(sorted(given.items())), left


def _value(value: Any) -> Any:
    """A value as functions get it from YAML and Python alike: numbers of Python, tuples for lists."""
    if isinstance(value, list | tuple):
        return tuple(_value(each) for each in value)
    return value.copy() if isinstance(value, np.ndarray) else plain(value)


def _made(function: Callable[..., Any], given: tuple[tuple[str, Any], ...]) -> Any:
    try:
        return function(**dict(given))
    except Exception as error:
        shown = ", ".join(f"{name}={value!r}" for name, value in given)
        raise ValueError(
            f"{name_of(function)}({shown}): {type(error).__name__}: {error}"
        ) from error


def _is_scene(made: Any) -> bool:
    return all(hasattr(made, name) for name in ("initial", "kernel", "restitution", "dim"))


def _innermost(function: Any) -> Any:
    """The function itself, without its file's reference and without bound arguments."""
    while isinstance(function, partial) or hasattr(function, "own_function"):
        function = function.func if isinstance(function, partial) else function.own_function
    return function
