"""The house: which room stands on which floor, and which file imports which.

The order of the floors is written here and nowhere else. `tests/test_architecture.py` holds the package
to it, and `docs/draw_rooms.py` draws it.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

HOUSE = Path(__file__).parents[1] / "granstudy"

FLOORS = (
    ("commands",),
    ("workbench",),
    ("accessor",),
    ("analysis",),
    ("study",),
    ("runs",),
    ("accuracy",),
    ("states", "reading"),
    ("evolution",),
    ("particles",),
    ("datasets",),
    ("trust",),
    ("collision", "theory"),
    ("model", "quadrature"),
    ("velocity",),
    ("support",),
)
"""Rooms, from the top floor to the cellar. A file imports from its own room and from lower floors only:
rooms on one floor do not know each other."""

APART = {("trust", "collision"): "trust judges what any method computed, so it knows none"}
"""Rooms of which the first does not import the second, although it stands above it, and why."""

FORKS = {
    "granstudy.model.methods": "says what each method takes",
    "granstudy.collision.choice.methods": "names what makes the operator of each method",
    "granstudy.collision.operator": "chooses the method where it is open",
    "granstudy.evolution.simulate": "takes the grid or the particles",
}
"""Modules that may define `FORK`, and why. A fork only chooses: no run's key depends on its code
(`granstudy.support.fingerprint`), so that nothing that a number depends on may stand in one."""

MODULE = r"granstudy(\.\w+)+(:\w+)?"
"""How a string spells a module, or a name in one."""


@dataclass(frozen=True, order=True)
class Import:
    """One file names another.

    ``how`` is ``open``, ``lazy`` (in a function), ``type-only`` or ``by string``.
    """

    importer: str
    imported: str
    how: str

    def __str__(self) -> str:
        return f"{self.importer} -> {self.imported} ({self.how})"


def modules(house: Path) -> dict[str, Path]:
    """Every module's dotted name and file; a package's name stands for its ``__init__.py``.

    Files in a folder without one are no modules: scripts of the workflow, templates.
    """
    found = {}
    for path in sorted(house.rglob("*.py")):
        if not (path.parent / "__init__.py").is_file():
            continue
        parts = path.relative_to(house.parent).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imports(house: Path) -> list[Import]:
    """All imports between the house's own files, each pair and manner once.

    Importing a module also runs the ``__init__.py`` above it; only an import that names the package counts.
    """
    files = modules(house)
    return sorted(
        Import(importer, imported, how)
        for importer, path in files.items()
        for imported, how in {(_module(name, files), how) for name, how in _names(path)}
        if imported is not None and imported != importer
    )


def _module(name: str, files: dict[str, Path]) -> str | None:
    """The module that defines a dotted name, None if it is not the house's."""
    while name and name not in files:
        name = name.rpartition(".")[0]
    return name or None


def _names(path: Path) -> Iterator[tuple[str, str]]:
    """Dotted names that a file imports or spells in a string that is no docstring, and how."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    docstrings = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    texts = {node for node in ast.walk(tree) if isinstance(node, ast.Constant)} - docstrings
    spelled = {str(text.value) for text in texts if re.fullmatch(MODULE, str(text.value))}
    yield from ((name.replace(":", "."), "by string") for name in spelled)
    lazy, type_only = set[ast.AST](), set[ast.AST]()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            lazy.update(ast.walk(node))
        elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            type_only.update(ast.walk(node))
    for node in ast.walk(tree):
        how = "type-only" if node in type_only else "lazy" if node in lazy else "open"
        if isinstance(node, ast.Import):
            yield from ((alias.name, how) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((f"{node.module}.{alias.name}", how) for alias in node.names)


def purpose(house: Path, name: str) -> str:
    """What a room is for: the first line of its ``__init__.py``."""
    text = ast.get_docstring(ast.parse((house / name / "__init__.py").read_text(encoding="utf-8")))
    return (text or "").partition("\n")[0]


def entries(folder: Path) -> list[str]:
    """Files and folders in a room; its ``__init__.py`` does not count."""
    names = sorted(path.name for path in folder.iterdir())
    return [name for name in names if not name.startswith(("__", "."))]


def room(module: str) -> str:
    """The room that a module stands in; ``granstudy`` for the package's own ``__init__.py``."""
    return (module.split(".")[1:] or ["granstudy"])[0]


def floor(name: str) -> int:
    """The floor of a room, 1 the cellar; ``granstudy`` itself is the roof."""
    floors = {one: number for number, rooms in enumerate(FLOORS[::-1], 1) for one in rooms}
    return floors.get(name, len(FLOORS) + 1)


def circles(found: Iterable[Import]) -> list[str]:
    """Files that import each other in a circle, as ``a -> b -> a``; at least one circle of each knot."""
    graph: dict[str, set[str]] = {}
    for one in found:
        graph.setdefault(one.importer, set()).add(one.imported)
    broken = []
    while True:
        try:
            TopologicalSorter(graph).prepare()
            return broken
        except CycleError as error:
            circle = error.args[1][::-1]  # the sorter names the imported file first
            broken.append(" -> ".join(circle))
            graph[circle[0]].discard(circle[1])
