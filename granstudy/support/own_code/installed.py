"""What belongs to Python or to an installed package, and so is known by its name."""

import site
import sys
import sysconfig
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import FunctionType, ModuleType

OWN_PACKAGE = __name__.partition(".")[0]
"""granstudy, whose code has fingerprints of its own (`granstudy.support.fingerprint`)."""


def is_installed(value: object) -> bool:
    """Whether a function, class, module or other object was defined by Python or an installed package."""
    if isinstance(value, ModuleType):
        return _module_is_installed(value.__name__, getattr(value, "__file__", None))
    if isinstance(value, FunctionType):
        known = value.__globals__
        return _module_is_installed(str(value.__module__), known.get("__file__"))
    name = getattr(value, "__module__", None)
    module = sys.modules.get(str(name))
    return module is not None and _module_is_installed(str(name), getattr(module, "__file__", None))


def _module_is_installed(name: str, file: str | None) -> bool:
    top = name.partition(".")[0]
    if top in (OWN_PACKAGE, "__main__"):  # whatever program runs the user's code
        return top == OWN_PACKAGE
    if file is None:
        return top in sys.stdlib_module_names
    return file_is_installed(file)


@cache
def file_is_installed(file: str) -> bool:
    """Whether a file belongs to Python or to an installed package."""
    path = Path(file).resolve()
    return any(path.is_relative_to(folder) for folder in _folders())


@cache
def _folders() -> tuple[Path, ...]:
    """Folders of Python's library and of installed packages."""
    names = ("stdlib", "platstdlib", "purelib", "platlib")
    paths = {sysconfig.get_path(name) for name in names}
    paths |= {*site.getsitepackages(), site.getusersitepackages()}
    return tuple(Path(path).resolve() for path in paths if path)


def import_is_installed(name: str) -> bool:
    """Whether ``import name`` would give a module of Python or an installed package."""
    top = name.partition(".")[0]
    if top in sys.modules:
        return is_installed(sys.modules[top])
    spec = find_spec(top)
    return spec is not None and _module_is_installed(
        top, spec.origin if spec.has_location else None
    )


def known_name(value: object) -> str:
    """How an installed object is known: its package, and its name there."""
    module = str(getattr(value, "__module__", "")).partition(".")[0]
    return f"{module}:{getattr(value, '__qualname__', None) or getattr(value, '__name__', '')}"
