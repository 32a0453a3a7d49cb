"""The sweep of an experiment: its blocks, their lists and ranges, checked word by word before any run."""

import dataclasses
import math
from collections.abc import Mapping
from types import NoneType
from typing import Any, get_args

from pydantic import ValidationError

from granstudy.model.solver import Solver
from granstudy.study.schema.generated import renamed
from granstudy.study.schema.sections import RangeModel, SceneModel, SolverModel, TimeModel, Value
from granstudy.study.schema.values import allowed, fits, hint, members, refusal, shown
from granstudy.study.schema.words import SWEPT
from granstudy.support.errors import nearest

MOST_RUNS = 100_000
"""Runs of an experiment at most."""

LONGEST_TEXT = 100
"""Characters of a swept text at most: it becomes a folder's name."""

TYPES = {
    "scene": str,
    **{
        name: field.annotation
        for section in (SceneModel, SolverModel, TimeModel)
        for name, field in section.model_fields.items()
        if name in SWEPT
    },
}
"""What one value can be, by word; arguments of own functions can be any `Value`."""

MAY_BE_NONE = {f.name for f in dataclasses.fields(Solver) if NoneType in get_args(f.type)}
"""Words of which null is a value."""


def values_of(entry: Any) -> list[Any]:
    """The values of one entry of a sweep: a range's, a list's, or the one value itself."""
    if isinstance(entry, RangeModel):
        return list(entry.values())
    return entry if isinstance(entry, list) else [entry]


def count_of(entry: Any) -> int:
    """How many values an entry has, without making them."""
    if isinstance(entry, RangeModel):
        return len(entry)
    return len(entry) if isinstance(entry, list) else 1


def read_sweep(blocks: Any) -> Any:
    """The blocks of a sweep with ranges read, each word and value checked.

    Raises
    ------
    ValueError
        One line a mistake, each naming word, value and what is allowed.
    """
    if not isinstance(blocks, list) or not all(isinstance(block, dict) for block in blocks):
        raise ValueError(
            f"value {shown(blocks)}: must be a list of blocks, as in - {{e: [0.2, 0.5]}}"
        )
    if not blocks:
        raise ValueError("value []: is empty; give at least one block, as in - {e: [0.2, 0.5]}")
    mistakes: dict[str, None] = {}
    read: list[dict[str, Any]] = []
    for block in blocks:
        names = renamed(block)
        read.append({})
        for word, entry in names.items():
            try:
                read[-1][word] = _entry(word, entry)
            except ValueError as error:
                mistakes |= dict.fromkeys(str(error).splitlines())
    for line in () if mistakes else _counted(read):
        mistakes[line] = None
    if mistakes:
        raise ValueError("\n".join(mistakes))
    return read


def _entry(word: str, entry: Any) -> Any:
    """One entry, with its range read and its values checked."""
    if not word:
        raise ValueError(f"word '': is none; allowed are {', '.join(SWEPT)}")
    if isinstance(entry, dict):
        return _range(word, entry)
    values = entry if isinstance(entry, list) else [entry]
    if not values:
        raise ValueError(f".{word}: is empty; give at least one value")
    for value in values:
        _check_value(word, value)
    return entry


def _range(word: str, entry: Mapping[str, Any]) -> RangeModel:
    """A range of a word that takes numbers."""
    try:
        found = RangeModel.model_validate(entry)
    except ValidationError as error:
        lines = [_in_range(word, problem) for problem in error.errors()]
        raise ValueError("\n".join(lines)) from None
    if word in TYPES and not {int, float} & set(members(TYPES[word])):
        raise ValueError(f".{word}: value {shown(dict(entry))}: must be {allowed(TYPES[word])}")
    for value in found.values():
        _check_value(word, value)
    return found


def _in_range(word: str, problem: Any) -> str:
    """One line for what is wrong in a range."""
    name, kind = ".".join(map(str, problem["loc"])), problem["type"]
    known = list(RangeModel.model_fields)
    where = f".{word}.{name}" if name else f".{word}"
    if kind == "missing":
        return f"{where}: must be given"
    if kind == "extra_forbidden":
        return f"{where}: unknown field of a range{nearest(name, known)}; allowed are {', '.join(known)}"
    field = RangeModel.model_fields.get(name)
    return f"{where}: {refusal(problem, field and field.annotation)}"


def _check_value(word: str, value: Any) -> None:
    """Raise ValueError unless a word takes a value."""
    kind = TYPES.get(word, Value)
    if value is None and (word not in TYPES or word in MAY_BE_NONE):
        return
    if not fits(kind, value):
        raise ValueError(
            f".{word}: value {shown(value)}: must be {allowed(kind)}{hint(kind, value)}"
        )
    if isinstance(value, str) and len(value) > LONGEST_TEXT:
        raise ValueError(
            f".{word}: value {shown(value)}: must have {LONGEST_TEXT} characters at most; it becomes a "
            "folder's name"
        )


def _counted(blocks: list[dict[str, Any]]) -> list[str]:
    """What is wrong where the blocks have too many runs together."""
    runs = sum(math.prod(count_of(entry) for entry in block.values()) for block in blocks)
    if runs <= MOST_RUNS:
        return []
    sizes = [
        " × ".join(f"{count_of(entry)} {word}" for word, entry in block.items()) for block in blocks
    ]
    return [f"has {runs} runs ({' + '.join(sizes)[:200]}); must be {MOST_RUNS} at most"]
