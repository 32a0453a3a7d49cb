"""The equation on velocities that shrink and move with the gas (docs/method.md §5)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from granstudy.initial import InitialDensity
from granstudy.physical import physical_moments
from granstudy.representation import Representation, Term

ScaledCollisions = Callable[[np.ndarray, float], np.ndarray]
"""(g, θ) ↦ Q(g,g) of particles whose restitution is e(θ|g·ω|)."""


class Place(NamedTuple):
    """Where the frame is: v = u + θc."""

    log_scale: float
    """log θ"""
    collision_time: float
    """τ = ∫θ^λ dt"""
    velocity: np.ndarray
    """u"""


class RescaledFrame:
    """f(t,v) = θ^{−d} g(t,c), c = (v − u)/θ, with θ and u such that g keeps its temperature and u_g.

        ∂t g = θ^λ Q(g,g) + εθ^{−2} Δg + (θ'/θ) ∇c·(c g) + (u'/θ)·∇g

    θ'/θ and u'/θ are whatever keeps the *discrete* moments: with M_0, M_i, M_E those of 1, c_i, ½|c|²,
    M_i/M_0 and M_E/M_0 do not change, which is a linear system of d + 1 equations. Where mass and
    momentum are conserved u' = 0 and θ'/θ is that of docs/method.md §5. A drift of the momentum moves
    the frame: fixed, it would be thrown out of the grid as the velocities shrink.

    A state is one array: g (or ĝ), then log θ, τ, and u (none on a radial grid).

    Parameters
    ----------
    form : Representation
        What is advanced of g.
    collisions : callable
        (g's state, θ) ↦ Q.
    diffusion : float
        ε.
    exponent : float
        λ.
    velocity : ndarray, shape (d,)
        u at the start.
    """

    def __init__(
        self,
        form: Representation,
        collisions: ScaledCollisions,
        diffusion: float,
        exponent: float,
        velocity: np.ndarray,
    ) -> None:
        self.form = form
        self._collisions = collisions
        self._epsilon = diffusion
        self._exponent = exponent
        self._velocity = velocity
        self._laplacian = form.diffusion(1.0)
        invariants = form.grid.invariants()
        self._shape = form.grid.shape
        self._nodes = int(np.prod(self._shape))
        self._moving = len(invariants["momentum"]) > 0
        phi = np.concatenate(list(invariants.values())) * form.grid.measure
        self._moments = phi.reshape(len(phi), -1)

    def start(self, f: np.ndarray) -> np.ndarray:
        """The state of g = f at θ = 1."""
        return self._join(self.form.state(f), 0.0, 0.0, self._velocity)

    def rate(self, state: np.ndarray, taken_off: float = 0.0) -> np.ndarray:
        """The rate of change, less ``taken_off`` Δg."""
        g, place = self._split(state)
        theta = np.exp(place.log_scale)
        rate = theta**self._exponent * self._collisions(g, theta)
        heating = self._epsilon * theta**-2
        laplacian = self._laplacian(g) if self._epsilon else np.zeros_like(g)
        motions = self._motions(g)
        speeds = self._keeping(g, rate + heating * laplacian, motions)
        rate = rate + (heating - taken_off) * laplacian
        for speed, motion in zip(speeds, motions, strict=True):
            rate = rate + speed * motion
        return self._join(rate, speeds[0], theta**self._exponent, theta * speeds[1:])

    def _motions(self, g: np.ndarray) -> list[np.ndarray]:
        """∇c·(c g) and ∇g; mass that they move out of the grid comes back in the shape of g."""
        motions = [self.form.dilation(g), *self.form.gradient(g)]
        mass, *lost = self._moments_of(g, *motions)[0]
        return [motion - m / mass * g for motion, m in zip(motions, lost, strict=True)]

    def _keeping(self, g: np.ndarray, rate: np.ndarray, motions: list[np.ndarray]) -> np.ndarray:
        """θ'/θ and u'/θ: M_i/M_0 and M_E/M_0 stay as they are."""
        M = self._moments_of(g, rate, *motions)
        change = M[1:, 1:] - np.outer(M[1:, 0] / M[0, 0], M[0, 1:])
        return np.linalg.solve(change[:, 1:], -change[:, 0])

    def _moments_of(self, *states: np.ndarray) -> np.ndarray:
        """M_0, M_i and M_E (rows) of some states of g."""
        return self._moments @ np.array([self.form.density(a).ravel() for a in states]).T

    def diffusivity(self, state: np.ndarray) -> float:
        """εθ^{−2}."""
        return float(self._epsilon * np.exp(-2 * self.place(state).log_scale))

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) state over the terms; θ, τ and u do not diffuse."""
        nodes = self._nodes
        inner = [(phi, state[:nodes].reshape(self._shape)) for phi, state in terms]
        g = self.form.laplacian_functions(x, inner)
        rest = sum(phi(np.zeros(1)) * state[nodes:] for phi, state in terms)
        return np.concatenate([g.ravel(), rest])

    def density(self, state: np.ndarray) -> np.ndarray:
        """G at the nodes c."""
        return self.form.density(self._split(state)[0])

    def record(self, values: dict[str, Any], state: np.ndarray) -> dict[str, Any]:
        """Moments of f from those of g, and where the frame is."""
        place = self.place(state)
        theta = float(np.exp(place.log_scale))
        return physical_moments(values, theta, place.velocity) | {
            "velocity_scale": theta,
            "frame_velocity": place.velocity,
            "collision_time": place.collision_time,
        }

    def relative_size(self, change: np.ndarray, state: np.ndarray) -> float:
        """Largest of the changes of g over its largest value, of log θ, and of u over θ."""
        g, _ = self._split(change)
        largest = np.max(np.abs(g)) / np.max(np.abs(self._split(state)[0]))
        moved = np.abs(change[self._nodes + 2 :]) * np.exp(-self.place(state).log_scale)
        return float(max(largest, np.abs(change[self._nodes]), *moved))

    def place(self, state: np.ndarray) -> Place:
        """Where the frame is in a state."""
        return self._split(state)[1]

    def _split(self, state: np.ndarray) -> tuple[np.ndarray, Place]:
        log_scale, collision_time, *velocity = state[self._nodes :].real
        u = np.array(velocity) if self._moving else self._velocity
        place = Place(float(log_scale), float(collision_time), u)
        return state[: self._nodes].reshape(self._shape), place

    def _join(
        self, g: np.ndarray, log_scale: float, collision_time: float, velocity: np.ndarray
    ) -> np.ndarray:
        rest = [log_scale, collision_time, *(velocity if self._moving else ())]
        return np.concatenate([g.ravel(), rest])


@dataclass(frozen=True)
class Centred:
    """An initial density seen from the velocity ``centre``: g(c) = f(u + c)."""

    initial: InitialDensity
    centre: tuple[float, ...]

    def __call__(self, *c: np.ndarray) -> np.ndarray:
        """Density at the velocities c."""
        return self.initial(*(ci + ui for ci, ui in zip(c, self.centre, strict=True)))
