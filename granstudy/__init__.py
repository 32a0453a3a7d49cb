"""granstudy: parameter studies of granular gases by the fast Fourier spectral method.

The public names are listed in the stub file beside this one. Each is imported when it is first used, so that
`import granstudy` and the processes of a workflow load what they need and no more. Datasets have the accessor
``ds.granular``, which is imported when it is first used, too.
"""

import sys
from typing import Any

import lazy_loader

__version__ = "0.1.0"

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """A public name. What it imports may have brought xarray, which then learns of the accessor."""
    found = _public(name)
    _register()
    return found


def _granular(ds: Any) -> Any:
    """The accessor of a dataset, imported now."""
    return _public("Granular")(ds)


def _register() -> None:
    """Tell xarray, where it is imported, of ``ds.granular``."""
    xarray = sys.modules.get("xarray")
    ready = getattr(xarray, "register_dataset_accessor", None)
    if ready is not None and not hasattr(xarray.Dataset, "granular"):
        ready("granular")(_granular)


_register()
