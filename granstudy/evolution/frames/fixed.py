"""∂t f = Q(f,f) + ε Δv f on velocities that stay as they are (docs/method.md §1)."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from granstudy.evolution.unknowns import Representation, relative_change
from granstudy.velocity.space import Term


class FixedFrame:
    """The equation for f.

    Parameters
    ----------
    form : Representation
        What is advanced.
    collisions : callable
        Q of such a state.
    diffusion : float
        ε; at 0 diffusion costs nothing.
    """

    def __init__(
        self,
        form: Representation,
        collisions: Callable[[np.ndarray], np.ndarray],
        diffusion: float,
    ) -> None:
        self.form = form
        self._collisions = collisions
        self._epsilon = diffusion
        self._diffusion = form.diffusion(diffusion)

    def start(self, f: np.ndarray) -> np.ndarray:
        """The state of an initial density."""
        return self.form.state(f)

    def rate(self, state: np.ndarray, taken_off: float = 0.0) -> np.ndarray:
        """Q + (ε − taken_off) Δ; what is taken off is ε or nothing."""
        if taken_off == self._epsilon:
            return self._collisions(state)
        return self._collisions(state) + self._diffusion(state)

    def collisions(self, state: np.ndarray) -> np.ndarray:
        """Q at the nodes."""
        return self.form.density(self._collisions(state))

    def clock(self, state: np.ndarray, time: float) -> float:
        """The collisions' time: t."""
        return time

    def diffusivity(self, state: np.ndarray) -> float:
        """ε."""
        return self._epsilon

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) state over the terms."""
        return self.form.laplacian_functions(x, terms)

    def density(self, state: np.ndarray) -> np.ndarray:
        """F at the nodes."""
        return self.form.density(state)

    def record(self, values: dict[str, Any], state: np.ndarray) -> dict[str, Any]:
        """Moments of f from the moments of what the grid holds: the same."""
        return values

    def relative_size(self, change: np.ndarray, state: np.ndarray) -> float:
        """Size of a change of the density, see `granstudy.evolution.unknowns.relative_change`."""
        return relative_change(self.form, change, state)

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The state without what round-off did to its symmetry."""
        return self.form.symmetrise(state)
