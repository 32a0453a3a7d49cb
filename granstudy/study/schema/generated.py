"""Sections of a study file whose fields and help come from dataclasses of the model."""

import dataclasses
import re
import warnings
from collections import defaultdict
from collections.abc import Callable
from functools import reduce
from operator import or_
from types import GenericAlias, UnionType
from typing import Annotated, Any, TypeVar, Union, cast, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, create_model

from granstudy.model.densities import INITIAL_DENSITIES, density_parameters
from granstudy.model.solver import Solver

SAID_ELSEWHERE = ("threads",)
"""Fields of `Solver` that an experiment says for all its runs, outside its solver section."""


class Section(BaseModel):
    """A part of a study file: typed, immutable, without unknown fields."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


OLD_WORDS = {"epsilon": "diffusion"}
"""Words of earlier study files, and what they are called now."""


def renamed(words: dict[str, Any]) -> dict[str, Any]:
    """Words of a study file, with old ones by their names of now; ValueError where both are given."""
    for old, new in OLD_WORDS.items():
        if old in words and new in words:
            raise ValueError(f"{old}, {new}: both say the same; give {new}")
        if old in words:
            warnings.warn(
                f"{old}: is called {new} now, in study files as in Python; it is still read",
                FutureWarning,
                stacklevel=2,
            )
    return {OLD_WORDS.get(name, name): value for name, value in words.items()}


AnySection = TypeVar("AnySection", bound=type[Section])

Fields = dict[str, tuple[Any, Any]]
"""Type and default by name, as `pydantic.create_model` takes them."""


def with_fields(fields: Fields) -> Callable[[AnySection], AnySection]:
    """Class decorator: the section with these fields after its own."""
    definitions: Any = fields  # whose names are known at run time only

    def add(section: AnySection) -> AnySection:
        made = create_model(
            section.__name__,
            __base__=section,
            __module__=section.__module__,
            __doc__=section.__doc__,
            **definitions,
        )
        return cast(AnySection, made)

    return add


def solver_fields() -> Fields:
    """The fields of `Solver`, each of which a study file may leave out."""
    return {
        field.name: _may_be_left_out([field.type], field.metadata["help"])
        for field in dataclasses.fields(Solver)
        if field.name not in SAID_ELSEWHERE
    }


def density_fields() -> Fields:
    """The parameters of all named densities, each with its help and the densities that take it."""
    types: dict[str, list[Any]] = defaultdict(list)
    taken: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for name in INITIAL_DENSITIES:
        for field in density_parameters(name):
            types[field.name].append(field.type)
            taken[field.name][field.metadata["help"]].append(_without_dimension(name))
    return {
        name: _may_be_left_out(types[name], "; ".join(map(_help, by, by.values())))
        for name, by in taken.items()
    }


def _without_dimension(name: str) -> str:
    return re.sub("[23]d$", "", name)


def _help(text: str, densities: list[str]) -> str:
    return f"{', '.join(dict.fromkeys(densities))}: {text}"


def _may_be_left_out(types: list[Any], text: str) -> tuple[Any, Any]:
    """A field of any of these types, None where it is left out."""
    union = reduce(or_, [in_yaml(kind) for kind in types], None)
    return Annotated[union, Field(description=text)], None


def in_yaml(kind: Any) -> Any:
    """A type as YAML writes its values: lists in place of tuples."""
    if get_origin(kind) is tuple:
        return GenericAlias(list, get_args(kind)[:1])
    if get_origin(kind) in (Union, UnionType):
        return reduce(or_, map(in_yaml, get_args(kind)))
    return kind
