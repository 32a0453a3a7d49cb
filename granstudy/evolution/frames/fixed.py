"""The equation for f on fixed velocities: ∂t f = Q(f,f) + ε Δv f (docs/method.md §1)."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from granstudy.evolution.stability import largest_frequency, stability_limit
from granstudy.evolution.unknowns import Representation, relative_change
from granstudy.model.restitution import Restitution
from granstudy.model.scene import Scene
from granstudy.trust.changes import Change, change_of_moments
from granstudy.velocity.space import Term


class FixedFrame:
    """The equation for f on fixed velocities.

    Parameters
    ----------
    form : Representation
        Kind of the states.
    collisions : callable
        state ↦ Q.
    scene : Scene
        Heating ε, kernel and restitution; ε = 0 costs nothing.
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
        """The rate of change Q + (ε − taken_off) Δf; ``taken_off`` is ε or 0."""
        Q = self._collisions(state)
        return Q if taken_off == self._epsilon else Q + self._diffusion(state)

    def moment_change(self, state: np.ndarray, change: np.ndarray) -> Change:
        """Change of T and a2 by a small change of the state."""
        return change_of_moments(self.form.grid, self.density(state), self.density(change))

    def moment_rates(self, state: np.ndarray, rate: np.ndarray | None = None) -> Change:
        """Rates of T and a2, in a unit of the collisions' time; the state's rate is computed if not given."""
        if rate is None:
            rate = self.rate(state)
        return self.moment_change(state, rate)

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
        """2ε/T, in a unit of the collisions' time; ``temperature`` is T."""
        return float(2.0 * self._epsilon / temperature)

    def stable_step(
        self, scheme: str, state: np.ndarray, density: float, dilation_rate: float
    ) -> float:
        """Largest step that is certain to be stable; the dilation rate is 0 here."""
        grid, scene = self.form.grid, self._scene
        frequency = largest_frequency(scene.kernel, scene.dim, grid.R, density)
        return stability_limit(scheme, grid, diffusion=self._epsilon, collision_frequency=frequency)

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) state over the terms."""
        return self.form.laplacian_functions(x, terms)

    def density(self, state: np.ndarray) -> np.ndarray:
        """f at the nodes."""
        return self.form.density(state)

    def record(self, values: dict[str, Any], state: np.ndarray) -> dict[str, Any]:
        """Moments of f from ``values``, the moments of the stored density: the same."""
        return values

    def relative_size(self, change: np.ndarray, state: np.ndarray) -> float:
        """Size of a change of the density, see `granstudy.evolution.unknowns.relative_change`."""
        return relative_change(self.form, change, state)

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The state with the symmetry restored that round-off disturbs."""
        return self.form.symmetrise(state)
