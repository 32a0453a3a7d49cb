"""Computed arrays kept on disk, under names that say everything they depend on."""

import io
import os
import time
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from platformdirs import user_cache_path

from granstudy.support.files import ABANDONED, remove_abandoned, sealed, unsealed, write_whole

VARIABLE = "GRANSTUDY_CACHE"
"""Environment variable that names another cache folder."""


def cache_folder() -> Path:
    """``$GRANSTUDY_CACHE``, or granstudy's folder in the platform's user cache (platformdirs).

    Raises
    ------
    OSError
        If the variable is not set, and the user has no home.
    """
    if named := os.environ.get(VARIABLE):
        return Path(named)
    try:
        folder = user_cache_path("granstudy", appauthor=False)
    except RuntimeError as error:
        raise OSError(str(error)) from error
    if not folder.is_absolute():  # as an earlier platformdirs answers: ~/.cache
        raise OSError(f"no home directory for {folder}")
    return folder


def cached_array(name: str, compute: Callable[[], np.ndarray]) -> np.ndarray:
    """The array kept under ``name``. If there is none, it is computed and kept.

    Concurrent runs are safe: a file appears whole or not at all, and two runs that compute the same array
    replace each other's file by an equal one. The checksum in a file covers name and array: a file that is
    damaged, or that holds the array of another name, counts as missing. Where the folder cannot be written
    to, a warning says so. Unfinished files of killed processes are removed after a day, when the next array
    is kept.
    """
    try:
        path = _path(name)
    except OSError as error:
        _say_not_kept(str(error))
        return compute()
    array = _read(path, name)
    if array is None:
        array = compute()
        try:
            write_whole(path, lambda partial: partial.write_bytes(_pack(array, name)))
            remove_abandoned(path.parent, ABANDONED, time.time())
        except OSError as error:
            _say_not_kept(f"{path.parent}: {error}")
    return array


def is_kept(name: str) -> bool:
    """Whether a file of that name is there; what it holds is not looked at."""
    try:
        return _path(name).is_file()
    except OSError:
        return False


def _path(name: str) -> Path:
    return cache_folder() / f"{name}.npy.sha256"


def _say_not_kept(reason: str) -> None:
    warnings.warn(
        f"cannot keep computed arrays ({reason}); they are computed again by every run. Set {VARIABLE} to a "
        "folder that can be written to",
        stacklevel=3,
    )


def _pack(array: np.ndarray, name: str) -> bytes:
    """NumPy's file format, which holds shape and type, sealed with the name."""
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    return sealed(buffer.getvalue(), name)


def _read(path: Path, name: str) -> np.ndarray | None:
    """The array in a file, or None if the file is missing, damaged or another array's."""
    try:
        payload = unsealed(path.read_bytes(), name)
    except OSError:
        return None
    return None if payload is None else np.load(io.BytesIO(payload), allow_pickle=False)
