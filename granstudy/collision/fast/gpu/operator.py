"""The fast operator and the adaptive operator on a GPU: a call moves f there, and Q back."""

from typing import Any

import numpy as np

from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.collision.fast.gpu.device import Device, check_scene, find_gpu
from granstudy.collision.fast.gpu.gain import DeviceGainSum
from granstudy.collision.fast.gpu.transforms import DeviceResize, DeviceTransforms
from granstudy.collision.fast.nodes import Nodes
from granstudy.collision.fast.operator import GainLossOperator, MakeOperator, fast_operator
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.symmetry import Symmetry


class DeviceOperator(GainLossOperator):
    """Q(f,f) for real f by a sum over given nodes, whole on a device.

    The sum over nodes has the gain's precision; all else is double.

    Parameters
    ----------
    loss : ndarray, shape (N, N', N/2+1)
        G⁻ on the half spectrum of ``grid``.
    """

    gain: DeviceGainSum

    def __init__(
        self, grid: VelocityGrid, gain: DeviceGainSum, group: Symmetry, loss: np.ndarray
    ) -> None:
        super().__init__(grid, gain, group)
        device, N, n = gain.device, grid.N, gain.grid.N
        self._device = device
        self._recipe = (grid, gain, group, loss)
        self._loss = device.put(loss.astype(np.float64))
        self._outer = DeviceTransforms(device, grid.three_axis_shape)
        self._inner = DeviceTransforms(device, gain.shape)
        self._to_products = DeviceResize(device, grid.dim, N, n)
        self._from_products = DeviceResize(device, grid.dim, n, N)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the operator is made from; another process finds its own device."""
        return type(self), self._recipe

    def transform(self) -> None:
        """Make the transforms of one call on the device and nothing else, for benchmarks."""
        N, n = self.grid.N, self.gain.grid.N
        f, inner = (
            self._device.put(np.zeros(grid.three_axis_shape))
            for grid in (self.grid, self.gain.grid)
        )
        f_hat, inner_hat = self._outer.forward(f), None
        self.gain.transform()
        if n > N:
            inner_hat = self._inner.forward(inner)
            self._inner.backward(inner_hat)
            self._inner.backward(inner_hat)
        else:
            self._outer.backward(f_hat)
            if n < N:
                self._inner.backward(self._to_products(f_hat))
        Q = self._outer.backward(f_hat)
        self._device.fetch(Q[:1, :1, :1])  # waits until all are made

    def _collide(self, f: np.ndarray) -> np.ndarray:
        density = self._device.put(f)
        f_hat = self._spectrum(density)
        return self._device.fetch(
            self._collide_wide(f_hat)
            if self.gain.grid.N > self.grid.N
            else self._outer.consume(self._gain_spectrum(density, f_hat))
            - density * self._outer.consume(self._loss * f_hat)
        )

    def _lose(self, f: np.ndarray) -> np.ndarray:
        density = self._device.put(f)
        lost = self._outer.consume(self._loss * self._spectrum(density))
        return self._device.fetch(density * lost)

    def _spectrum(self, density: Any) -> Any:
        """f̂ with Σ_k f̂_k e^{iπk·v/L} = f."""
        return self._outer.forward(density) / self._outer.points

    def _gain_spectrum(self, density: Any, f_hat: Any) -> Any:
        """Q̂⁺ with its products on at most N points per dimension."""
        if self.gain.grid.N == self.grid.N:
            return self.gain.total(density, f_hat)
        f_hat = self._to_products(f_hat)
        return self._from_products(self.gain.total(self._inner.backward(f_hat), f_hat))

    def _collide_wide(self, f_hat: Any) -> Any:
        """Q(f,f) with all products formed on the gain's larger grid."""
        lost_hat = self._to_products(self._loss * f_hat)
        f_hat = self._to_products(f_hat)
        density = self._inner.backward(f_hat)
        lost_hat = self._inner.forward(density * self._inner.consume(lost_hat))
        Q_hat = self.gain.total(density, f_hat) - lost_hat / self._inner.points
        return self._outer.consume(self._from_products(Q_hat))


def check(scene: Scene) -> None:
    """Raise ValueError unless there is a GPU and the sum on it can model the scene."""
    check_scene(scene)
    find_gpu()


def operator_on(device: Device, memory: int | None = None) -> MakeOperator:
    """What makes operators on a device, in a solver's precision, whose batches take that much memory."""

    def make(
        scene: Scene,
        solver: SizedSolver,
        products: VelocityGrid,
        nodes: Nodes,
        group: Symmetry,
        loss: np.ndarray,
    ) -> DeviceOperator:
        gain = DeviceGainSum(scene, products, nodes, device, solver.precision, memory)
        return DeviceOperator(solver.grid(scene.dim), gain, group, loss)

    return make


def operator_on_gpu(
    scene: Scene,
    solver: SizedSolver,
    products: VelocityGrid,
    nodes: Nodes,
    group: Symmetry,
    loss: np.ndarray,
) -> GainLossOperator:
    """The operator of given nodes on the GPU of this machine; ValueError where there is none."""
    return operator_on(find_gpu())(scene, solver, products, nodes, group, loss)


def fast_on_gpu(scene: Scene, solver: SizedSolver) -> GainLossOperator:
    """The fast operator with the solver's rule, on a GPU."""
    return fast_operator(scene, solver, operator_on_gpu)


def adaptive_on_gpu(scene: Scene, solver: SizedSolver) -> AdaptiveOperator:
    """The operator tuned to the solver's tolerance, on a GPU. The quadrature is chosen on the CPU."""
    return AdaptiveOperator(scene, solver, operator_on_gpu)
