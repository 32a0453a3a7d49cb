"""Functions as users write them: in cells of a notebook, in files, in imported modules."""

import importlib
import itertools
import linecache
import sys
import textwrap
from pathlib import Path
from typing import Any

_cells = itertools.count()


def in_notebook(source: str, namespace: dict[str, Any] | None = None) -> dict[str, Any]:
    """Run a cell as a notebook does: in one namespace, with its source kept under a made-up file name."""
    source = textwrap.dedent(source)
    name = f"/made_up/ipykernel_1/{next(_cells)}.py"
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    space = {"__name__": "__main__"} if namespace is None else namespace
    exec(compile(source, name, "exec"), space)
    return space


def in_file(folder: Path, source: str, name: str = "my_gas.py") -> Path:
    """Write a file."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(textwrap.dedent(source), encoding="utf-8")
    return path


def imported(path: Path, monkeypatch: Any) -> Any:
    """Import a file as a module of its own name."""
    monkeypatch.syspath_prepend(str(path.parent))
    monkeypatch.delitem(sys.modules, path.stem, raising=False)
    importlib.invalidate_caches()
    return importlib.import_module(path.stem)
