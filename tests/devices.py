"""Devices that the sum over nodes is tested on: NumPy, a strict namespace, PyTorch and a GPU if there."""

from functools import partial

import array_api_strict
import numpy as np
import pytest

from granstudy.collision.fast.gpu.device import LIBRARIES, Device

MEMORY = 2**26

NUMPY = Device("NumPy", np, "cpu", np.asarray, MEMORY)


def strict():
    """Nothing but the standard, on a device whose arrays do not mix with others."""
    cpu, other = (array_api_strict.Device(name) for name in ("CPU_DEVICE", "device1"))
    return Device("strict", array_api_strict, other, lambda a: np.asarray(a.to_device(cpu)), MEMORY)


def torch():
    pytest.importorskip("torch", reason="no PyTorch")
    xp = pytest.importorskip("array_api_compat.torch", reason="no array_api_compat")
    return Device("PyTorch", xp, "cpu", lambda a: a.numpy(), MEMORY)


def gpu(library):
    """The GPU of a library."""
    try:
        found = LIBRARIES[library]()
    except ImportError:
        found = None
    if found is None:
        pytest.skip(f"no GPU with {library}")
    return found


DEVICES = {
    "numpy": lambda: NUMPY,
    "strict": strict,
    "torch": torch,
    **{f"{library} GPU": partial(gpu, library) for library in LIBRARIES},
}
