"""∂t f = Q(f,f) + ε Δv f on velocities that stay as they are (docs/method.md §1)."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from granstudy.evolution.stability import largest_frequency, stability_limit
from granstudy.evolution.unknowns import Representation, relative_change
from granstudy.model.restitution import Restitution
from granstudy.model.scene import Scene
from granstudy.velocity.space import Term


class FixedFrame:
    """The equation for f.

    Parameters
    ----------
    form : Representation
        What is advanced.
    collisions : callable
        Q of such a state.
    scene : Scene
        Its diffusion ε costs nothing at 0.
    """

    def __init__(
        self,
        form: Representation,
        collisions: Callable[[np.ndarray], np.ndarray],
        scene: Scene,
    ) -> None:
        self.form = form
        self._collisions = collisions
        self._scene = scene
        self._epsilon = scene.diffusion
        self._diffusion = form.diffusion(scene.diffusion)

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

    def scale(self, state: np.ndarray) -> float:
        """The scale θ of the velocities: 1."""
        return 1.0

    def restitution(self, state: np.ndarray) -> Restitution:
        """Restitution in the velocities that the grid stores: the scene's."""
        return self._scene.restitution

    def heating(self, state: np.ndarray, temperature: float) -> float:
        """2ε/T a unit of the collisions' time, T the temperature of f."""
        return float(2.0 * self._epsilon / temperature)

    def stable_step(
        self, scheme: str, state: np.ndarray, density: float, dilation_rate: float
    ) -> float:
        """The largest step that is stable for certain; nothing dilates."""
        grid, scene = self.form.grid, self._scene
        frequency = largest_frequency(scene.kernel, scene.dim, grid.R, density)
        return stability_limit(scheme, grid, diffusion=self._epsilon, collision_frequency=frequency)

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
