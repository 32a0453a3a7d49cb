"""Machine code of compiled loops, kept on disk as long as the source that it was compiled from stays.

Numba's own cache follows the file of a function alone, while machine code also holds functions and constants
of other files. It numbers its files, so that two processes may write different code under one number. Here
the name of a file says all that its code was compiled from, and the file holds a checksum.
"""

import hashlib
import os
import pickle
import types
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba
import numpy as np
from numba.core.caching import FunctionCache
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.serialize import dumps

from granstudy.support.files import sealed, unsealed, write_whole

DIGITS = 16
"""Hexadecimal digits of each of the two hashes in a file's name."""

if hasattr(os, "register_at_fork"):  # not on Windows, which has no fork
    # A fork waits for a compilation of another thread: else the child finds the compiler locked for ever.
    os.register_at_fork(
        before=global_compiler_lock.acquire,
        after_in_parent=global_compiler_lock.release,
        after_in_child=global_compiler_lock.release,
    )

_said: list[str] = []
"""Why machine code cannot be kept, once it has been said."""


def compiled(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Decorator: compile a function with `numba.njit`, without Python's lock, and keep its machine code.

    Where no folder can be written to, a warning says so, and every process compiles.

    Parameters
    ----------
    options
        Options of `numba.njit`. A function that other compiled functions call needs ``forceinline=True``:
        otherwise a process calls whichever of several copies it loaded first, and copies that the compiler
        optimised differently round differently (under ``fastmath``).
    """

    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(nogil=True, **options)(function)
        try:
            dispatcher._cache = MachineCodeCache(dispatcher)
        except RuntimeError as error:  # numba finds no folder
            _say_not_kept(str(error))
        return dispatcher

    return decorate


class MachineCodeCache(FunctionCache):
    """Machine code of one function, a file for each signature and source.

    The folder is numba's: ``__pycache__`` beside the source, else the user's, or ``$NUMBA_CACHE_DIR``.
    """

    def __init__(self, dispatcher: Dispatcher) -> None:
        super().__init__(dispatcher.py_func)
        self._cache_file = _Files(dispatcher, Path(self._cache_path), self._impl.filename_base)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the machine code of a signature, or warn that it cannot be kept."""
        try:
            super().save_overload(sig, data)
        except OSError as error:
            _say_not_kept(str(error))


def _say_not_kept(reason: str) -> None:
    """Warn, once a process."""
    if _said:
        return
    _said.append(reason)
    warnings.warn(
        f"cannot keep machine code ({reason}); every process compiles it anew. Set NUMBA_CACHE_DIR to a "
        "folder that can be written to",
        stacklevel=2,
    )


class _Files:
    """The files of one function, as numba's cache asks for them."""

    def __init__(self, dispatcher: Dispatcher, folder: Path, name: str) -> None:
        self._dispatcher, self._folder, self._name = dispatcher, folder, name

    def load(self, key: Any) -> Any:
        """What was saved under ``key``; None if the file is missing, damaged or of another source."""
        try:
            payload = unsealed(self._path(key).read_bytes(), self._seal(key))
        except OSError:
            return None
        return None if payload is None else pickle.loads(payload)

    def save(self, key: Any, data: Any) -> None:
        """Keep ``data``, and remove what was kept of earlier sources."""
        path = self._path(key)
        write_whole(path, lambda partial: partial.write_bytes(sealed(dumps(data), self._seal(key))))
        for other in self._kept():
            if not other.name.startswith(f"{self._name}.{self._stamp()}."):
                other.unlink(missing_ok=True)

    def flush(self) -> None:
        """Remove everything that was kept."""
        for path in self._kept():
            path.unlink(missing_ok=True)

    def _kept(self) -> list[Path]:
        """Files of the function, on whatever line it stood; for this version of Python."""
        function, _, rest = self._name.rpartition("-")
        return list(self._folder.glob(f"{function}-*.{rest.partition('.')[2]}.*.nbc"))

    def _stamp(self) -> str:
        return source_hash(self._dispatcher)[:DIGITS]

    def _seal(self, key: Any) -> str:
        return f"{numba.__version__} {source_hash(self._dispatcher)} {key!r}"

    def _path(self, key: Any) -> Path:
        named = hashlib.sha256(self._seal(key).encode()).hexdigest()[:DIGITS]
        return self._folder / f"{self._name}.{self._stamp()}.{named}.nbc"


def source_hash(dispatcher: Dispatcher) -> str:
    """Hash over all that the machine code of a compiled function is made from.

    These are the bytecode and constants of the function, its options, the values of the global names in it,
    and the same of the compiled functions that it calls, in whatever file they stand.
    """
    waiting, found = [dispatcher], {dispatcher}
    digest = hashlib.sha256()
    while waiting:
        for part in _parts(waiting.pop()):
            if isinstance(part, Dispatcher) and part not in found:
                found.add(part)
                waiting.append(part)
            digest.update(f"{_text(part)}\n".encode())
    return digest.hexdigest()


def _parts(dispatcher: Dispatcher) -> Iterator[Any]:
    """Options, code and global values of a compiled function."""
    function = dispatcher.py_func
    yield from sorted((name, _text(value)) for name, value in dispatcher.targetoptions.items())
    codes = [function.__code__]
    for code in codes:  # grows while it is read
        yield code.co_code.hex()
        for constant in code.co_consts:
            if isinstance(constant, types.CodeType):
                codes.append(constant)
            elif constant != function.__doc__:
                yield constant
        for name in code.co_names:
            if name in function.__globals__:
                value = function.__globals__[name]
                yield name
                yield value
                if isinstance(value, types.ModuleType) and value.__name__.startswith("granstudy"):
                    yield from (vars(value)[one] for one in code.co_names if one in vars(value))


def _text(value: Any) -> str:
    """A value as text that is the same in every process."""
    match value:
        case Dispatcher():
            return _text(value.py_func)
        case types.ModuleType():
            return value.__name__
        case types.FunctionType():
            return f"{value.__module__}.{value.__qualname__}"
        case set() | frozenset():
            return repr(sorted(map(_text, value)))
        case np.ndarray():
            return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    return repr(value)
