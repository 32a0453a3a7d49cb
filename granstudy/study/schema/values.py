"""Values of fields and of sweeps: which types a field takes, said in words."""

from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

WORDS = {
    float: "a number",
    int: "a whole number",
    bool: "true or false",
    str: "a text",
    dict: "a section",
    list: "a list",
}
"""Types in words."""

LONGEST = 80
"""Characters of a value in a message."""


def members(kind: Any) -> list[Any]:
    """The types of a union, without None; of another type itself."""
    if get_origin(kind) is Annotated:
        return members(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return [member for part in get_args(kind) for member in members(part)]
    return [] if kind is NoneType else [kind]


def fits(kind: Any, value: Any) -> bool:
    """Whether a value, as YAML gives it, is of a type; sections do not count."""
    return any(_fits(member, value) for member in members(kind))


def _fits(kind: Any, value: Any) -> bool:
    if kind is float:
        return type(value) in (int, float)
    if get_origin(kind) is list:
        (inner,) = get_args(kind)[:1]
        return isinstance(value, list) and all(fits(inner, each) for each in value)
    return type(value) is kind


def allowed(kind: Any) -> str:
    """What a field of a type takes, in words: ``a number or a text``."""
    return " or ".join(dict.fromkeys(_words(member) for member in members(kind)))


def _words(kind: Any) -> str:
    if get_origin(kind) is list:
        return f"a list of {_plural(get_args(kind)[0])}"
    if get_origin(kind) is Literal:
        return " or ".join(map(str, get_args(kind)))
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return f"a section of {', '.join(kind.model_fields)}"
    return WORDS.get(get_origin(kind) or kind, "a value of another type")


def _plural(kind: Any) -> str:
    inner = members(kind)
    if all(member in (int, float) for member in inner):
        return "whole numbers" if inner == [int] else "numbers"
    return "texts" if inner == [str] else "values"


def shown(value: Any) -> str:
    """A value as messages show it, cut where it is long."""
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 20]} ... {text[-15:]}"


LONGEST_LINE = 600
"""Characters of a message."""


def cut(text: str) -> str:
    """A message without its middle where it is long."""
    return text if len(text) <= LONGEST_LINE else f"{text[:400]} ... {text[-150:]}"


def hint(kind: Any, value: Any) -> str:
    """What to write in place of a value that YAML does not read as it looks; "" for others."""
    if isinstance(value, list) and len(value) == 1 and not fits(kind, value):
        return hint(kind, value[0])
    inner = members(kind)
    if isinstance(value, str) and (float in inner or int in inner):
        number = _number(value)
        if number is not None:
            return f" (YAML reads {value} as text: write {_written(value, number, float in inner)})"
    if isinstance(value, float) and value.is_integer() and int in inner and abs(value) < 2**63:
        return f" (write {int(value)})"
    if isinstance(value, bool) and str in inner and bool not in inner:
        return (
            " (YAML reads yes, no, on and off as true and false: write none, or the word in quotes)"
        )
    return ""


def refusal(problem: Any, kind: Any) -> str:
    """Why pydantic refused the value of a field of a type: the value, and what is allowed."""
    value, message = problem["input"], str(problem["msg"])
    if problem["type"] == "value_error":
        return message.removeprefix("Value error, ")
    if kind is not None and problem["type"].endswith(TYPE_ERRORS):
        inner = _inner(kind, problem["loc"])
        return f"value {shown(value)}: must be {allowed(inner)}{hint(inner, value)}"
    return f"value {shown(value)}: {message.replace('Input should', 'must')}"


TYPE_ERRORS = ("_type", "_parsing", "_attributes_type", "_from_float", "_size", "is_instance_of")
"""Endings of pydantic's names for a value of the wrong type."""


def _inner(kind: Any, place: Any) -> Any:
    """The type at a place: of a list's item where the place ends with its number."""
    if not isinstance(place[-1], int):
        return kind
    items = [get_args(member)[0] for member in members(kind) if get_origin(member) is list]
    return items[0] if items else kind


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if abs(number) < float("inf") else None


def _written(text: str, number: float, real: bool) -> str:
    """A number in a text as YAML reads it: with a point, and a sign before the exponent."""
    if not real and number.is_integer():
        return str(int(number))
    mantissa, e, exponent = text.strip().lower().partition("e")
    if not e:
        return repr(number)
    mantissa += "" if "." in mantissa else ".0"
    sign = "" if exponent[0] in "+-" else "+"
    return f"{mantissa}e{sign}{exponent}"
