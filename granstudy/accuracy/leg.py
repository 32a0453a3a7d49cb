"""One leg of a run: what is computed with, from a moment on, until it is chosen anew."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from granstudy.accuracy.budget import Allowed
from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.collision.fast.adaptive.plan import QuadraturePlan
from granstudy.collision.operator import collision_operator
from granstudy.collision.protocol import CollisionOperator
from granstudy.evolution.conservation import Projection
from granstudy.evolution.frames.closed import (
    ClosedFixedFrame,
    ClosedRescaledFrame,
    is_closed,
)
from granstudy.evolution.frames.fixed import FixedFrame
from granstudy.evolution.frames.rescaled import Place, RescaledFrame
from granstudy.evolution.unknowns import collisions, representation
from granstudy.model.densities import Maxwellian
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import Balance, balance_of, imbalance
from granstudy.trust.pair_rates import RatesAt
from granstudy.velocity.moments import moment_values
from granstudy.velocity.space import VelocitySpace

CONSERVED = ("mass", "momentum", "energy")
"""What Q balances exactly: T then goes wrong only as far as the shape does."""

Frame = FixedFrame | RescaledFrame


@dataclass(frozen=True)
class Gas:
    """What stays while a run changes its grid.

    Attributes
    ----------
    scene : Scene
        The gas as seen from its bulk velocity at the start.
    velocity : ndarray, shape (d,)
        That bulk velocity.
    density : float
        The true mass.
    rescaled : bool
        Whether velocities are rescaled with the gas.
    threads : int, optional
        Threads; results do not depend on their number.
    """

    scene: Scene
    velocity: np.ndarray
    density: float
    rescaled: bool
    threads: int | None = None

    def stand_in(self) -> Scene:
        """The scene with a Maxwellian in place of the initial density: what an operator is made for."""
        return replace(self.scene, initial=Maxwellian(self.scene.dim), symmetry=self.scene.symmetry)


@dataclass(frozen=True)
class Leg:
    """Operator, exact rates and frame on one grid."""

    gas: Gas
    solver: SizedSolver
    operator: CollisionOperator
    rates: RatesAt
    project: Projection
    frame: Frame

    @property
    def grid(self) -> VelocitySpace:
        """The grid."""
        return self.operator.grid

    @property
    def closed(self) -> bool:
        """Whether T and a2 have their exact rates on any grid."""
        return isinstance(self.frame, ClosedFixedFrame | ClosedRescaledFrame)

    def start(self, f: np.ndarray, place: Place) -> np.ndarray:
        """The state of a density on the leg's grid, with the frame at a place."""
        if isinstance(self.frame, RescaledFrame):
            return self.frame.start(f, place)
        return self.frame.start(f)

    def place(self, state: np.ndarray, time: float) -> Place:
        """Where the frame is."""
        if isinstance(self.frame, RescaledFrame):
            return self.frame.place(state)
        return Place(0.0, time, self.gas.velocity)

    def balance(self, state: np.ndarray, rate: np.ndarray | None = None) -> Balance:
        """Growth and forgetting of errors at a state; its rate of change is computed where not given.

        A rate that is given must be that of the last evaluation.
        """
        frame, scene = self.frame, self.gas.scene
        exponent = scene.kernel.exponent
        if rate is None:
            rate = frame.rate(state)
        f = frame.density(state)
        values = moment_values(f, self.grid)
        found = frame.moment_change(state, rate).scaled(frame.scale(state) ** -exponent)
        density, T = float(values["density"]), float(values["temperature"])
        removed = self.project.energy_removed / (scene.dim / 2 * density * T)
        heating = frame.heating(state, T)
        restitution = frame.restitution(state)
        now = imbalance(self.rates(restitution), f, found, heating)
        mass_error = abs(density / self.gas.density - 1.0)
        return balance_of(now, removed, mass_error, restitution, scene.dim, exponent, heating)


@dataclass(frozen=True)
class Need:
    """What a grid must do.

    Attributes
    ----------
    allowed : Allowed
        How fast errors may grow.
    most : Change
        Errors of T and a2 that the grid's sums may make of a density.
    """

    allowed: Allowed
    most: Change

    def ratio(self, balance: Balance, lost: Change) -> float:
        """Errors over what is allowed: their growth, and what the grid's sums lose of the density."""
        return max(self.allowed.ratio(balance), self.lost_ratio(lost))

    def lost_ratio(self, lost: Change) -> float:
        """What the grid's sums lose of the density, over what is allowed."""
        return max(lost.temperature / self.most.temperature, lost.a2 / self.most.a2)


class Tried(NamedTuple):
    """A grid that was tried: its leg, the density on it, its balance, and errors over what is allowed."""

    leg: Leg
    f: np.ndarray
    ratio: float
    balance: Balance


def make_leg(
    gas: Gas,
    solver: Solver,
    plan: Callable[[Scene], QuadraturePlan] | None = None,
) -> Leg:
    """A leg with a solver.

    Parameters
    ----------
    gas : Gas
    solver : Solver
        Of method `radial`, or `fast` with a tolerance.
    plan : callable, optional
        Scene ↦ the quadrature of `fast`.

    Raises
    ------
    ValueError
        As `granstudy.collision_operator`.
    """
    scene, sized = gas.stand_in(), solver.sized()
    operator: CollisionOperator
    if plan is None:
        operator = collision_operator(scene, sized)
    else:
        operator = AdaptiveOperator(scene, sized, plan=plan(scene))
    form = representation(operator, scene.symmetry)
    rates = RatesAt(scene, operator.grid)
    exact = rates(scene.restitution).energy if scene.restitution != 1.0 else _nothing
    project = Projection(form, CONSERVED, exact)
    Q = collisions(operator)
    frame: Frame
    closed = sized.method == "radial" and is_closed(scene)

    def exact_rates(f: np.ndarray, heating: float) -> Change:
        now = imbalance(rates(scene.restitution), f, Change(0.0, 0.0), heating)
        return Change(now.cooling + heating, now.shaping)

    if gas.rescaled:
        equation = form, lambda g, scale: project(g, Q(g)), scene, gas.velocity
        frame = (
            ClosedRescaledFrame(*equation, exact=exact_rates)
            if closed
            else RescaledFrame(*equation)
        )
    else:
        fixed = form, lambda f: project(f, Q(f)), scene
        frame = ClosedFixedFrame(*fixed, exact=exact_rates) if closed else FixedFrame(*fixed)
    return Leg(gas, sized, operator, rates, project, frame)


def _nothing(f: np.ndarray) -> float:
    """E' of the energy at e = 1."""
    return 0.0
