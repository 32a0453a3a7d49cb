"""The equation on rescaled velocities, which shrink and move with the gas (docs/method.md §5)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from granstudy.evolution.frames.physical import physical_moments
from granstudy.evolution.stability import largest_frequency, stability_limit
from granstudy.evolution.unknowns import Representation, relative_change
from granstudy.model.restitution import Restitution, ScaledRestitution
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.model.stated_moments import StatedMoments
from granstudy.trust.changes import Change, change_of_moments
from granstudy.velocity.space import Term

ScaledCollisions = Callable[[np.ndarray, float], np.ndarray]
"""(g, θ) ↦ Q(g,g) of particles whose restitution is e(θ|g·ω|)."""


class Place(NamedTuple):
    """Where the frame is: the part of a state beside g."""

    log_scale: float
    """log θ."""
    collision_time: float
    """τ = ∫θ^λ dt."""
    velocity: np.ndarray
    """Bulk velocity u_f of f; the velocity of the frame is u = u_f − θu_g."""


class RescaledFrame:
    """The equation for g, f(t,v) = θ^{−d} g(t,c), on rescaled velocities c = (v − u)/θ.

        ∂t g = θ^λ Q(g,g) + εθ^{−2} Δg + (θ'/θ) ∇c·(c g) + (u'/θ)·∇g

    θ and u follow the temperature and the momentum of the first two terms (`balance`), so that g keeps its
    temperature T_g and its bulk velocity u_g. Discretely, the motions ∇c·(c g) and ∇g get the factors that
    keep the sums T_g and u_g exactly (`keeping`); the value of g at the grid's border makes them differ from
    θ'/θ and u'/θ. Where mass and momentum are conserved, u' = 0. A drift of momentum moves the frame: while
    velocities shrink, it would throw the gas out of a frame that stands still.

    A state is one array: g (or ĝ), then log θ, τ, and the bulk velocity u_f = u + θu_g of f. On a radial grid
    there is no u_f.

    Parameters
    ----------
    form : Representation
        Kind of the states of g.
    collisions : callable
        (state of g, θ) ↦ Q.
    scene : Scene
        Heating ε, kernel and restitution.
    velocity : ndarray, shape (d,)
        u at the start.
    """

    def __init__(
        self,
        form: Representation,
        collisions: ScaledCollisions,
        scene: Scene,
        velocity: np.ndarray,
    ) -> None:
        self.form = form
        self._collisions = collisions
        self._scene = scene
        self._epsilon = scene.diffusion
        self._exponent = scene.kernel.exponent
        self._velocity = velocity
        self._laplacian = form.diffusion(1.0)
        invariants = form.grid.invariants()
        self._shape = form.grid.shape
        self._nodes = int(np.prod(self._shape))
        self._dim = form.grid.dim
        self._moving = len(invariants["momentum"]) > 0
        phi = np.concatenate(list(invariants.values())) * form.grid.measure
        self._moments = phi.reshape(len(phi), -1)

    def start(self, f: np.ndarray, place: Place | None = None) -> np.ndarray:
        """The state of a density g = f; the frame at a ``place``, or where f is initial, at θ = 1."""
        if place is not None:
            return self._join(self.form.state(f), *place)
        m = self.form.grid.velocity_moments(f)
        bulk = self._velocity + m.momentum / m.density
        return self._join(self.form.state(f), 0.0, 0.0, bulk)

    def place(self, state: np.ndarray) -> Place:
        """Where the frame is."""
        return self._split(state)[1]

    def rate(self, state: np.ndarray, taken_off: float = 0.0) -> np.ndarray:
        """The rate of change of a state, less ``taken_off`` Δg."""
        g, place = self._split(state)
        theta = np.exp(place.log_scale)
        rate = theta**self._exponent * self._collisions(g, theta)
        heating = self._epsilon * theta**-2
        laplacian = self._laplacian(g) if self._epsilon else np.zeros_like(g)
        motions = self._motions(g)
        M = self._moments_of(g, rate + heating * laplacian, *motions)
        shrinking, drift = balance(M[:, 0], M[:, 1], self._dim)
        speeds = keeping(M[:, 0], M[:, 1], M[:, 2:])
        rate = rate + (heating - taken_off) * laplacian
        for speed, motion in zip(speeds, motions, strict=True):
            rate = rate + speed * motion
        return self._join(rate, shrinking, theta**self._exponent, theta * drift)

    def _motions(self, g: np.ndarray) -> list[np.ndarray]:
        """∇c·(c g) and ∇g; mass that leaves the grid with them comes back in the shape of g."""
        motions = [self.form.dilation(g), *self.form.gradient(g)]
        mass, *lost = self._moments_of(g, *motions)[0]
        return [motion - m / mass * g for motion, m in zip(motions, lost, strict=True)]

    def _moments_of(self, *states: np.ndarray) -> np.ndarray:
        """Moments M_0, M_i and M_E (rows) of each of the states of g (columns)."""
        return self._moments @ np.array([self.form.density(a).ravel() for a in states]).T

    def moment_change(self, state: np.ndarray, change: np.ndarray) -> Change:
        """Change of T = θ²T_g and a2 by a small change of the state."""
        scaling = 2.0 * float(change[self._nodes].real)
        return change_of_moments(self.form.grid, self.density(state), self.density(change), scaling)

    def moment_rates(self, state: np.ndarray) -> Change:
        """Rates of T and a2, in a unit of the collisions' time."""
        return self.moment_change(state, self.rate(state)).scaled(
            self.scale(state) ** -self._exponent
        )

    def clock(self, state: np.ndarray, time: float) -> float:
        """The collisions' time: τ."""
        return self._split(state)[1].collision_time

    def diffusivity(self, state: np.ndarray) -> float:
        """εθ^{−2}."""
        return float(self._epsilon * np.exp(-2 * self._split(state)[1].log_scale))

    def scale(self, state: np.ndarray) -> float:
        """The scale θ of the velocities."""
        return float(np.exp(self._split(state)[1].log_scale))

    def restitution(self, state: np.ndarray) -> Restitution:
        """Restitution in the velocities that the grid stores: a law e(|g·ω|) becomes e(θ|g·ω|)."""
        law = self._scene.restitution
        return ScaledRestitution(law, self.scale(state)) if callable(law) else law

    def heating(self, state: np.ndarray, temperature: float) -> float:
        """2ε/T, in a unit of the collisions' time; T = θ²T_g, and ``temperature`` is T_g."""
        scaled = temperature * self.scale(state) ** self._exponent
        return float(2.0 * self.diffusivity(state) / scaled)

    def stable_step(
        self, scheme: str, state: np.ndarray, density: float, dilation_rate: float
    ) -> float:
        """Largest step that is certain to be stable; ``dilation_rate`` is θ'/θ."""
        grid, scene = self.form.grid, self._scene
        frequency = largest_frequency(scene.kernel, scene.dim, grid.R, density)
        return stability_limit(
            scheme,
            grid,
            diffusion=self.diffusivity(state),
            collision_frequency=self.scale(state) ** self._exponent * frequency,
            dilation_rate=dilation_rate,
        )

    def laplacian_functions(self, x: float, terms: Sequence[Term]) -> np.ndarray:
        """Σ φ(xΔ) state over the terms; θ, τ and u_f do not diffuse."""
        nodes = self._nodes
        inner = [(phi, state[:nodes].reshape(self._shape)) for phi, state in terms]
        g = self.form.laplacian_functions(x, inner)
        rest = sum(phi(np.zeros(1)) * state[nodes:] for phi, state in terms)
        return np.concatenate([g.ravel(), rest])

    def density(self, state: np.ndarray) -> np.ndarray:
        """g at the nodes c."""
        return self.form.density(self._split(state)[0])

    def record(self, values: dict[str, Any], state: np.ndarray) -> dict[str, Any]:
        """Moments of f from ``values``, the moments of g; and where the frame is."""
        _, place = self._split(state)
        theta = self.scale(state)
        return physical_moments(values, theta, place.velocity) | {
            "velocity_scale": theta,
            "frame_velocity": place.velocity - theta * values["velocity"],
            "collision_time": place.collision_time,
        }

    def relative_size(self, change: np.ndarray, state: np.ndarray) -> float:
        """Largest of three changes: of g (`relative_change`), of log θ, and of u_f over θ."""
        size = relative_change(self.form, self._split(change)[0], self._split(state)[0])
        moved = np.abs(change[self._nodes + 2 :]) * np.exp(-self._split(state)[1].log_scale)
        return float(max(size, np.abs(change[self._nodes]), *moved))

    def symmetrise(self, state: np.ndarray) -> np.ndarray:
        """The state with the symmetry of g restored that round-off disturbs."""
        g = self.form.symmetrise(self._split(state)[0])
        return np.concatenate([g.ravel(), state[self._nodes :]])

    def _split(self, state: np.ndarray) -> tuple[np.ndarray, Place]:
        """The state of g, and where the frame is."""
        log_scale, collision_time, *velocity = state[self._nodes :].real
        u = np.array(velocity) if self._moving else self._velocity
        place = Place(float(log_scale), float(collision_time), u)
        return state[: self._nodes].reshape(self._shape), place

    def _join(
        self, g: np.ndarray, log_scale: float, collision_time: float, velocity: np.ndarray
    ) -> np.ndarray:
        """One array of a state of g and where the frame is."""
        rest = [log_scale, collision_time, *(velocity if self._moving else ())]
        return np.concatenate([g.ravel(), rest])


