"""Who needs which runs of a store: studies by their folders, sweeps by their names."""

import re
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path

from filelock import FileLock

from granstudy.runs.store import Store
from granstudy.support.files import read_json, write_json

SWEEPS = "sweeps"
"""Folder in the store for the lists of sweeps' runs."""

UNNAMED = "unnamed"
"""Name of sweeps that have none."""


def write_root(results: str | Path, name: str | None, keys: Sequence[str]) -> None:
    """Note that a sweep needs some runs; further ones of the same name are added.

    Raises
    ------
    ValueError
        For a name that cannot be a file's.
    """
    if name is not None and not re.fullmatch(r"\w[\w.+-]*", name):
        raise ValueError(f"name={name!r}: must be letters, digits, and . + - _ between them")
    path = _list(results, name or UNNAMED)
    path.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(path.with_suffix(".lock")):
        before = read_json(path).get("runs", [])
        both = list(dict.fromkeys([*before, *keys]))
        if both != before:
            write_json(path, {"runs": both})


def forget_root(results: str | Path, root: str) -> None:
    """Forget that a study or a sweep needs runs; ``root`` as `roots` calls it.

    The names of a study's runs go too, so that no file keeps the runs themselves.
    """
    kind, _, name = root.partition(" ")
    if kind == "sweep":
        _list(results, name).unlink(missing_ok=True)
        return
    for manifest in _manifests(results):
        if _study(manifest) == name:
            shutil.rmtree(manifest.parent)


def _list(results: str | Path, name: str) -> Path:
    """File with the runs of a sweep."""
    return Store.beside(results).folder / SWEEPS / f"{name}.json"


def _manifests(results: str | Path) -> list[Path]:
    """Files with the runs of studies."""
    return sorted(Path(results).glob("*/runs/study.json"))


def _study(manifest: Path) -> str:
    return str(read_json(manifest).get("study", manifest.parent.parent.name))


def roots(results: str | Path) -> Iterator[tuple[str, set[str]]]:
    """Each study and sweep that has runs in the store, and the keys of those runs."""
    for manifest in _manifests(results):
        yield f"study {_study(manifest)}", _keys(read_json(manifest))
    for path in sorted((Store.beside(results).folder / SWEEPS).glob("*.json")):
        yield f"sweep {path.stem}", set(read_json(path).get("runs", []))


def _keys(manifest: dict[str, object]) -> set[str]:
    """Runs of a study, and those that its refined runs go through."""
    runs, rungs = manifest.get("runs", {}), manifest.get("rungs", [])
    found = set(runs.values()) if isinstance(runs, dict) else set()
    return found | set(rungs) if isinstance(rungs, list) else found
