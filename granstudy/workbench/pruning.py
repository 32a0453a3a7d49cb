"""Runs of a store, whole or unfinished, that no study and no sweep has."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from granstudy.runs.store import Store
from granstudy.workbench.roots import forget_root, roots


@dataclass(frozen=True)
class Unused:
    """Runs that no study and no sweep has; one that was interrupted counts by its checkpoint.

    Attributes
    ----------
    keys : list of str
    bytes : int
        What their files take.
    kept : dict of int
        Runs of each study and sweep.
    """

    keys: list[str]
    bytes: int
    kept: dict[str, int]


def unused(results: str | Path, given_up: Sequence[str] = ()) -> Unused:
    """Find runs that no study and no sweep has.

    Parameters
    ----------
    results : str or Path
        Folder of results.
    given_up : sequence of str
        Studies and sweeps that do not count any more, as ``study name`` or ``sweep name``.

    Raises
    ------
    ValueError
        If there is no such study or sweep.
    """
    store, found = Store.beside(results), dict(roots(results))
    for name in given_up:
        if name not in found:
            there = f"there are {', '.join(found)}" if found else "there are none"
            raise ValueError(f"{name!r}: no such study or sweep; {there}")
    kept = {name: keys for name, keys in found.items() if name not in given_up}
    in_store = store.keys()
    keys = sorted((in_store | store.unfinished()) - set().union(*kept.values()))
    size = sum(map(store.size, keys))
    return Unused(keys, size, {name: len(own & in_store) for name, own in kept.items()})


def remove(results: str | Path, keys: Sequence[str], given_up: Sequence[str] = ()) -> None:
    """Remove runs from the store, and forget the studies and sweeps that were given up."""
    store = Store.beside(results)
    for name in given_up:
        forget_root(results, name)
    for key in keys:
        store.remove(key)
