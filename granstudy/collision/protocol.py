"""The protocol of collision operators, and the check of densities that they are given."""

from typing import Protocol, runtime_checkable

import numpy as np

from granstudy.support.errors import NotFiniteError
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import VelocitySpace, check_shape
from granstudy.velocity.symmetry import Symmetry


class CollisionOperator(Protocol):
    """Q(f,f) for one scene and one solver: planned once, called often, from wherever.

    =========================  ==================================================================
    several threads at once    each gets the numbers that it would get alone; one call waits for
                               the other, as a call uses ``Solver.threads`` threads already
    a forked process           calls the operator as its parent does
    a pickle                   holds scene, solver and chosen quadrature; another process makes
                               the same operator of it, with the same numbers
    =========================  ==================================================================

    A scene with a function that cannot be pickled, such as a lambda, makes an operator that cannot be.

    Attributes
    ----------
    grid : VelocitySpace
        Grid of f: a `RadialGrid` for the method `radial`, else a `VelocityGrid`.
    transforms : int
        Fourier transforms on the grid in one call.
    """

    @property
    def grid(self) -> VelocitySpace: ...  # noqa: D102
    @property
    def transforms(self) -> int: ...  # noqa: D102

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f), with the shape and type of ``f``: real for real densities."""

    def transform(self) -> None:
        """Make the transforms of one call, on the same threads, and nothing else: for benchmarks."""


@runtime_checkable
class SpectrumOperator(CollisionOperator, Protocol):
    """An operator of runs that advance f̂: complex, never projected on real f, as `literal` has it."""

    @property
    def grid(self) -> VelocityGrid: ...  # noqa: D102

    def spectrum(self, f_hat: np.ndarray) -> np.ndarray:
        """Q̂ from f̂, both in FFT order and normalised by N^d (docs/method.md §2)."""


@runtime_checkable
class SymmetricOperator(CollisionOperator, Protocol):
    """An operator that takes densities of a symmetry alone: its sum has one node of each orbit."""

    @property
    def group(self) -> Symmetry:
        """The symmetry."""


@runtime_checkable
class DifferentiableOperator(CollisionOperator, Protocol):
    """An operator that has its derivative as a matrix."""

    def derivative(self, f: np.ndarray) -> np.ndarray:
        """The matrix of h ↦ Q(f,h) + Q(h,f)."""


@runtime_checkable
class PlannedOperator(CollisionOperator, Protocol):
    """An operator whose transforms FFTW planned, with wisdom where this machine has some."""

    @property
    def fftw_wisdom(self) -> str:
        """Hash of the wisdom that plans were made with; "" where there was none."""


def wisdom_attributes(operator: CollisionOperator) -> dict[str, str]:
    """The attribute `fftw_wisdom` of a dataset with an operator's numbers; none where no wisdom was used."""
    used = operator.fftw_wisdom if isinstance(operator, PlannedOperator) else ""
    return {"fftw_wisdom": used} if used else {}


def check_state(f: np.ndarray, grid: VelocitySpace) -> None:
    """Raise ValueError unless ``f`` can be a state on ``grid``: its shape, and finite values."""
    check_shape(f, grid)
    if not np.isfinite(f).all():
        raise NotFiniteError("density holds values that are NaN or infinite: all must be finite")
