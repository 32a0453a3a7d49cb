"""Mutations of Python source: one small change each, of the kind that a slip of the pen makes.

Only what computes is changed: no docstrings, errors, annotations, f-strings or tables of data.
Every change keeps the number of lines, so that a mutant fails where it was changed.
"""

import ast
import hashlib
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

BINARY = {
    ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "/"), ast.Mod: ("%", "//"), ast.Pow: ("**", "*"),
    ast.BitAnd: ("&", "|"), ast.BitOr: ("|", "&"),
}  # fmt: skip
"""Operators and what stands for them in a mutant; also with ``=``."""

COMPARED = {
    ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"), ast.In: ("in", "not in"), ast.NotIn: ("not in", "in"),
}  # fmt: skip

NAMES = {
    "cos": "sin", "sin": "cos", "min": "max", "max": "min", "minimum": "maximum",
    "maximum": "minimum", "floor": "ceil", "ceil": "floor", "any": "all", "all": "any",
    "argmin": "argmax", "argmax": "argmin", "sqrt": "square", "square": "sqrt", "real": "imag",
    "fftn": "ifftn", "ifftn": "fftn",
}  # fmt: skip
"""Functions and attributes, and what stands for them in a mutant."""


LONG_TABLE = 8
"""Constants that a tuple, list or dictionary may have; the entries of longer ones are data."""


@dataclass(frozen=True)
class Mutation:
    """One change of one file.

    Attributes
    ----------
    module : str
        Path of the file in the repository.
    function : str
        Innermost function or class around the change; empty at the top of the file.
    line : int
    change : str
        The line's text and what stands for a part of it, e.g. ``k[+ -> -]1``.
    start, end : int
        Characters of the file that are replaced.
    new : str
        What they are replaced by.
    compiled : bool
        Whether Numba compiles the function around the change.
    """

    module: str
    function: str
    line: int
    change: str
    start: int
    end: int
    new: str
    compiled: bool

    def apply(self, source: str) -> str:
        """The file's text with the change made."""
        return source[: self.start] + self.new + source[self.end :]

    @property
    def key(self) -> tuple[str, str, str]:
        """What finds the mutation again after lines have moved."""
        return self.module, self.function, self.change


def sample(files: list[Path], root: Path, count: int, seed: int) -> list[Mutation]:
    """Choose ``count`` mutations of the files, by a hash over their text and the seed, in order of lines.

    A change of one function leaves the choice in others nearly as it was.
    """

    def rank(mutation: Mutation) -> str:
        return hashlib.sha256(f"{seed} {mutation.key}".encode()).hexdigest()

    every = [one for file in files for one in mutations(file, root)]
    return sorted(sorted(every, key=rank)[:count], key=lambda one: (one.module, one.start))


def mutations(file: Path, root: Path) -> list[Mutation]:
    """All mutations of a file; two of the same text in one function are told apart by a number."""
    source = file.read_text(encoding="utf-8")
    lines = source.splitlines(keepends=True)
    starts = [0]
    for text in lines:
        starts.append(starts[-1] + len(text))

    def place(line: int, column: int) -> int:  # ast counts bytes
        return starts[line - 1] + len(lines[line - 1].encode()[:column].decode())

    found, seen = [], Counter[tuple[str, str]]()
    for node, owner, compiled in _computing(ast.parse(source)):
        for first, last, old, new in _changes(node):
            start, end = place(*first), place(*last)
            here = (
                re.search(old, source[start:end]) if old else re.match(r"(?s).*", source[start:end])
            )
            if here is None:
                continue
            start, end = start + here.start(), start + here.end()
            line = source.count("\n", 0, start) + 1
            before, after = source[starts[line - 1] : start], source[end:].partition("\n")[0]
            change = f"{before}[{' '.join(source[start:end].split())} -> {new}]{after}".strip()
            seen[owner, change] += 1
            if seen[owner, change] > 1:
                change += f" #{seen[owner, change]}"
            module = str(file.relative_to(root))
            found.append(Mutation(module, owner, line, change, start, end, new, compiled))
    return found