def balance(M: np.ndarray, change: np.ndarray, dim: int) -> tuple[float, np.ndarray]:
    """T'/(2T) and u_g' of a density, from its moments and their rates.

    With e = M_E/M_0 and dT = 2e − |u_g|². T'/(2T) is θ'/θ of docs/method.md §5, at any ρ.

    Parameters
    ----------
    M, change : ndarray, shape (d + 2,) or (2,)
        Moments (M_0, M_i, M_E) and their rates; without M_i on a radial grid.
    dim : int
        Velocity dimension d.
    """
    u, e = M[1:-1] / M[0], M[-1] / M[0]
    u_rate = (change[1:-1] - u * change[0]) / M[0]
    e_rate = (change[-1] - e * change[0]) / M[0]
    temperature = (2 * e - u @ u) / dim
    return float((e_rate - u @ u_rate) / (dim * temperature)), u_rate


def keeping(M: np.ndarray, change: np.ndarray, motions: np.ndarray) -> np.ndarray:
    """Speeds s of the motions that keep M_i/M_0 and M_E/M_0, where M' = ``change`` + ``motions`` s."""
    rates = np.column_stack([change, motions])
    A = rates[1:] - np.outer(M[1:] / M[0], rates[0])
    return np.linalg.solve(A[:, 1:], -A[:, 0])


