"""What every collision operator is: Q(f,f) for one scene and one solver, planned once, called often."""

from typing import Protocol, runtime_checkable

import numpy as np

from granstudy.support.errors import NotFiniteError
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import VelocitySpace


class CollisionOperator(Protocol):
    """Q(f,f) for one scene and one solver: planned once, called often.

    Attributes
    ----------
    grid : VelocityGrid, or RadialGrid of the method `radial`
    transforms : int
        Fourier transforms on the grid that one call makes.
    """

    @property
    def grid(self) -> VelocitySpace: ...  # noqa: D102
    @property
    def transforms(self) -> int: ...  # noqa: D102

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f), of the shape and type of ``f``: real for real densities."""

    def transform(self) -> None:
        """Make the transforms of one call on the same threads and nothing else, for benchmarks."""


@runtime_checkable
class SpectrumOperator(CollisionOperator, Protocol):
    """An operator of which a run advances f̂, complex and never projected on real f (`literal`)."""

    @property
    def grid(self) -> VelocityGrid: ...  # noqa: D102

    def spectrum(self, f_hat: np.ndarray) -> np.ndarray:
        """Q̂ from f̂ (docs/method.md §2, normalised by N^d), both in FFT order."""


def check_state(f: np.ndarray, grid: VelocitySpace) -> None:
    """Raise ValueError unless ``f`` can be a state on ``grid``: its shape, and finite values."""
    if np.shape(f) != grid.shape:
        raise ValueError(f"density has shape {np.shape(f)}: the grid's is {grid.shape}")
    if not np.all(np.isfinite(f)):
        raise NotFiniteError("density holds values that are NaN or infinite: all must be finite")
