"""The names that a function looks up outside itself."""

import ast
import dis
from collections.abc import Iterator
from functools import lru_cache
from types import CodeType, FunctionType
from typing import Any

from granstudy.support.own_code.syntax import Syntax


@lru_cache(maxsize=256)
def global_names(code: CodeType) -> tuple[str, ...]:
    """Names that a function and the functions inside it look up in their module, each once."""
    return tuple(dict.fromkeys(_arguments_of(code, ("LOAD_GLOBAL", "LOAD_NAME"))))


@lru_cache(maxsize=256)
def imported_names(code: CodeType) -> tuple[str, ...]:
    """Modules that a function imports while it runs."""
    return tuple(dict.fromkeys(_arguments_of(code, ("IMPORT_NAME",))))


def _arguments_of(code: CodeType, instructions: tuple[str, ...]) -> Iterator[str]:
    for instruction in dis.get_instructions(code):
        if instruction.opname in instructions:
            yield str(instruction.argval)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _arguments_of(constant, instructions)


def names_when_made(syntax: Syntax | None) -> list[str]:
    """Names that are looked up when a function or class is made: in decorators, defaults, bases, values."""
    if syntax is None:
        return []
    roots: list[ast.AST | None] = [*getattr(syntax.node, "decorator_list", [])]
    if isinstance(syntax.node, ast.ClassDef):
        roots += [*syntax.node.bases, *(getattr(part, "value", None) for part in syntax.node.body)]
    else:
        roots += [*syntax.node.args.defaults, *syntax.node.args.kw_defaults]
    inside = [node for root in roots if root is not None for node in ast.walk(root)]
    return list(dict.fromkeys(node.id for node in inside if isinstance(node, ast.Name)))


def attributes_used(name: str, syntax: Syntax | None) -> list[tuple[str, ...]]:
    """What a function uses of a name: ``a.b.c`` gives (b, c). Empty where the name itself is used too."""
    if syntax is None:
        return []
    chains, inner = set(), set()
    for node in ast.walk(syntax.node):
        chain, root = list[str](), node
        while isinstance(root, ast.Attribute):
            chain.insert(0, root.attr)
            inner.add(root.value)
            root = root.value
        if isinstance(root, ast.Name) and root.id == name and node not in inner:
            chains.add(tuple(chain))
    return [] if () in chains else sorted(chains)


def functions_in(member: Any) -> list[FunctionType]:
    """Functions that a member of a class is made of: a method, or what a property or wrapper holds."""
    if isinstance(member, property):
        found = [member.fget, member.fset, member.fdel]
    else:
        found = [getattr(member, "__func__", None) or getattr(member, "func", None) or member]
    return [each for each in found if isinstance(each, FunctionType)]
