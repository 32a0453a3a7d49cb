"""Real transforms on a device, and half spectra resized there.

Arrays have three last axes in both dimensions, as in `granstudy.collision.fourier.spectra`.
"""

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from granstudy.collision.fast.gpu.device import Device
from granstudy.collision.fourier.spectra import paired_modes, turns

AXES = (-3, -2, -1)
"""The axes of a transform. In 2D the second has length 1: libraries plan adjacent axes together."""


class DeviceTransforms:
    """Unnormalised real transforms of arrays on a device, over their last three axes.

    Parameters
    ----------
    shape : tuple of int
        Shape (n, n', n) of a density.
    """

    def __init__(self, device: Device, shape: Sequence[int]) -> None:
        self._device = device
        self._shape = tuple(shape)
        self.points = math.prod(shape)

    def forward(self, densities: Any) -> Any:
        """Half spectra Σ_v f e^{−iπk·v/L} of densities. Their mean f̂_k is this over `points`."""
        return self._device.xp.fft.rfftn(densities, axes=AXES)

    def backward(self, spectra: Any) -> Any:
        """Densities Σ_k f̂_k e^{iπk·v/L} of half spectra."""
        return self._device.xp.fft.irfftn(spectra, s=self._shape, axes=AXES, norm="forward")

    def consume(self, spectra: Any) -> Any:
        """Densities as from `backward`; the device may overwrite the half spectra, which saves a copy."""
        irfftn = self._device.irfftn or self._device.xp.fft.irfftn
        return irfftn(spectra, s=self._shape, axes=AXES, norm="forward")


class DeviceResize:
    """`granstudy.collision.fourier.spectra.resize` on a device, from N to n points per dimension.

    Parameters
    ----------
    dim : int
        2 or 3.
    """

    def __init__(self, device: Device, dim: int, N: int, n: int) -> None:
        self._device = device
        self._shape = (n, n if dim == 3 else 1, n // 2 + 1)
        self._half = min(n, N) // 2
        self._turns = device.put(turns(N, n))
        self._blocks = list(itertools.product(*([paired_modes(N, n)] * (dim - 1))))

    def __call__(self, f_hat: Any) -> Any:
        """Half spectrum of the same function on the other grid."""
        out = self._device.xp.zeros(self._shape, dtype=f_hat.dtype, device=self._device.place)
        half = self._half
        for x, *rest in self._blocks:
            y = rest[0] if rest else slice(0, 1)
            turned = f_hat[x, y, :half] * self._turns[x, None, None] * self._turns[:half]
            if rest:
                turned *= self._turns[y, None]
            out[x, y, :half] = turned
        return out


def as_complex(real: np.dtype[Any]) -> np.dtype[Any]:
    """The complex type with the precision of a real one."""
    return np.result_type(real, np.complex64)
