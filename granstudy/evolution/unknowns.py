"""The unknowns that a run advances: values of a density at the nodes, or its Fourier coefficients f̂."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.fft

from granstudy.collision.protocol import CollisionOperator, SpectrumOperator, SymmetricOperator
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import Term, VelocitySpace
from granstudy.velocity.symmetry import Symmetry


class Representation(Protocol):
    """A kind of state, with the linear operators of docs/method.md §1 and §5 on it.

    `granstudy.velocity.space.VelocitySpace` has the same operators on densities at the nodes.
    """

    @property
    def grid(self) -> VelocitySpace: ...  # noqa: D102

    def state(self, f: np.ndarray) -> np.ndarray:
        """The state of a density."""

    def density(self, state: np.ndarray) -> np.ndarray:
        """The density of a state."""

    def diffusion(self, epsilon: float) -> Callable[[np.ndarray], np.ndarray]:
        """state ↦ ε Δ state."""

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) state over the terms."""

    def gradient(self, state: np.ndarray) -> list[np.ndarray]:
        """∂i of the state."""

    def dilation(self, state: np.ndarray) -> np.ndarray:
        """∇v·(v state)."""

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The state with the symmetry restored that round-off and instability disturb."""


@dataclass(frozen=True)
class Values:
    """Real densities by their values at the nodes of any grid; on a Cartesian grid, with a symmetry."""

    grid: VelocitySpace
    symmetry: Symmetry | None = None

    def state(self, f: np.ndarray) -> np.ndarray:
        """The density itself."""
        return f

    def density(self, state: np.ndarray) -> np.ndarray:
        """The state itself."""
        return state

    def diffusion(self, epsilon: float) -> Callable[[np.ndarray], np.ndarray]:
        """state ↦ ε Δ state."""
        return lambda f: epsilon * self.grid.laplacian(f)

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) state over the terms."""
        return self.grid.laplacian_functions(x, terms)

    def gradient(self, state: np.ndarray) -> list[np.ndarray]:
        """∂i of the state."""
        return self.grid.gradient(state)

    def dilation(self, state: np.ndarray) -> np.ndarray:
        """∇v·(v state)."""
        return self.grid.dilation(state)

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The mean of the state over its symmetry group."""
        return state if self.symmetry is None else self.symmetry.symmetrise(state)


@dataclass(frozen=True)
class Spectrum:
    """Densities by f̂ on a Cartesian grid: complex, and never projected on real f, as `literal` has it."""

    grid: VelocityGrid

    def state(self, f: np.ndarray) -> np.ndarray:
        """f̂, normalised by N^d."""
        return scipy.fft.fftn(f, norm="forward")

    def density(self, state: np.ndarray) -> np.ndarray:
        """The real part of f."""
        return scipy.fft.ifftn(state, norm="forward").real

    def diffusion(self, epsilon: float) -> Callable[[np.ndarray], np.ndarray]:
        """state ↦ ε Δ state, by the multiplier −ε(π|k|/L)² (docs/method.md §3)."""
        multiplier = -epsilon * (np.pi / self.grid.L) ** 2 * self.grid.wavenumber_squared()
        return lambda f_hat: multiplier * f_hat

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) state over the terms."""
        eigenvalues = -((np.pi / self.grid.L) ** 2) * self.grid.wavenumber_squared()
        return np.asarray(sum(phi(x * eigenvalues) * f_hat for phi, f_hat in terms))

    def gradient(self, state: np.ndarray) -> list[np.ndarray]:
        """∂i of the state."""
        return [self.state(part) for part in self.grid.gradient(self._values(state))]

    def dilation(self, state: np.ndarray) -> np.ndarray:
        """∇v·(v state)."""
        return self.state(self.grid.dilation(self._values(state)))

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The state itself: `literal` uses no symmetry."""
        return state

    def _values(self, state: np.ndarray) -> np.ndarray:
        """f at the nodes, complex: the imaginary part is advanced too."""
        return scipy.fft.ifftn(state, norm="forward")


def representation(operator: CollisionOperator, symmetry: Symmetry) -> Representation:
    """The kind of state that runs with an operator advance, for densities with a symmetry."""
    if isinstance(operator, SpectrumOperator):
        return Spectrum(operator.grid)
    return Values(operator.grid, symmetry if isinstance(operator.grid, VelocityGrid) else None)


def collisions(operator: CollisionOperator) -> Callable[[np.ndarray], np.ndarray]:
    """Q as a function of the states that runs with an operator advance.

    Within a large step round-off can grow. An operator that takes densities of a symmetry alone gets the mean
    of the state over its group.
    """
    if isinstance(operator, SpectrumOperator):
        return operator.spectrum
    if isinstance(operator, SymmetricOperator):
        symmetric = operator
        return lambda f: symmetric(symmetric.group.symmetrise(f))
    return operator


def relative_change(form: Representation, change: np.ndarray, state: np.ndarray) -> float:
    """Relative size of a change of a state: the larger of two measures.

    One is the largest change of the density over its largest value. The other is ∫|v|⁴|change| over
    ∫|v|⁴|f|: the fourth moment sees noise at the grid's border long before the noise is large.
    """
    delta, f = np.abs(form.density(change)), np.abs(form.density(state))
    v4 = sum(np.square(v) for v in form.grid.velocities()) ** 2 * form.grid.measure
    return float(max(np.max(delta) / np.max(f), np.sum(v4 * delta) / np.sum(v4 * f)))
