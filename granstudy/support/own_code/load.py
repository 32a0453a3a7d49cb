"""Functions from the files of users, by a reference such as ``my_gas.py:anisotropic``."""

import hashlib
import importlib
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from granstudy.support.errors import nearest
from granstudy.support.own_code.code import code_of
from granstudy.support.own_code.installed import is_installed

FORM = "write it as file.py:function"
"""How a reference is written, for messages."""

_lock = threading.RLock()


@dataclass(frozen=True)
class OwnFunction:
    """A function from a file of the user. Other processes load it again, and verify that it is the same.

    Attributes
    ----------
    path : Path
        The file.
    name : str
        The function's name there.
    digest : str
        The function's content (`granstudy.support.own_code.code.code_of`).
    own_function : callable
        The function itself.
    """

    path: Path
    name: str
    digest: str
    own_function: Callable[..., Any] = field(compare=False)

    @property
    def reference(self) -> str:
        """The reference without the file's folder, ``my_gas.py:anisotropic``."""
        return f"{self.path.name}:{self.name}"

    @property
    def __wrapped__(self) -> Callable[..., Any]:
        """The function itself, for `inspect.signature`."""
        return self.own_function

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """Call the function."""
        return self.own_function(*args, **kwargs)

    def __repr__(self) -> str:
        return self.reference

    def __dask_tokenize__(self) -> tuple[str, str]:
        """What Dask knows the function by."""
        return self.name, self.digest

    def __reduce__(self) -> tuple[Callable[..., "OwnFunction"], tuple[str, str, str]]:
        return _load_same, (str(self.path), self.name, self.digest)


def is_reference(text: object) -> bool:
    """Whether a text refers to a function in a file."""
    return isinstance(text, str) and text.rpartition(":")[0].endswith(".py")


def load_function(reference: str, beside: str | Path) -> OwnFunction:
    """Load the function that ``my_gas.py:anisotropic`` refers to.

    While the file is loaded, modules beside it can be imported. Neither the file nor those modules stay
    importable, so that files of one name in two folders are two. A file that was edited is loaded anew.

    Parameters
    ----------
    reference : str
        Path of a Python file, a colon, the name of a function or class there.
    beside : str or Path
        Folder that a relative path starts from.

    Raises
    ------
    ValueError
        If there is no such file or function, if the file cannot be loaded, or if the function reaches a
        value that has no content to be known by; the message says which.
    """
    file, _, name = reference.rpartition(":")
    if not is_reference(reference) or not name.isidentifier():
        raise ValueError(f"{reference!r}: is no reference to a function; {FORM}")
    path = Path(beside, file).expanduser().resolve()
    if not path.is_file():
        others = sorted(each.name for each in path.parent.glob("*.py"))
        there = f"; there are {', '.join(others)}" if others else ""
        raise ValueError(f"{reference}: there is no file {path}{nearest(path.name, others)}{there}")
    module = _module(path, reference)
    known = [each for each, value in vars(module).items() if _is_own(each, value, module)]
    if not hasattr(module, name):
        there = f"it has {', '.join(known)}" if known else "it has no function"
        raise ValueError(f"{reference}: {path.name} has no {name!r}{nearest(name, known)}; {there}")
    function = getattr(module, name)
    if not callable(function):
        raise ValueError(
            f"{reference}: is {function!r}, not a function; {path.name} has {', '.join(known)}"
        )
    try:
        digest = code_of(function).digest
    except ValueError as error:
        raise ValueError(f"{reference}: {error}") from None
    return OwnFunction(path, name, digest, function)


def _load_same(path: str, name: str, digest: str) -> OwnFunction:
    """Load a function in another process; ValueError if the file gives another function by now."""
    found = load_function(f"{path}:{name}", "")
    if found.digest != digest:
        raise ValueError(
            f"{found.reference}: {path} was edited since the function was sent here; start again"
        )
    return found


def _is_own(name: str, value: Any, module: ModuleType) -> bool:
    """Whether a name of a module is a function or class that the module defines."""
    return (
        callable(value)
        and not name.startswith("_")
        and getattr(value, "__module__", module.__name__) == module.__name__
    )


class _Loaded(NamedTuple):
    """A loaded file, with the content that it and the modules beside it had."""

    module: ModuleType
    contents: dict[Path, str]


_loaded: dict[Path, _Loaded] = {}


def _module(path: Path, reference: str) -> ModuleType:
    """The module of a file, loaded where the file or a module beside it that it imports has changed."""
    with _lock:
        known = _loaded.get(path)
        if known is None or any(_digest(file) != own for file, own in known.contents.items()):
            _loaded[path] = _load(path, reference)
        return _loaded[path].module


def _digest(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else ""


def _load(path: Path, reference: str) -> _Loaded:
    content = path.read_bytes()
    # A name that no import gives: dataclasses look their module up while they are made.
    module = ModuleType(f"own_code_{hashlib.sha256(content).hexdigest()[:8]}_{path.stem}")
    module.__file__ = str(path)
    with _importable(path.parent) as imported:
        sys.modules[module.__name__] = module
        try:
            exec(compile(content, str(path), "exec", dont_inherit=True), vars(module))
        except (Exception, SystemExit) as error:
            raise ValueError(f"{reference}: {_place(error, path)}") from None
        finally:
            del sys.modules[module.__name__]
    contents = {file: _digest(file) for file in imported}
    return _Loaded(module, {path: hashlib.sha256(content).hexdigest(), **contents})


def _place(error: BaseException, path: Path) -> str:
    """File and line of an error in a user's file, and what it is."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}, line {error.lineno}: {error.msg}"
    own = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename).parent == path.parent
    ]
    line = f"{own[-1].filename}, line {own[-1].lineno}" if own else str(path)
    return f"{line}: {type(error).__name__}: {error}"


@contextmanager
def _importable(folder: Path) -> Iterator[list[Path]]:
    """Make modules in a folder importable for a while, whatever modules of their names were imported before.

    Yields
    ------
    list of Path
        At the end, the files in the folder that were imported.
    """
    names = {path.stem for path in folder.glob("*.py")}
    names |= {path.parent.name for path in folder.glob("*/*.py")}
    hidden = {
        name: module
        for name, module in list(sys.modules.items())
        if name.partition(".")[0] in names - {"__main__"} and not is_installed(module)
    }
    for name in hidden:
        del sys.modules[name]
    before, writes, imported = set(sys.modules), sys.dont_write_bytecode, list[Path]()
    sys.path.insert(0, str(folder))
    importlib.invalidate_caches()
    sys.dont_write_bytecode = True  # it could not tell two edits in one second apart
    try:
        yield imported
    finally:
        sys.dont_write_bytecode = writes
        sys.path.remove(str(folder))
        for name in set(sys.modules) - before:
            file = getattr(sys.modules[name], "__file__", None)
            if file is not None and Path(file).is_relative_to(folder):
                imported.append(Path(file))
                del sys.modules[name]
        sys.modules.update(hidden)
