"""The arguments that a function of a user takes, and which of its parameters are velocities."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from granstudy.support.errors import nearest
from granstudy.support.own_code.code import name_of

REQUIRED = inspect.Parameter.empty
"""Stands for the default of an argument that has none."""


class Parameters(NamedTuple):
    """What is left of a function's parameters once arguments are given.

    Attributes
    ----------
    open : tuple of str
        Parameters without a value, in order.
    any_number : bool
        Whether the function takes any number of positional arguments (``*v``).
    """

    open: tuple[str, ...]
    any_number: bool


def arguments_of(function: Callable[..., Any]) -> dict[str, Any]:
    """Names and defaults of all that can be given to a function by name; `REQUIRED` where there is none.

    Velocity components and impact speeds are among them: which these are depends on what is given
    (`parameters_left`).
    """
    by_name = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    parameters = _signature(function).parameters
    return {name: each.default for name, each in parameters.items() if each.kind in by_name}


def parameters_left(function: Callable[..., Any], arguments: Mapping[str, Any]) -> Parameters:
    """What a function still needs beside the arguments given by name.

    Raises
    ------
    ValueError
        If the function does not take one of the arguments, or if a parameter without a value stands behind
        one that has a value: then an argument is missing.
    """
    name, parameters = name_of(function), _signature(function).parameters.values()
    allowed = list(arguments_of(function))
    takes_all = any(each.kind is each.VAR_KEYWORD for each in parameters)
    for given in arguments:
        if given not in allowed and not takes_all:
            there = ", ".join(allowed) or "none"
            raise ValueError(
                f"{name}: has no argument {given!r}{nearest(given, allowed)}; it has {there}"
            )
    variable = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    fixed = [each for each in parameters if each.kind not in variable]
    left = [each for each in fixed if each.default is REQUIRED and each.name not in arguments]
    for place, each in enumerate(left):
        if each.kind is each.KEYWORD_ONLY or fixed[place] is not each:
            raise ValueError(_missing(name, each.name, fixed))
    any_number = any(each.kind is each.VAR_POSITIONAL for each in parameters)
    return Parameters(tuple(each.name for each in left), any_number)


def dimension(function: Callable[..., Any], left: Parameters, dim: int | None) -> int:
    """Velocity dimension of a density by the parameters that are left, checked against ``dim`` where given.

    Raises
    ------
    ValueError
        If the parameters left are not the 2 or 3 components of the velocity.
    """
    name, count = name_of(function), len(left.open)
    if left.any_number:
        if dim is None:
            raise ValueError(f"{name}: takes any number of velocity components; give dim, 2 or 3")
        return dim
    if count not in (2, 3) or (dim is not None and count != dim):
        wanted = "2 or 3" if dim is None else str(dim)
        raise ValueError(
            f"{name}: {', '.join(left.open)} have no value; of a density the {wanted} components of the "
            "velocity have none, all others need a default or a value"
        )
    return count


def _missing(name: str, argument: str, parameters: Sequence[inspect.Parameter]) -> str:
    return (
        f"{name}: argument {argument!r} is missing; its arguments are "
        f"{', '.join(each.name for each in parameters)}, and those without a value must come first"
    )


def _signature(function: Callable[..., Any]) -> inspect.Signature:
    try:
        return inspect.signature(function)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name_of(function)}: its arguments are not known ({error})") from None
