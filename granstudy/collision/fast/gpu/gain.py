"""The gain as a sum over nodes in whole arrays, batch after batch, on a device of the array API standard.

The sum is that of `granstudy.collision.fast.gain` for a constant restitution, at the same two real
transforms for a pair ±g. With M_ρ(|k|) = |S|C_λ w_ρ ρ^{d−1+λ} mean(πρα|k|/L), and 2cos(βk·g) written as two
exponentials,

    Q̂⁺_k = Σ_g w_g M_ρ(|k|) [e^{i(½+β)k·g} + e^{i(½−β)k·g}] FFT[f(v) f(v−g)]_k.
"""

import itertools
import math
from typing import Any

import numpy as np

from granstudy.collision.fast.gain import pair_shift, shell_means
from granstudy.collision.fast.gpu.device import Device, check_scene, find_gpu
from granstudy.collision.fast.nodes import Nodes
from granstudy.collision.fourier.transforms import REAL
from granstudy.model.scene import Scene
from granstudy.velocity.cartesian import VelocityGrid

SPECTRA_HELD = 8
"""Most arrays of the size of a batch's half spectra that are held at a time, the transforms' own included."""

BATCH_BYTES = 2**30
"""Most memory that a batch takes, however much the device has. Arrays of this size keep a device busy."""

Axes = tuple[Any, ...]
"""Factors along the three axes of an outer product, each an array (nodes, modes) on the device."""


class DeviceGainSum:
    """The gain Q̂⁺ of a real density as a sum over given nodes, on a device.

    All arrays that do not depend on f lie on the device from the start. A call moves f and f̂ to the device,
    and the sum back.

    Parameters
    ----------
    grid : VelocityGrid
        The grid on which the products are formed.
    precision : str
        ``double``, or ``single`` for everything on the device.
    memory : int, optional
        Bytes that a batch may take, by default half of the free memory and at most `BATCH_BYTES`.

    Raises
    ------
    ValueError
        If the scene's restitution depends on the impact speed.
    """

    def __init__(
        self,
        scene: Scene,
        grid: VelocityGrid,
        nodes: Nodes,
        device: Device,
        precision: str = "double",
        memory: int | None = None,
    ) -> None:
        check_scene(scene)
        assert not callable(scene.restitution)
        self._recipe = (scene, grid, nodes, precision, memory)
        self.grid = grid
        self.nodes = nodes
        self.shape = grid.three_axis_shape
        self.transforms = 2 * len(nodes)
        self._device = device
        self._real = REAL[precision]
        self._complex = np.result_type(self._real, np.complex64)
        self._half = grid.half_spectrum_shape
        self._axes = (1, 2, 3) if grid.dim == 3 else (1, 3)
        if memory is None:
            memory = min(BATCH_BYTES, device.memory // 2)
        bytes_of_a_node = SPECTRA_HELD * self._complex.itemsize * math.prod(self._half)
        self._batches = equal_batches(len(nodes), memory // bytes_of_a_node)
        beta = pair_shift(scene.restitution)
        self._shift = self._phases(-nodes.vectors)
        self._plus = self._phases((0.5 + beta) * nodes.vectors, nodes.weights)
        self._minus = self._phases((0.5 - beta) * nodes.vectors, nodes.weights)
        k2, place = np.unique(grid.wavenumber_squared(half=True), return_inverse=True)
        means = shell_means(scene.restitution, grid.dim, nodes, np.pi / grid.L * np.sqrt(k2))
        self._means = self._put(means[:, place.reshape(self._half)], self._real)
        self._shells = device.put(nodes.shells)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the sum is made from, nodes included; another process finds its own device."""
        return on_found_gpu, self._recipe

    def total(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        """The sum over all nodes, a half spectrum (n, n', n/2+1).

        ``f`` has shape (n, n', n); ``f_hat`` is its half spectrum, Σ_k f̂_k e^{iπk·v/L} = f.
        """
        xp = self._device.xp
        f, f_hat = self._put(f, self._real), self._put(f_hat, self._complex)
        gain = xp.zeros_like(f_hat)
        for part in self._batches:
            shifted = outer_product(self._shift, part)
            shifted *= f_hat
            products = self._backward(shifted)
            products *= f
            spectra = self._forward(products)
            weights = outer_product(self._plus, part)
            weights += outer_product(self._minus, part)
            weights *= xp.take(self._means, self._shells[part], axis=0)
            spectra *= weights
            gain += xp.sum(spectra, axis=0)
        return self._device.fetch(gain).astype(np.complex128)

    def transform(self) -> None:
        """Make the transforms of one sum and nothing else, for benchmarks."""
        xp = self._device.xp
        dtype = getattr(xp, self._complex.name)
        for part in self._batches:
            shape = (part.stop - part.start, *self._half)
            spectra = xp.zeros(shape, dtype=dtype, device=self._device.place)
            spectra = self._forward(self._backward(spectra))
        self._device.fetch(spectra[:1, :1, :1, :1])  # waits until all are made

    def _backward(self, spectra: Any) -> Any:
        """Densities Σ_k f̂_k e^{iπk·v/L} of a batch of half spectra."""
        s = (self.grid.N,) * self.grid.dim
        return self._device.xp.fft.irfftn(spectra, s=s, axes=self._axes, norm="forward")

    def _forward(self, densities: Any) -> Any:
        """Half spectra f̂_k of a batch of densities."""
        return self._device.xp.fft.rfftn(densities, axes=self._axes, norm="forward")

    def _phases(self, displacements: np.ndarray, weights: np.ndarray | float = 1.0) -> Axes:
        """Factors of weight · e^{ik·x} along the three axes, each (nodes, modes)."""
        x, y, z = (
            phase_vectors(angles, self.grid.N, modes)
            for angles, modes in zip(displacements.T, self._half, strict=True)
        )
        x *= np.reshape(weights, (-1, 1))
        return tuple(self._put(factor, self._complex) for factor in (x, y, z))

    def _put(self, values: np.ndarray, dtype: np.dtype) -> Any:
        return self._device.put(np.ascontiguousarray(values, dtype=dtype))


def on_found_gpu(
    scene: Scene, grid: VelocityGrid, nodes: Nodes, precision: str, memory: int | None = None
) -> DeviceGainSum:
    """The sum on the GPU of this machine; ValueError where there is none."""
    return DeviceGainSum(scene, grid, nodes, find_gpu(), precision, memory)


def phase_vectors(angles: np.ndarray, n: int, modes: int) -> np.ndarray:
    """e^{i·angle·k} for the first ``modes`` wavenumbers of n points in FFT order, shape (angles, modes).

    The unpaired mode k = −n/2 takes the mean of its two signs, which keeps real functions real.
    """
    k = np.fft.fftfreq(n, 1 / n)[:modes]
    phases = np.exp(1j * np.outer(angles, k))
    unpaired = np.abs(k) == n // 2
    phases[:, unpaired] = phases[:, unpaired].real
    return phases


def outer_product(axes: Axes, part: slice) -> Any:
    """Products of the factors of a part of the nodes, over all modes: shape (nodes, n, n', n/2+1)."""
    x, y, z = (factor[part, :] for factor in axes)
    return x[:, :, None, None] * (y[:, :, None] * z[:, None, :])[:, None, :, :]


def equal_batches(count: int, largest: int) -> list[slice]:
    """``count`` nodes in the fewest batches of at most ``largest`` nodes, all of about the same size."""
    batches = -(-count // max(1, largest))
    ends = [count * i // batches for i in range(batches + 1)] if count else []
    return [slice(start, stop) for start, stop in itertools.pairwise(ends)]
