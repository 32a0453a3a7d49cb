"""The fast operator: the gain as a sum over nodes, the loss as one convolution.

The loss is one convolution in both variants, as a sum over nodes of displaced densities is a multiplier.

Symmetry saves nodes (docs/method.md §2, fact 6). Let H be the symmetry group that the scene and the rule
have in common. One node r of each orbit under H and ±1 is evaluated, with the orbit's weight, and the sum
is symmetrised:

    Q⁺ = (1/|H|) Σ_{h∈H} h·Σ_r w_r Q⁺_r

For a density with the symmetry, Q⁺ equals to round-off the sum over all images ±h r, h ∈ H, each with the
weight w_r/|H|. The fast sum without H differs from it by aliasing alone: each pair ±g is evaluated at one
of its two nodes there, at the images of r here.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from granstudy.collision.fast import loops
from granstudy.collision.fast.gain import Gain, GainSum
from granstudy.collision.fast.nodes import Nodes, place_nodes
from granstudy.collision.fourier.spectra import resize, serial_transforms
from granstudy.collision.fourier.threads import OneAtATime
from granstudy.collision.fourier.transforms import RealTransforms
from granstudy.collision.protocol import check_state
from granstudy.collision.rules import directions, radial_nodes, reduce_directions
from granstudy.collision.weights import loss_weight
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import half
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.symmetry import Symmetry


class GainLossOperator(ABC):
    """Q(f,f) for real f: the gain as a sum over given nodes, the loss as one convolution, symmetrised.

    Parameters
    ----------
    gain : Gain
        The gain. Its grid may be ``grid``, a smaller grid that holds the spectra of f and of Q, or a larger
        one, where the products do not wrap around the spectrum. On a larger grid the products of the loss
        are formed as well.
    group : Symmetry
        Group under which the sum is symmetrised. Densities must have this symmetry.
    """

    def __init__(self, grid: VelocityGrid, gain: Gain, group: Symmetry) -> None:
        self.grid = grid
        self.gain = gain
        self.group = group
        self._one_at_a_time = OneAtATime()
        self.transforms = gain.transforms + serial_transforms(grid.N, gain.grid.N)

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) of a real density that has the operator's symmetry."""
        check_state(f, self.grid)
        if np.iscomplexobj(f):
            raise ValueError(f"density has type {f.dtype}: method 'fast' takes real densities")
        self.group.spot_check(f, "the density")
        with self._one_at_a_time:
            Q = self._collide(self._wide(f))
        # The loss has the symmetry already. Symmetrised with the gain, its round-off has it too.
        return self.group.symmetrise(Q.reshape(self.grid.shape), in_place=True)

    def loss(self, f: np.ndarray) -> np.ndarray:
        """Q⁻(f,f) alone."""
        with self._one_at_a_time:
            return self._lose(self._wide(f)).reshape(f.shape)

    @property
    def fftw_wisdom(self) -> str:
        """Hash of the wisdom that FFTW planned with; "" where it had none, or plans nothing."""
        return ""

    @abstractmethod
    def transform(self) -> None:
        """Make the transforms of one call on the same threads or device and nothing else, for benchmarks."""

    @abstractmethod
    def _collide(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) before it is symmetrised, of a density (N, N', N)."""

    @abstractmethod
    def _lose(self, f: np.ndarray) -> np.ndarray:
        """Q⁻(f,f) of a density (N, N', N)."""

    def _wide(self, f: np.ndarray) -> np.ndarray:
        return np.ascontiguousarray(f, dtype=np.float64).reshape(self.grid.three_axis_shape)


MakeOperator = Callable[
    [Scene, SizedSolver, VelocityGrid, Nodes, Symmetry, np.ndarray], GainLossOperator
]
"""Makes the operator of a scene and a solver, on the CPU (`nodal_operator`) or on another device. Further
arguments: the grid of the products, the nodes, the group, and G⁻ on the half spectrum."""


class NodalOperator(GainLossOperator):
    """Q(f,f) for real f by a sum over given nodes, on threads.

    Parameters
    ----------
    loss : ndarray, shape (N, N', N/2+1)
        G⁻ on the half spectrum of ``grid``.
    """

    def __init__(self, grid: VelocityGrid, gain: Gain, group: Symmetry, loss: np.ndarray) -> None:
        super().__init__(grid, gain, group)
        self._loss = np.ascontiguousarray(loss, dtype=np.float64)
        shape = grid.three_axis_shape
        self._f_hat = np.empty(loss.shape, dtype=np.complex128)
        self._single = RealTransforms(shape)
        self._lost = RealTransforms(shape)
        self._inner = self._single if gain.grid == grid else RealTransforms(gain.shape)

    def _collide(self, f: np.ndarray) -> np.ndarray:
        f_hat = self._spectrum(f)
        if self.gain.grid.N > self.grid.N:
            return self._single.backward(self._padded_spectrum(f_hat))
        self._filter_loss(f_hat)
        self._single.spectrum[...] = self._gain_spectrum(f, f_hat)
        self._single.execute_backward()
        Q = np.empty_like(f)
        rows = (-1, self.grid.N)
        loops.subtract_loss(self._single.rows, f.reshape(rows), self._lost.rows, Q.reshape(rows))
        return Q

    def _lose(self, f: np.ndarray) -> np.ndarray:
        self._filter_loss(self._spectrum(f))
        return np.asarray(f * self._lost.density)

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""
        with self._one_at_a_time:
            self._single.execute_forward()
            self.gain.transform()
            self._single.execute_backward()
            if self.gain.grid.N > self.grid.N:
                self._inner.execute_backward()
                self._inner.execute_backward()
                self._inner.execute_forward()
                return
            self._lost.execute_backward()
            if self.gain.grid.N < self.grid.N:
                self._inner.execute_backward()

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the operator is made from: the gain with its nodes, the group, the loss."""
        return type(self), (self.grid, self.gain, self.group, self._loss)

    @property
    def fftw_wisdom(self) -> str:
        """Hash of the wisdom that FFTW planned with; "" where it had none."""
        return self._single.wisdom

    def _spectrum(self, f: np.ndarray) -> np.ndarray:
        """f̂ with Σ_k f̂_k e^{iπk·v/L} = f. The next call overwrites it."""
        self._single.density[...] = f
        self._single.execute_forward()
        return np.multiply(self._single.spectrum, 1.0 / f.size, out=self._f_hat)

    def _filter_loss(self, f_hat: np.ndarray) -> None:
        """Fill `_lost` with the density that the loss multiplies f by."""
        lost, rows = self._lost, (self.grid.N, -1)
        parts = f_hat.view(np.float64).reshape(rows)
        loops.scale_modes(self._loss.reshape(rows), parts, lost.parts)
        lost.execute_backward()

    def _gain_spectrum(self, f: np.ndarray, f_hat: np.ndarray) -> np.ndarray:
        n = self.gain.grid.N
        if n == self.grid.N:
            return self.gain.total(f, f_hat)
        f_hat = resize(f_hat, n)
        return resize(self.gain.total(self._inner.backward(f_hat), f_hat), self.grid.N)

    def _padded_spectrum(self, f_hat: np.ndarray) -> np.ndarray:
        """Q̂ with all products formed on the gain's larger grid."""
        n = self.gain.grid.N
        f_hat_n = resize(f_hat, n)
        f_n = self._inner.backward(f_hat_n)
        lost = self._inner.forward(f_n * self._inner.backward(resize(self._loss * f_hat, n)))
        return resize(self.gain.total(f_n, f_hat_n) - lost / f_n.size, self.grid.N)


def nodal_operator(
    scene: Scene,
    solver: SizedSolver,
    products: VelocityGrid,
    nodes: Nodes,
    group: Symmetry,
    loss: np.ndarray,
) -> NodalOperator:
    """The operator of given nodes on the CPU, on the solver's threads and in its precision."""
    gain = GainSum(scene, products, nodes, solver.thread_count, precision=solver.precision)
    return NodalOperator(solver.grid(scene.dim), gain, group, loss)


def fast_operator(
    scene: Scene, solver: SizedSolver, make: MakeOperator = nodal_operator
) -> GainLossOperator:
    """The operator with the solver's rule: N_rho shells, each with the same directions."""
    grid = solver.grid(scene.dim)
    radial, rule = radial_nodes(scene, solver), directions(scene, solver)
    group, reduced = reduce_directions(rule, scene.symmetry)
    nodes = place_nodes(scene, grid, radial, [reduced] * len(radial))
    if solver.variant == "separate":
        loss = loss_weight(scene.kernel, grid, radial.points, radial.weights, half=True)
    else:
        loss = nodal_loss(grid, place_nodes(scene, grid, radial, [half(rule)] * len(radial)))
    products = VelocityGrid(scene.dim, solver.product_points, solver.R)
    return make(scene, solver, products, nodes, group, spectrum_axes(grid, loss))


def nodal_loss(grid: VelocityGrid, nodes: Nodes) -> np.ndarray:
    """G⁻(m) as a sum over the gain's nodes: the variant ``full``, which conserves mass to round-off."""
    loss = np.zeros(grid.half_spectrum_shape).reshape(grid.N, -1)
    loops.nodal_loss(nodes.vectors, nodes.weights * nodes.measure[nodes.shells], loss)
    return loss


def spectrum_axes(grid: VelocityGrid, multiplier: np.ndarray) -> np.ndarray:
    """A multiplier on the half spectrum, reshaped to the three axes of the transforms."""
    return multiplier.reshape(grid.half_spectrum_shape)
