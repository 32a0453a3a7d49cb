"""Devices that the sum over nodes is tested on: NumPy, a strict namespace, PyTorch and a GPU if there."""

import array_api_strict
import numpy as np
import pytest

from granstudy.collision.fast.gpu.device import Device, find_gpu

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


def gpu():
    try:
        return find_gpu()
    except ValueError:
        pytest.skip("no GPU with CuPy or PyTorch")


DEVICES = {"numpy": lambda: NUMPY, "strict": strict, "torch": torch, "gpu": gpu}