@dataclass(frozen=True)
class Centred:
    """An initial density as seen from the velocity u = ``centre``: g(c) = f(u + c)."""

    initial: Callable[..., np.ndarray]
    centre: tuple[float, ...]

    @property
    def moments(self) -> StatedMoments | None:
        """Moments of g, where the density states those of f."""
        stated: StatedMoments | None = getattr(self.initial, "moments", None)
        if stated is None:
            return None
        return replace(stated, velocity=stated.velocity - np.array(self.centre))

    def __call__(self, *c: np.ndarray) -> np.ndarray:
        """Density at the velocities c."""
        return self.initial(*(ci + ui for ci, ui in zip(c, self.centre, strict=True)))


def centred(scene: Scene, solver: SizedSolver) -> tuple[Scene, np.ndarray]:
    """The scene as seen from its bulk velocity u on the solver's grid; and u, shape (d,)."""
    grid = solver.grid(scene.dim)
    m = grid.velocity_moments(scene.density(grid))
    u = m.momentum / m.density
    thermal = np.sqrt(max(np.trace(m.pressure), 0.0) / (scene.dim * m.density))
    # Round-off counts as 0, so that symmetric densities keep their digits.
    u = np.where(np.abs(u) > 1e-10 * thermal, u, 0.0)
    if not u.any():
        return scene, u
    initial = Centred(scene.initial, tuple(map(float, u)))
    return replace(scene, initial=initial), u
