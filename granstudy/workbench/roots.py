"""Who needs which runs of a store: studies by their folders, sweeps by their names."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

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
    path = Store.beside(results).folder / SWEEPS / f"{name or UNNAMED}.json"
    before = read_json(path).get("runs", [])
    both = list(dict.fromkeys([*before, *keys]))
    if both != before:
        write_json(path, {"runs": both})


def roots(results: str | Path) -> Iterator[tuple[str, set[str]]]:
    """Each study and sweep that has runs in the store, and the keys of those runs."""
    for manifest in sorted(Path(results).glob("*/runs/study.json")):
        content = read_json(manifest)
        yield f"study {content.get('study', manifest.parent.parent.name)}", _keys(content)
    for path in sorted((Store.beside(results).folder / SWEEPS).glob("*.json")):
        yield f"sweep {path.stem}", set(read_json(path).get("runs", []))


def _keys(manifest: dict[str, object]) -> set[str]:
    runs = manifest.get("runs", {})
    return set(runs.values()) if isinstance(runs, dict) else set()
