"""Checkpoints: the file from which a run that was interrupted goes on.

=====================  ==============================================================
first line             the format and its version
8 bytes, then as many  identity of the run, and its state without arrays, as JSON
arrays                 one after the other, as NumPy writes them
last 32 bytes          SHA-256 of all before
=====================  ==============================================================

A state is plain data: mappings, lists, numbers, texts, None, and arrays. Every number comes back in its type
and with its bits, every array in its layout of memory, on which the order of sums depends.
"""

import hashlib
import json
import logging
import math
import os
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from granstudy.support.files import DIGEST_BYTES, write_whole

KIND = b"granstudy checkpoint"
"""Start of every checkpoint, of whichever version."""

HEAD = KIND + b" 1\n"
"""The first line."""

VARIABLE = "GRANSTUDY_CHECKPOINT_SECONDS"
"""Environment variable that sets another `SECONDS`."""

SECONDS = 60.0
"""Seconds of computing between two checkpoints, and before the first."""

SHARE = 0.01
"""Part of the time that checkpoints take at most: where writing one takes long, they are fewer."""

CHUNK = 1 << 20
"""Bytes read at once for the checksum."""

SHOWN = 5
"""Differences that the error for a checkpoint of another run names."""

log = logging.getLogger(__name__)


class CheckpointError(ValueError):
    """A file is no checkpoint, or that of another run."""


class Checkpoint:
    """The checkpoint of one run, and when the next is due.

    Processes that make the same run may share the file: it appears whole or not at all, and each can go on
    from the other's.

    Parameters
    ----------
    path : str or Path
        The file, there or not.
    identity : mapping
        All that the numbers of the run depend on, code included, as plain data with keys of text.

    Raises
    ------
    ValueError
        If `VARIABLE` is set to something else than a number of at least 0.
    """

    def __init__(self, path: str | Path, identity: Mapping[str, Any]) -> None:
        self.path = Path(path)
        self._identity = json.loads(json.dumps(identity))
        self._every = seconds_between()
        self._due_at = time.monotonic() + self._every

    def read(self) -> Any:
        """The state of the run; None where there is none yet, or where the file is damaged.

        A damaged file is removed, which the log says.

        Raises
        ------
        CheckpointError
            If the file is no checkpoint, or that of another run; the message says what differs.
        """
        try:
            with open(self.path, "rb") as file:
                state = self._state(file)
        except FileNotFoundError:
            return None
        except _DamagedError:
            log.warning("%s: this checkpoint is damaged: the run starts anew", self.path)
            self.remove()
            return None
        log.info("goes on from %s", self.path)
        return state

    def due(self) -> bool:
        """Whether the state should be written now."""
        return time.monotonic() >= self._due_at

    def write(self, state: Any) -> None:
        """Write the state. Where the disk does not take it, the log says so and the run goes on."""
        start = time.monotonic()
        try:
            write_whole(self.path, lambda partial: self._write(partial, state))
        except OSError as error:
            log.warning("%s: cannot write a checkpoint: %s", self.path, error)
        now = time.monotonic()
        # Every step, where that is asked for; else seldom enough.
        self._due_at = now + (max(self._every, (now - start) / SHARE) if self._every else 0.0)

    def remove(self) -> None:
        """Remove the file."""
        self.path.unlink(missing_ok=True)

    def _write(self, path: Path, state: Any) -> None:
        arrays: list[np.ndarray] = []
        content = {"identity": self._identity, "state": _packed(state, arrays)}
        text = json.dumps(content).encode()
        with open(path, "wb") as raw:
            file = _Hashed(raw)
            file.write(HEAD + len(text).to_bytes(8, "big") + text)
            for array in arrays:
                np.lib.format.write_array(file, array, allow_pickle=False)
            raw.write(file.digest.digest())

    def _state(self, file: BinaryIO) -> Any:
        start = file.read(len(HEAD))
        if start and not start.startswith(KIND):
            raise CheckpointError(
                f"checkpoint={str(self.path)!r}: is a file of another kind; name another file"
            )
        if start != HEAD or not _sound(file):
            raise _DamagedError
        file.seek(len(HEAD))
        content = json.loads(file.read(int.from_bytes(file.read(8), "big")))
        if differing := list(differences(content["identity"], self._identity)):
            more = len(differing) - SHOWN
            shown = "; ".join(differing[:SHOWN]) + (f"; and {more} more" if more > 0 else "")
            raise CheckpointError(
                f"checkpoint={str(self.path)!r}: is of another run: {shown}. Name another file, or delete "
                "this one"
            )
        return _unpacked(content["state"], _arrays(file))


