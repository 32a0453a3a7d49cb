"""Fingerprint of the code that a run depends on.

Snakemake does not see edits in an imported package. So each run has a fingerprint among the parameters of
its rule: a hash over the syntax trees, without docstrings, of all modules that the run imports. An edit of
the solver then reruns exactly the runs that it affects. Comments, docstrings and plotting rerun nothing.
"""

import ast
import hashlib
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import NamedTuple

PACKAGE = Path(__file__).parents[1]
"""Folder of the package whose modules are hashed."""

FORK_NAME = "FORK"
"""Name of the constant that marks a module as a fork.

A fork only chooses between other modules, or lists what can be chosen. No fingerprint follows or hashes a
fork: whoever asks for a fingerprint names the branch that is taken. So a new method, a row in a fork, changes
no run."""


def fingerprint(modules: Iterable[str]) -> str:
    """Hash over the syntax trees of ``modules`` and of all that they import of the package.

    Parameters
    ----------
    modules : iterable of str
        Dotted names.

    Returns
    -------
    str
        16 hexadecimal digits.
    """
    return _fingerprint(frozenset(modules))


@cache
def _fingerprint(modules: frozenset[str]) -> str:
    """`fingerprint`, once a process: thousands of runs depend on the same few sets of modules."""
    found: set[str] = set()
    waiting = list(modules)
    while waiting:
        module = waiting.pop()
        if module not in found and not is_fork(module):
            found.add(module)
            waiting.extend(imported_modules(module))
    digest = hashlib.sha256()
    for module in sorted(found):
        digest.update(f"{module}\n{_code(module).tree}\n".encode())
        for file in _data(module):
            digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()[:16]


def imported_modules(module: str) -> tuple[str, ...]:
    """Modules of the package that ``module`` itself imports, by dotted name."""
    return _code(module).imports


def is_fork(module: str) -> bool:
    """Whether a module is marked as a fork, by `FORK_NAME`."""
    return _code(module).is_fork


class _Code(NamedTuple):
    """What a fingerprint needs to know of a module.

    Attributes
    ----------
    imports : tuple of str
        Modules of the package that it imports.
    is_fork : bool
    tree : str
        Its syntax tree as text, without docstrings, also without texts below constants.
    """

    imports: tuple[str, ...]
    is_fork: bool
    tree: str


@cache
def _code(module: str) -> _Code:
    """The code of a module, parsed once a process."""
    tree = ast.parse(_source(module).read_text())
    imports, fork = tuple(_imports(tree)), any(map(_marks_fork, tree.body))
    return _Code(imports, fork, ast.dump(without_texts(tree)))


def _imports(tree: ast.Module) -> list[str]:
    """Modules of the package that a syntax tree imports, each once."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("granstudy"):
            for name in node.names:
                inner = f"{node.module}.{name.name}"
                found.append(inner if _exists(inner) else str(node.module))
        elif isinstance(node, ast.Import):
            found.extend(a.name for a in node.names if a.name.startswith("granstudy"))
    # `from granstudy import x` must not drag in the whole public API of the package.
    return [name for name in dict.fromkeys(found) if name != "granstudy"]


def without_texts(tree: ast.AST) -> ast.AST:
    """The tree, changed in place, without docstrings, also without texts below constants."""
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            node.body = [part for part in node.body if not _is_text(part)]
    return tree


def _marks_fork(node: ast.stmt) -> bool:
    """Whether a statement sets `FORK_NAME`."""
    return isinstance(node, ast.Assign) and FORK_NAME in [
        getattr(name, "id", "") for name in node.targets
    ]


def _is_text(node: ast.stmt) -> bool:
    """Whether a statement is a string and nothing else."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _data(module: str) -> list[Path]:
    """Data files that count as a module's code: the folder ``data`` beside a module called ``.._data``."""
    folder = _source(module).parent / "data"
    return sorted(folder.iterdir()) if module.endswith("_data") and folder.is_dir() else []


def _source(module: str) -> Path:
    """File of a module; of a package, its ``__init__.py``."""
    path = PACKAGE.joinpath(*module.split(".")[1:])
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def _exists(module: str) -> bool:
    return _source(module).is_file()
