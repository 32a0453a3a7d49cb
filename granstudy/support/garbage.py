"""A pause of the search for garbage."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def paused_collection() -> Iterator[None]:
    """Search for no garbage inside the block; afterwards go on if there was a search before.

    The blocks that it is for make many objects and hardly any garbage, as imports do.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()
