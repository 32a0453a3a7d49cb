"""Computed arrays kept on disk, under names that say everything they depend on."""

import hashlib
import io
import os
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
from platformdirs import user_cache_path

from granstudy.support.files import TEMPORARY_PREFIX, write_whole

VARIABLE = "GRANSTUDY_CACHE"
"""Environment variable that names another cache folder."""

DIGEST_BYTES = hashlib.sha256().digest_size
"""Bytes of the checksum at the head of a file."""

ABANDONED = 86400.0
"""Age in seconds from which an unfinished file counts as abandoned. Writing one takes seconds."""


def cache_folder() -> Path:
    """``$GRANSTUDY_CACHE``, or granstudy's folder in the platform's user cache (platformdirs)."""
    named = os.environ.get(VARIABLE)
    return Path(named) if named else user_cache_path("granstudy", appauthor=False)


def cached_array(name: str, compute: Callable[[], np.ndarray]) -> np.ndarray:
    """The array kept under ``name``. If there is none, it is computed and kept.

    Concurrent runs are safe: a file appears whole or not at all, and two runs that compute the same array
    replace each other's file by an equal one. An array whose file does not match its checksum is computed
    anew. Where the folder cannot be written to, a warning says so. Unfinished files of killed processes are
    removed after a day, when the next array is kept.
    """
    path = cache_folder() / f"{name}.npy.sha256"
    array = _read(path)
    if array is None:
        array = compute()
        try:
            write_whole(path, lambda partial: partial.write_bytes(_pack(array)))
            _remove_abandoned(path.parent)
        except OSError as error:
            warnings.warn(
                f"{path.parent}: cannot keep computed arrays there ({error}); they are computed "
                f"again by every run. Set {VARIABLE} to a folder that can be written to",
                stacklevel=2,
            )
    return array


def _remove_abandoned(folder: Path) -> None:
    """Remove unfinished files of the age `ABANDONED`. Other processes may remove the same files."""
    for partial in folder.glob(f"{TEMPORARY_PREFIX}*"):
        with suppress(OSError):
            if time.time() - partial.stat().st_mtime > ABANDONED:
                partial.unlink()


def _pack(array: np.ndarray) -> bytes:
    """SHA-256 of NumPy's file format, then that format."""
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    payload = buffer.getvalue()
    return hashlib.sha256(payload).digest() + payload


def _read(path: Path) -> np.ndarray | None:
    """The array in a file, or None if the file is missing or damaged."""
    try:
        content = path.read_bytes()
    except OSError:
        return None
    digest, payload = content[:DIGEST_BYTES], content[DIGEST_BYTES:]
    if hashlib.sha256(payload).digest() != digest:
        return None
    return np.load(io.BytesIO(payload), allow_pickle=False)