def _is_aside(node: ast.AST) -> bool:
    """Whether a node is text, a long table of numbers, or a script's start."""
    match node:
        case ast.JoinedStr() | ast.Raise() | ast.Expr(ast.Call(ast.Name("print"))):
            return True
        case ast.Dict(values=entries) | ast.Tuple(entries) | ast.List(entries):
            return len(entries) > LONG_TABLE and all(
                isinstance(one, ast.Constant) for one in entries
            )
        case ast.If(ast.Compare(ast.Name("__name__"))):
            return True
    return False


def _computing(
    tree: ast.AST, owner: str = "", compiled: bool = False
) -> Iterator[tuple[ast.AST, str, bool]]:
    """Nodes that compute something, with the function around them and whether it is compiled."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list", "type_comment"):
            continue
        for node in value if isinstance(value, list) else [value]:
            if not isinstance(node, ast.AST) or _is_aside(node):
                continue
            inner, machine = owner, compiled
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                inner = f"{owner}.{node.name}".strip(".")
                machine = compiled or any(
                    re.match(r"compiled\b|_compile|_inline", ast.unparse(one))
                    for one in node.decorator_list
                )
            yield node, inner, machine
            yield from _computing(node, inner, machine)


Change = tuple[tuple[int, int], tuple[int, int], str, str]
"""From where to where a text changes (line, byte), the pattern to replace there, and the replacement."""


def _changes(node: ast.AST) -> Iterator[Change]:
    """Changes of one node; an empty pattern stands for the whole of its text."""
    match node:
        case ast.Constant(bool() as value):
            yield _start(node), _end(node), "", str(not value)
        case ast.Constant(int() as value):
            yield _start(node), _end(node), "", str(value + 1)
        case ast.Constant(float() | complex() as value):
            yield _start(node), _end(node), "", repr(1.25 * value if value else 0.25)
        case ast.Name(name) | ast.Attribute(attr=name) if name in NAMES:
            yield _start(node), _end(node), rf"\b{name}$", NAMES[name]
        case ast.Assign([ast.Subscript()]) | ast.Expr(ast.Call()):
            if node.lineno == node.end_lineno:
                yield _start(node), _end(node), "", "pass"
        case ast.Break():
            yield _start(node), _end(node), "", "continue"
        case ast.Continue():
            yield _start(node), _end(node), "", "break"
        case _:
            yield from _changed_operators(node)


def _changed_operators(node: ast.AST) -> Iterator[Change]:
    """Changes of the operators of one node."""
    match node:
        case ast.BinOp(left, op, right) if type(op) in BINARY:
            old, new = BINARY[type(op)]
            yield _end(left), _start(right), re.escape(old), new
        case ast.AugAssign(target, op, value) if type(op) in BINARY:
            old, new = BINARY[type(op)]
            yield _end(target), _start(value), re.escape(old), new
        case ast.Compare(left, ops, comparators):
            for one, compared, other in zip([left, *comparators], ops, comparators, strict=False):
                old, new = COMPARED[type(compared)]
                yield _end(one), _start(other), re.escape(old), new
        case ast.BoolOp(op, values):
            old, new = ("and", "or") if isinstance(op, ast.And) else ("or", "and")
            for one, other in pairwise(values):
                yield _end(one), _start(other), rf"\b{old}\b", new
        case ast.UnaryOp(ast.USub() | ast.Not(), operand):
            yield _start(node), _start(operand), "-|not ", ""


def _start(node: ast.expr | ast.stmt) -> tuple[int, int]:
    return node.lineno, node.col_offset


def _end(node: ast.expr | ast.stmt) -> tuple[int, int]:
    assert node.end_lineno is not None and node.end_col_offset is not None
    return node.end_lineno, node.end_col_offset
