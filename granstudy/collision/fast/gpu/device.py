"""Where a sum over nodes is computed: a namespace of the array API standard, and a device of it.

https://data-apis.org/array-api/latest: the same code then runs on NumPy, CuPy and PyTorch.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.model.scene import Scene


@dataclass(frozen=True)
class Device:
    """A device and the functions that compute on it.

    Attributes
    ----------
    name : str
        For people.
    xp : module
        Namespace of the array API standard with its extension ``fft``.
    place : object
        The device, as the namespace's functions take it.
    fetch : callable
        From an array on the device to a NumPy array; waits until it has been computed.
    memory : int
        Free bytes.
    """

    name: str
    xp: Any
    place: Any
    fetch: Callable[[Any], np.ndarray]
    memory: int

    def put(self, values: np.ndarray) -> Any:
        """The values in an array on the device."""
        return self.xp.asarray(values, device=self.place)


def check_scene(scene: Scene) -> None:
    """Raise ValueError unless a GPU can model the scene: the restitution must be a constant."""
    if callable(scene.restitution):
        raise ValueError(
            f"restitution={scene.restitution!r}: device 'gpu' takes a constant, not a function of the "
            "impact speed; take device 'cpu'"
        )


def find_gpu() -> Device:
    """The current GPU of CuPy, or else of PyTorch.

    Raises
    ------
    ValueError
        If neither is installed with a GPU.
    """
    missing = []
    for library, find in (("CuPy", _cupy_gpu), ("PyTorch", _torch_gpu)):
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


def _cupy_gpu() -> Device | None:
    import cupy  # isort: skip  # first: its absence is what to tell
    import array_api_compat.cupy as xp

    if not cupy.is_available():
        return None
    place = cupy.cuda.Device()
    free, _ = place.mem_info
    return Device(f"CuPy, GPU {place.id}", xp, place, cupy.asnumpy, free)


def _torch_gpu() -> Device | None:
    import torch  # isort: skip  # first, as above
    import array_api_compat.torch as xp

    if not torch.cuda.is_available():
        return None
    free, _ = torch.cuda.mem_get_info()
    return Device(
        f"PyTorch, {torch.cuda.get_device_name()}", xp, "cuda", lambda a: a.cpu().numpy(), free
    )
