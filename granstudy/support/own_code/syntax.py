"""The syntax tree and the text of a function, found from its code object."""

import ast
import linecache
import sys
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from types import CodeType
from typing import Any, NamedTuple

from granstudy.support.fingerprint import without_texts

FunctionNode = ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda
"""Nodes that become functions."""

COPIED = "<dynamic-code>"
"""File of functions that cloudpickle copied, in place of their own."""

_seen: dict[tuple[Any, ...], "Syntax"] = {}
"""Syntax of the functions identified so far, by their instructions, for copies of them."""

HAS_DOCSTRING = 0x4000000
"""Flag of a code object with a docstring, since Python 3.13; before, every ``def`` has one or None."""


@dataclass(frozen=True)
class Syntax:
    """A function or class as its file or cell has it now.

    Attributes
    ----------
    node : ast node
    text : str
        Its source; of a lambda the expression alone.
    content : str
        The tree as text, without docstrings, comments and places.
    file : str
        File or cell that it stands in.
    """

    node: FunctionNode | ast.ClassDef
    text: str
    content: str
    file: str


def syntax_of(code: CodeType) -> Syntax | None:
    """The syntax of the function that a code object belongs to.

    The file or cell is compiled again, and the function found by its instructions: what its file has become
    since the function was made is never taken for the function. None where there is no such source: code of
    ``exec`` or of a prompt, or a file that was edited since.
    """
    wanted = _instructions(code)
    if code.co_filename == COPIED:
        return _seen.get(wanted)
    candidates = _functions(_lines(code.co_filename))
    alike = [each for each in candidates if each.instructions == wanted]
    for found in [each for each in alike if each.code == code] + alike:
        text = _lines(code.co_filename)
        syntax = _seen[wanted] = _syntax(text, found.node, code.co_filename)
        return syntax
    return None


def class_syntax(filename: str, qualname: str) -> Syntax | None:
    """The syntax of a class by its file or cell and its qualified name, None where it is not there."""
    text = _lines(filename)
    tree: ast.AST | None = _tree(text)
    if tree is None:
        return None
    for name in qualname.replace(".<locals>", "").split("."):
        inside = [
            node
            for node in ast.walk(tree)
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name
        ]
        if not inside:
            return None
        tree = inside[-1]
    return _syntax(text, tree, filename) if isinstance(tree, ast.ClassDef) else None


@lru_cache(maxsize=256)
def _syntax(text: str, node: FunctionNode | ast.ClassDef, file: str) -> Syntax:
    return Syntax(node, _segment(text, node), ast.dump(without_texts(node)), file)


def _lines(filename: str) -> str:
    """What a file or a notebook's cell holds now; "" where that is not known."""
    linecache.checkcache(filename)
    return "".join(linecache.getlines(filename))


@lru_cache(maxsize=32)
def _tree(text: str) -> ast.Module | None:
    try:
        return ast.parse(text)
    except (SyntaxError, ValueError):
        return None


class _Function(NamedTuple):
    """A function of a source."""

    code: CodeType
    instructions: tuple[Any, ...]
    node: FunctionNode


@lru_cache(maxsize=32)
def _functions(text: str) -> list[_Function]:
    """All functions of a source; none where the source does not compile."""
    tree = _tree(text)
    if tree is None:
        return []
    module = compile(text, "<own code>", "exec", dont_inherit=True)
    nodes = [node for node in ast.walk(tree) if isinstance(node, FunctionNode)]
    pairs = ((code, _node(code, nodes)) for code in _nested(module))
    return [_Function(code, _instructions(code), node) for code, node in pairs if node is not None]


def _nested(code: CodeType) -> Iterator[CodeType]:
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield constant
            yield from _nested(constant)


def _node(code: CodeType, nodes: list[FunctionNode]) -> FunctionNode | None:
    """The node that a code object was compiled from: by its line; a lambda by the columns of its body."""
    if code.co_name != "<lambda>":
        for node in nodes:
            if not isinstance(node, ast.Lambda) and node.name == code.co_name:
                first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
                if first == code.co_firstlineno:
                    return node
        return None
    places = [
        ((line, column), (end_line, end_column))
        for line, end_line, column, end_column in code.co_positions()
        if line and end_line and column is not None and end_column is not None and end_column
    ]
    around = [
        node
        for node in nodes
        if isinstance(node, ast.Lambda) and all(_within(place, node.body) for place in places)
    ]
    return max(around, key=lambda node: (node.body.lineno, node.body.col_offset), default=None)


def _within(place: tuple[tuple[int, int], tuple[int, int]], node: ast.expr) -> bool:
    assert node.end_lineno is not None and node.end_col_offset is not None
    start, end = (node.lineno, node.col_offset), (node.end_lineno, node.end_col_offset)
    return start <= place[0] and place[1] <= end


def _instructions(code: CodeType) -> tuple[Any, ...]:
    """All that a code object does, without its docstring and its place in a file."""
    constants = code.co_consts
    if sys.version_info >= (3, 13):
        documented = bool(code.co_flags & HAS_DOCSTRING)
    else:
        documented = not code.co_name.startswith("<")
    if documented and constants and isinstance(constants[0], str | None):
        constants = constants[1:]
    return (
        code.co_name,
        code.co_code,
        code.co_names,
        code.co_varnames,
        code.co_freevars,
        code.co_cellvars,
        (code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount),
        tuple(
            _instructions(each) if isinstance(each, CodeType) else _constant(each)
            for each in constants
        ),
    )


def _constant(value: object) -> str:
    """A constant as text, sets in one order in every process."""
    if isinstance(value, tuple | frozenset):
        inside = [_constant(each) for each in value]
        return f"{type(value).__name__}{inside if isinstance(value, tuple) else sorted(inside)}"
    return repr(value)


def bytecode(code: CodeType) -> str:
    """All that a code object does as text, where its source is not known."""
    return repr(_instructions(code))


def _segment(text: str, node: ast.AST) -> str:
    """The text of a node, its decorators included, as it would stand at the margin."""
    if isinstance(node, ast.Lambda):
        return ast.get_source_segment(text, node) or ast.unparse(node)
    assert isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
    first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
    lines = text.splitlines(keepends=True)[first - 1 : node.end_lineno]
    return textwrap.dedent("".join(lines)).rstrip() + "\n"
