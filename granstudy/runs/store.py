"""The store: every run once, under its key, whoever asked for it."""

import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import xarray as xr
from filelock import FileLock

from granstudy.datasets.netcdf import read_dataset, read_head, write_dataset
from granstudy.support.files import TEMPORARY_PREFIX, remove_abandoned

FOLDER = ".runs"
"""Name of the store's folder beside the results of the studies that share it."""

CHECKPOINT = ".checkpoint"
"""Ending of the file that an unfinished run goes on from."""

FORGOTTEN = 30 * 86400.0
"""Age in seconds from which a checkpoint counts as forgotten: jobs wait for days to go on."""

SIDECAR = ".json"
"""Ending of the file beside a run's that says when and where it was computed."""


@dataclass(frozen=True)
class Store:
    """A folder of runs by their keys (`granstudy.runs.run_key.run_key`).

    A key says all that a run's numbers depend on. So a run that is there need never be computed again, for
    whichever study, sweep or notebook. Processes may write at the same time: a file appears whole or not at
    all, and `claim` keeps two of them from computing the same run. A long run that is computed has a
    checkpoint beside its place, from which it goes on after an interruption.

    Attributes
    ----------
    folder : Path
    """

    folder: Path

    @classmethod
    def beside(cls, results: str | Path) -> "Store":
        """The store that all studies with results in one folder share."""
        return cls(Path(results) / FOLDER)

    def path(self, key: str) -> Path:
        """File of the run of that key, there or not."""
        return self.folder / key[:2] / f"{key}.nc"

    def __contains__(self, key: str) -> bool:
        return self.path(key).is_file()

    def keys(self) -> set[str]:
        """Keys of all runs."""
        found: set[str] = set()
        for folder in self._shelves():
            with os.scandir(folder) as files:
                found.update(
                    f.name[:-3] for f in files if f.name.endswith(".nc") and f.name[0] != "."
                )
        return found

    def checkpoint(self, key: str) -> Path:
        """File that the unfinished run of that key goes on from, there or not."""
        return self.path(key).with_name(f".{key}{CHECKPOINT}")

    def unfinished(self) -> set[str]:
        """Keys of all runs that have a checkpoint."""
        return {_key_of(path) for path in self._checkpoints()}

    def _checkpoints(self) -> list[Path]:
        return [
            path
            for shelf in self._shelves()
            for path in shelf.glob(f".*{CHECKPOINT}")
            if not path.name.startswith(TEMPORARY_PREFIX)
        ]

    def _shelves(self) -> list[Path]:
        if not self.folder.is_dir():
            return []
        return [path for path in self.folder.iterdir() if len(path.name) == 2 and path.is_dir()]

    def read(self, key: str) -> xr.Dataset | None:
        """The run of that key, verified; None where there is none, or where it is damaged.

        A damaged file, or another run's under this name, is removed: the run is then computed anew.
        """
        path = self.path(key)
        try:
            ds = read_dataset(path)
        except FileNotFoundError:
            return None
        except (OSError, ValueError):
            self.remove(key)
            return None
        if ds.attrs.get("run_key") != key:
            self.remove(key)
            return None
        return ds

    def heal(self, keys: Iterable[str]) -> list[str]:
        """Remove the runs among these that are damaged, so that they are computed anew; their keys."""
        damaged = []
        for key in keys:
            path = self.path(key)
            try:
                right = not path.is_file() or read_head(path).attrs.get("run_key") == key
            except (OSError, ValueError):
                right = False
            if not right:
                self.remove(key)
                damaged.append(key)
        return damaged

    def write(self, key: str, ds: xr.Dataset, duration: float) -> None:
        """Keep a run under its key, whole or not at all; ``duration`` is its wall time in seconds.

        Its checkpoint goes.
        """
        write_dataset(ds.assign_attrs(run_key=key), self.path(key), duration=duration)
        with suppress(OSError):
            self.checkpoint(key).unlink()

    def size(self, key: str) -> int:
        """Bytes of a run and of its checkpoint."""
        files = [path for path in (self.path(key), self.checkpoint(key)) if path.is_file()]
        return sum(path.stat().st_size for path in files)

    def remove(self, key: str) -> None:
        """Forget a run."""
        path = self.path(key)
        for file in (path, sidecar(path), self.checkpoint(key)):
            file.unlink(missing_ok=True)

    @contextmanager
    def claim(self, key: str) -> Iterator[None]:
        """Let no other process compute the run of that key meanwhile; wait for one that does.

        The claim of a process that dies ends with it.
        """
        shelf = self.path(key).parent
        shelf.mkdir(parents=True, exist_ok=True)
        lock = FileLock(shelf / f".{key}.lock")
        with lock:
            yield
        with suppress(OSError):
            Path(lock.lock_file).unlink()

    def sweep(self, age: float, now: float) -> None:
        """Remove unfinished files of killed processes that are older than ``age`` seconds.

        Checkpoints stay until they are `FORGOTTEN`, unless their run is there.
        """
        for shelf in self._shelves():
            remove_abandoned(shelf, age, now)
        for path in self._checkpoints():
            with suppress(OSError):
                if _key_of(path) in self or now - path.stat().st_mtime > FORGOTTEN:
                    path.unlink()


def _key_of(checkpoint: Path) -> str:
    return checkpoint.name.removeprefix(".").removesuffix(CHECKPOINT)


def sidecar(path: Path) -> Path:
    """File beside a run's that says when and where it was computed."""
    return path.with_name(path.name + SIDECAR)


def link(source: Path, target: Path) -> None:
    """Give a run's file, and the file beside it, another name; a copy where the disk knows no links.

    A name that the run has already stays as it is.
    """
    if is_link(source, target):
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    for one, other in ((sidecar(source), sidecar(target)), (source, target)):
        if not one.is_file():
            continue
        other.unlink(missing_ok=True)
        try:
            os.link(one, other)
        except OSError:
            shutil.copy2(one, other)


def is_link(source: Path, target: Path) -> bool:
    """Whether ``target`` is another name, or a copy, of the run in ``source``."""
    try:
        a, b = os.stat(source), os.stat(target)
    except OSError:
        return False
    same = a.st_ino == b.st_ino and a.st_dev == b.st_dev
    return same or (a.st_size == b.st_size and a.st_mtime_ns == b.st_mtime_ns)
