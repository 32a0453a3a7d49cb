"""The gain as a sum over nodes in whole arrays, batch after batch, on a device of the array API standard.

The sum is that of `granstudy.collision.fast.gain` for a constant restitution, at the same two real
transforms for a pair ±g. With M_ρ(|k|) = |S|C_λ w_ρ ρ^{d−1+λ} mean(πρα|k|/L), and 2cos(βk·g) written as two
exponentials,

    Q̂⁺_k = Σ_ρ M_ρ(|k|) Σ_{|g|=ρ} w_g [e^{i(½+β)k·g} + e^{i(½−β)k·g}] FFT[f(v) f(v−g)]_k.

A device moves arrays more slowly than it computes. Matrix products write the two exponentials and add up the
shells in one pass over the arrays each.
"""

import itertools
import math
from typing import Any

import numpy as np

from granstudy.collision.fast.gain import pair_shift, shell_means
from granstudy.collision.fast.gpu.device import Device, check_scene, find_gpu
from granstudy.collision.fast.gpu.transforms import DeviceTransforms, as_complex
from granstudy.collision.fast.nodes import Nodes
from granstudy.collision.fourier.transforms import REAL
from granstudy.model.scene import Scene
from granstudy.velocity.cartesian import VelocityGrid

SPECTRA_HELD = 8
"""Most arrays of the size of a batch's half spectra that are held at a time, the transforms' own included."""

BATCH_BYTES = 2**30
"""Most memory that a batch takes, however much the device has. Arrays of this size keep a device busy."""


class DeviceGainSum:
    """The gain Q̂⁺ of a real density as a sum over given nodes, on a device.

    All arrays that do not depend on f lie on the device from the start.

    Parameters
    ----------
    grid : VelocityGrid
        The grid on which the products are formed.
    precision : str
        ``double``, or ``single`` for the nodes' transforms and products. Batches are added in double
        precision.
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
        self.device = device
        self.grid = grid
        self.nodes = nodes
        self.shape = grid.three_axis_shape
        self.transforms = 2 * len(nodes)
        self._real = REAL[precision]
        self._complex = as_complex(self._real)
        self._half = grid.half_spectrum_shape
        self._transforms = DeviceTransforms(device, self.shape)
        if memory is None:
            memory = min(BATCH_BYTES, device.memory // 2)
        bytes_of_a_node = SPECTRA_HELD * self._complex.itemsize * math.prod(self._half)
        batches = equal_batches(len(nodes), memory // bytes_of_a_node)
        self._batches = [(part, *self._shells_of(part)) for part in batches]
        self._shift = [self._put(axis) for axis in self._phases(-nodes.vectors)]
        beta = pair_shift(scene.restitution)
        x, y, z = (
            np.stack(pair, axis=1)
            for pair in zip(
                self._phases((0.5 + beta) * nodes.vectors),
                self._phases((0.5 - beta) * nodes.vectors),
                strict=True,
            )
        )
        weights = nodes.weights / self._transforms.points  # transforms are unnormalised
        self._pair_x = self._put(weights[:, None, None] * x.swapaxes(1, 2))
        self._pair_y, self._pair_z = self._put(y), self._put(z)
        k2, place = np.unique(grid.wavenumber_squared(half=True), return_inverse=True)
        means = shell_means(scene.restitution, grid.dim, nodes, np.pi / grid.L * np.sqrt(k2))
        means = means[:, place.reshape(self._half)]
        self._means = device.put(means.astype(self._real))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the sum is made from, nodes included; another process finds its own device."""
        return on_found_gpu, self._recipe

    def total(self, f: Any, f_hat: Any) -> Any:
        """The sum over all nodes, a half spectrum (n, n', n/2+1) in double precision.

        ``f`` has shape (n, n', n); ``f_hat`` is its half spectrum, Σ_k f̂_k e^{iπk·v/L} = f. All three lie on
        the device.
        """
        xp = self.device.xp
        gain = xp.zeros(self._half, dtype=xp.complex128, device=self.device.place)
        f, f_hat = self._cast(f, self._real), self._cast(f_hat, self._complex)
        for part, shells, membership in self._batches:
            shifted = self._shifts(part)
            shifted *= f_hat
            products = self._transforms.consume(shifted)
            del shifted
            products *= f
            spectra = self._transforms.forward(products)
            del products
            spectra *= self._pairs(part)
            sums = xp.matmul(membership, xp.reshape(spectra, (len_of(part), -1)))
            del spectra
            sums = xp.reshape(sums, (-1, *self._half))
            sums *= self._means[shells, ...]
            gain += xp.sum(sums, axis=0)
        return gain

    def transform(self) -> None:
        """Start the transforms of one sum and nothing else, for benchmarks."""
        xp = self.device.xp
        dtype = getattr(xp, self._complex.name)
        for part, _, _ in self._batches:
            shape = (len_of(part), *self._half)
            spectra = xp.zeros(shape, dtype=dtype, device=self.device.place)
            self._transforms.forward(self._transforms.consume(spectra))

    def _shells_of(self, part: slice) -> tuple[slice, Any]:
        """The shells of a batch, and a matrix (shells, nodes) that is 1 where a node lies on a shell."""
        shells = self.nodes.shells[part]
        first, last = int(shells[0]), int(shells[-1])
        on_shell = shells == np.arange(first, last + 1)[:, None]
        return slice(first, last + 1), self._put(on_shell)

    def _shifts(self, part: slice) -> Any:
        """e^{−ik·g} of a batch, shape (nodes, n, n', n/2+1)."""
        x, y, z = (axis[part, :] for axis in self._shift)
        return x[:, :, None, None] * (y[:, :, None] * z[:, None, :])[:, None, :, :]

    def _pairs(self, part: slice) -> Any:
        """w_g [e^{i(½+β)k·g} + e^{i(½−β)k·g}] of a batch, shape (nodes, n, n', n/2+1)."""
        xp = self.device.xp
        y, z = self._pair_y[part, :, :], self._pair_z[part, :, :]
        yz = xp.reshape(y[:, :, :, None] * z[:, :, None, :], (len_of(part), 2, -1))
        return xp.reshape(xp.matmul(self._pair_x[part, :, :], yz), (len_of(part), *self._half))

    def _phases(self, displacements: np.ndarray) -> list[np.ndarray]:
        """Factors of e^{ik·x} along the three axes, each (nodes, modes)."""
        return [
            phase_vectors(angles, self.grid.N, modes)
            for angles, modes in zip(displacements.T, self._half, strict=True)
        ]

    def _put(self, values: np.ndarray) -> Any:
        return self.device.put(np.ascontiguousarray(values, dtype=self._complex))

    def _cast(self, values: Any, dtype: np.dtype[Any]) -> Any:
        xp = self.device.xp
        return xp.astype(values, getattr(xp, dtype.name), copy=False)


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


def len_of(part: slice) -> int:
    """How many nodes a batch has."""
    return int(part.stop - part.start)


def equal_batches(count: int, largest: int) -> list[slice]:
    """``count`` nodes in the fewest batches of at most ``largest`` nodes, all of about the same size."""
    batches = -(-count // max(1, largest))
    ends = [count * i // batches for i in range(batches + 1)] if count else []
    return [slice(start, stop) for start, stop in itertools.pairwise(ends)]
