"""Devices that a sum over nodes is computed on, each with a namespace of the array API standard.

The standard is at https://data-apis.org/array-api/latest. The same code runs on NumPy, CuPy and PyTorch.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from granstudy.model.scene import Scene


@dataclass(frozen=True)
class Device:
    """A device and the functions that compute on it.

    Attributes
    ----------
    name : str
        Name for messages.
    xp : module
        Namespace of the array API standard, with the extension ``fft``.
    place : object
        The device, as the namespace's functions take it.
    fetch : callable
        Makes a NumPy array of an array on the device, and waits until it has been computed.
    memory : int
        Free memory in bytes.
    irfftn : callable, optional
        The namespace's ``fft.irfftn``, which may also overwrite its argument. It then need not copy it.
    """

    name: str
    xp: Any
    place: Any
    fetch: Callable[[Any], np.ndarray]
    memory: int
    irfftn: Callable[..., Any] | None = None

    def put(self, values: np.ndarray) -> Any:
        """An array on the device with the same values."""
        return self.xp.asarray(values, device=self.place)


def check_scene(scene: Scene) -> None:
    """Raise ValueError unless the sum on a GPU can model the scene: its restitution must be a constant."""
    if callable(scene.restitution):
        raise ValueError(
            f"restitution={scene.restitution!r}: device 'gpu' takes a constant, not a function of the "
            "impact speed; take device 'cpu'"
        )


def cupy_gpu() -> Device | None:
    """The current GPU of CuPy, None where it finds none."""
    import cupy  # isort: skip  # first, so that a missing CuPy is named in the error
    import array_api_compat.cupy as xp
    from cupyx.scipy.fft import irfftn

    if not cupy.is_available():
        return None
    place = cupy.cuda.Device()
    free, _ = place.mem_info
    overwriting = partial(irfftn, overwrite_x=True)
    return Device(f"CuPy, GPU {place.id}", xp, place, cupy.asnumpy, free, overwriting)


def torch_gpu() -> Device | None:
    """The current GPU of PyTorch, None where it finds none."""
    import torch  # isort: skip  # first, as above
    import array_api_compat.torch as xp

    if not torch.cuda.is_available():
        return None
    free, _ = torch.cuda.mem_get_info()
    return Device(
        f"PyTorch, {torch.cuda.get_device_name()}", xp, "cuda", lambda a: a.cpu().numpy(), free
    )


LIBRARIES = {"CuPy": cupy_gpu, "PyTorch": torch_gpu}
"""What finds a GPU with each library, the preferred one first."""


def find_gpu() -> Device:
    """The current GPU of CuPy, or of PyTorch where CuPy has none.

    Raises
    ------
    ValueError
        If neither library is installed with a GPU.
    """
    missing = []
    for library, find in LIBRARIES.items():
        try:
            gpu = find()
        except ImportError as error:
            missing.append(f"{library}: {error.name or library} cannot be imported")
            continue
        if gpu is not None:
            return gpu
        missing.append(f"{library}: finds no GPU")
    raise ValueError(
        f"device='gpu': needs CuPy or PyTorch with a GPU ({'; '.join(missing)}); take device 'cpu'"
    )