class _DamagedError(Exception):
    """A file was written as a checkpoint, and is not as it was written."""


class _Hashed:
    """A file that is written, and the checksum of what went into it."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.digest = hashlib.sha256()

    def write(self, data: bytes) -> int:
        self.digest.update(data)
        return self._file.write(data)


def seconds_between() -> float:
    """Seconds of computing between two checkpoints: `SECONDS`, or what `VARIABLE` says.

    Raises
    ------
    ValueError
        If it says something else than a number of at least 0.
    """
    text = os.environ.get(VARIABLE)
    if not text:
        return SECONDS
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not value >= 0.0:
        raise ValueError(
            f"{VARIABLE}={text!r}: must be seconds of at least 0; 0 writes after every step, inf never"
        )
    return value


def differences(there: Any, here: Any, name: str = "") -> Iterator[str]:
    """What differs between two pieces of plain data, one text a value."""
    if isinstance(there, dict) and isinstance(here, dict):
        for key in dict.fromkeys([*here, *there]):
            inner = f"{name}.{key}" if name else key
            yield from differences(there.get(key), here.get(key), inner)
    elif there != here:
        yield f"{name} is {there!r} in the file and {here!r} here"


def _sound(file: BinaryIO) -> bool:
    """Whether a file ends with the checksum of all before."""
    left = file.seek(0, os.SEEK_END) - DIGEST_BYTES
    file.seek(0)
    digest = hashlib.sha256()
    while left > 0:
        data = file.read(min(CHUNK, left))
        digest.update(data)
        left -= len(data)
    return digest.digest() == file.read()


def _packed(value: Any, arrays: list[np.ndarray]) -> Any:
    """A state as JSON holds it; its arrays, each dense with the longest stride first, go to a list."""
    if isinstance(value, np.ndarray | np.generic):
        array = np.asarray(value)
        order = sorted(range(array.ndim), key=lambda axis: -abs(array.strides[axis]))
        arrays.append(np.ascontiguousarray(array.transpose(order)))
        scalar = isinstance(value, np.generic)
        return {"shape": array.shape, "order": order, "scalar": scalar}
    if isinstance(value, Mapping):
        return {"map": {key: _packed(each, arrays) for key, each in value.items()}}
    if isinstance(value, list | tuple):
        return [_packed(each, arrays) for each in value]
    return value


def _unpacked(packed: Any, following: Callable[[], np.ndarray]) -> Any:
    """A state from JSON and the arrays that follow, in the order of `_packed`; tuples are lists now."""
    if isinstance(packed, list):
        return [_unpacked(each, following) for each in packed]
    if not isinstance(packed, dict):
        return packed
    if "map" in packed:
        return {key: _unpacked(each, following) for key, each in packed["map"].items()}
    array = following()
    if packed["scalar"]:
        return array.reshape(())[()]
    order = packed["order"]
    dense = array.reshape([packed["shape"][axis] for axis in order])
    return dense.transpose(np.argsort(order)) if order else dense


def _arrays(file: BinaryIO) -> Callable[[], np.ndarray]:
    """Function that reads the next array of a file."""

    def following() -> np.ndarray:
        array: np.ndarray = np.lib.format.read_array(file, allow_pickle=False)
        return array

    return following
