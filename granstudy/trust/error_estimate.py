"""The errors of T and a2, estimated while a run goes on (docs/method.md §10)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from granstudy import theory
from granstudy.model.restitution import Restitution
from granstudy.model.scene import Scene
from granstudy.trust import health
from granstudy.trust.balance_times import balance_times
from granstudy.trust.changes import Change, counted
from granstudy.trust.initial_errors import StartMoments, errors_of, true_start
from granstudy.trust.pair_rates import CollisionRates, RatesAt
from granstudy.velocity.space import VelocitySpace

RELAXATION = 0.5
"""Rate at which an error of a2 is taken to relax, in parts of the rate of linear theory."""


LAW_EXPONENT = 1.0
"""What a law of restitution adds to λ where the shape changes the rate of cooling: 1 − e² is taken to grow
like the speed at most. That of viscoelastic particles grows like its fifth root."""

LARGEST = 1.0
"""Largest error that is estimated, and that counts for other errors: beyond it the gas is lost."""


class Imbalance(NamedTuple):
    """How far the discrete rates of one density are from the exact ones.

    All are relative rates in a unit of the collisions' time.

    Attributes
    ----------
    temperature : float
        T'/T by the discrete equation, less T'/T by all pairs and by the exact heating.
    a2 : float
        a2'/(1 + a2) by the discrete equation, less the exact one.
    cooling : float
        T'/T by all pairs, without heating.
    frequency : float
        Collisions of a particle.
    shaping : float
        a2'/(1 + a2) by all pairs and by the exact heating.
    """

    temperature: float
    a2: float
    cooling: float
    frequency: float
    shaping: float


def imbalance(
    rates: CollisionRates, f: np.ndarray, found: Change, heating: float = 0.0
) -> Imbalance:
    """Rates of T and a2 by the discrete equation against the exact rates (docs/method.md §10).

    Parameters
    ----------
    rates : CollisionRates
        The sums over all pairs, on the grid of f.
    f : ndarray, shape rates.grid.shape
    found : Change
        Rates of T and a2 by the discrete equation: collisions, and where it has them, diffusion and the
        motion of the frame.
    heating : float
        2ε/T, T the temperature of f, for the diffusion that ``found`` includes.
    """
    grid = rates.grid
    exact = rates(f)
    m = grid.velocity_moments(f)
    second = float(np.trace(m.pressure))
    cooling = 2.0 * exact.energy / second
    # ∫|v−u|⁴ f = d(d+2)ρT²(1 + a2); diffusion adds 4(d+2)dερT to its rate
    gaussian = (grid.dim + 2) / grid.dim * second**2 / m.density
    fourth = exact.fourth / m.fourth + 2.0 * heating * gaussian / m.fourth
    shaping = float(fourth - 2.0 * (cooling + heating))
    return Imbalance(
        temperature=float(found.temperature - cooling - heating),
        a2=found.a2 - shaping,
        cooling=float(cooling),
        frequency=exact.frequency,
        shaping=shaping,
    )


class Balance(NamedTuple):
    """Rates at which errors grow, and at which they are forgotten, at one time.

    ``other`` is the growth of errors of the shape that a2 does not tell. ``shape`` and ``cooling`` are the
    rates of T for an error of a2, and for another one.
    """

    temperature: float
    a2: float
    other: float
    shape: float
    cooling: float
    forgetting: float
    relaxing: float

    def temperature_growth(self, a2: float, other: float) -> float:
        """Growth of the error of T, with errors of the shape."""
        shape = self.shape * min(a2, LARGEST) + self.cooling * min(other, LARGEST)
        return self.temperature + shape


class Settled(NamedTuple):
    """Errors that imbalance has brought: of T relative to T, of a2, and of the shape beside a2."""

    temperature: float
    a2: float
    other: float


NOTHING = Change(0.0, 0.0)
"""No error."""


class Memory(NamedTuple):
    """What an examination remembers of a run beside its outputs, all that its estimates to come depend on.

    ``first`` are the moments of the first output. ``clock`` is the collisions' time now, ``balanced_at`` that
    of the last ``balance``. ``settled`` are the errors at that time by imbalance, ``stepped`` those by steps.
    ``passed`` are the times of balances that have passed. ``open`` has a row for each output since then: its
    clock, and the errors of T and a2 that its steps and its interpolation have made.
    """

    first: health.Moments
    clock: float
    balanced_at: float
    balance: Balance | None
    settled: Settled
    stepped: Change
    passed: int
    open: np.ndarray


class Examination:
    """Examines one run, step by step: signs of health, and estimated errors of T and a2.

    Each error has two parts, which grow and are forgotten alike: what the imbalance of the discrete rates has
    brought, and what the steps have.

    Parameters
    ----------
    scene : Scene
        The gas in the velocities of the grid at the start.
    grid : VelocitySpace
    times : ndarray
        Times of the outputs that the run will have.
    rates : RatesAt
        Exact rates of the scene's collisions on the grid.

    Attributes
    ----------
    outputs : list of dict
        What was measured at every output, by the names of `granstudy.trust.health.SIGNS`.
    """

    def __init__(
        self, scene: Scene, grid: VelocitySpace, times: np.ndarray, rates: RatesAt
    ) -> None:
        self._scene, self._grid, self._rates = scene, grid, rates
        self._true = true_start(scene, grid)
        self._due, self._passed = balance_times(times), 0
        self._first: health.Moments = {}
        self._clock = self._balanced_at = 0.0
        self._balance: Balance | None = None
        self._settled = Settled(0.0, 0.0, 0.0)
        self._stepped = Change(0.0, 0.0)
        self._open: list[tuple[float, Change]] = []
        self.outputs: list[dict[str, float]] = []

    @property
    def memory(self) -> Memory:
        """What the estimates to come depend on, beside the outputs."""
        return Memory(
            self._first,
            self._clock,
            self._balanced_at,
            self._balance,
            self._settled,
            self._stepped,
            self._passed,
            np.array([(clock, *made) for clock, made in self._open]).reshape(-1, 3),
        )

    def resume(self, memory: Memory, outputs: Sequence[dict[str, float]]) -> None:
        """Go on from a memory, and from the outputs until then."""
        self._first, self._clock, self._balanced_at, self._balance = memory[:4]
        self._settled, self._stepped, self._passed = memory[4:7]
        self._open = [(clock, Change(*made)) for clock, *made in memory.open.tolist()]
        self.outputs[:] = outputs

    def step(self, clock: float, error: Change) -> None:
        """Count the error of a step that led to a time.

        Parameters
        ----------
        clock : float
            The collisions' time: t, in a rescaled frame τ.
        error : Change
            Estimated errors of T and a2 that the step made.
        """
        if self._balance is None:
            return
        elapsed, self._clock = clock - self._clock, clock
        self._stepped = faded(self._stepped, self._balance, elapsed).plus(counted(error))

    def look(
        self, f: np.ndarray, values: health.Moments, passing: Change = NOTHING
    ) -> dict[str, str]:
        """Examine an output; returns its warnings, by the names of `granstudy.trust.health.SIGNS`.

        Its errors by imbalance are those by the rates of the last balance, until the next one is there.

        Parameters
        ----------
        f : ndarray, shape grid.shape
            The density that the grid stores: f, in a rescaled frame g.
        values : mapping
            Moments of that density.
        passing : Change
            Errors of T and a2 that this output has, and what follows has not: those of interpolation.
        """
        if not self.outputs:
            self._first = values
            start = StartMoments(*(float(values[name]) for name in StartMoments._fields))
            off = errors_of(start, self._true)
            self._settled = Settled(off.temperature, off.a2, 0.0)
        made = self._stepped.plus(counted(passing))
        output = health.state_of_health(f, values, self._first, self._grid)
        output |= _total(self._grown(self._balance), made)
        self.outputs.append(output)
        if self._clock > self._balanced_at:
            self._open.append((self._clock, made))
        return health.warnings(output)

    def is_due(self, time: float) -> bool:
        """Whether a balance is due at the end of a step that led to a time."""
        before, self._passed = self._passed, int(np.searchsorted(self._due, time, "right"))
        return self._passed > before

    def balance(
        self,
        f: np.ndarray,
        values: health.Moments,
        found: Change,
        removed: float,
        *,
        restitution: Restitution,
        heating: float,
    ) -> None:
        """Take the balance of a density, and settle the errors up to it.

        Parameters
        ----------
        f : ndarray, shape grid.shape
            As of `look`.
        values : mapping
            Moments of that density.
        found : Change
            Rates of T and a2 by the discrete equation, in a unit of the collisions' time.
        removed : float
            Rate of energy that was taken from Q so that it has the exact one.
        restitution : float or callable
            Restitution in the velocities that the grid stores.
        heating : float
            2ε/T in a unit of the collisions' time.
        """
        now = imbalance(self._rates(restitution), f, found, heating)
        removed /= self._grid.dim / 2 * values["density"] * values["temperature"]
        self._weigh(now, removed, float(values["density"]), restitution, heating)

    def _weigh(
        self,
        now: Imbalance,
        removed: float,
        density: float,
        restitution: Restitution,
        heating: float,
    ) -> None:
        """Take the rates of a balance, and settle what errors have grown to since the balance before."""
        mass_error = abs(density / self._true.density - 1.0)
        exponent, dim = self._scene.kernel.exponent, self._grid.dim
        balance = balance_of(now, removed, mass_error, restitution, dim, exponent, heating)
        self._close(balance)
        self._settled = self._grown(balance)
        self._balance, self._balanced_at = balance, self._clock

    def _close(self, balance: Balance) -> None:
        """Give the outputs since the last balance their errors, with rates that go evenly to this one's."""
        if not self._open:
            return
        before = self._balance or balance
        elapsed = self._clock - self._balanced_at
        for output, (clock, made) in zip(self.outputs[-len(self._open) :], self._open, strict=True):
            passed = clock - self._balanced_at
            pairs = zip(before, balance, strict=True)
            now = Balance(*(a + passed / elapsed * (b - a) for a, b in pairs))
            output.update(_total(settled(self._settled, before, now, passed), made))
        self._open.clear()

    def _grown(self, now: Balance | None) -> Settled:
        """Errors by imbalance at the present time, with rates that go evenly to those of ``now``."""
        if now is None:
            return self._settled
        return settled(self._settled, self._balance or now, now, self._clock - self._balanced_at)


def faded(error: Change, balance: Balance, elapsed: float) -> Change:
    """An error of before, as the gas has forgotten it; one of a2 makes one of T."""
    return Change(
        float(
            error.temperature * np.exp(-elapsed * balance.forgetting)
            + balance.shape * min(error.a2, LARGEST) * elapsed
        ),
        float(error.a2 * np.exp(-elapsed * balance.relaxing)),
    )


def _total(grown: Settled, made: Change) -> dict[str, float]:
    """Errors of T and a2 together, as signs of health."""
    return {
        "temperature": min(grown.temperature + made.temperature, LARGEST),
        "a2": min(grown.a2 + made.a2, LARGEST),
    }


def balance_of(
    now: Imbalance,
    removed: float,
    mass_error: float,
    restitution: Restitution,
    dim: int,
    exponent: float,
    heating: float,
) -> Balance:
    """Rates at which errors grow and are forgotten, from the imbalance of one density.

    A mass other than the gas's makes all collisions faster or slower by the same factor. A Q whose energy had
    to be changed is wrong elsewhere as well: its relative rate of energy, ``removed``, is taken as that of an
    error of the shape. With a law e(v), the rate of cooling depends on the shape for Maxwell molecules, too.
    """
    felt = exponent + LAW_EXPONENT if callable(restitution) else exponent
    return Balance(
        temperature=abs(now.temperature) + mass_error * abs(now.cooling),
        a2=abs(now.a2) + mass_error * abs(now.shaping),
        other=abs(removed),
        shape=abs(now.cooling) * (theory.cooling_correction(felt, 1.0) - 1.0),
        cooling=abs(now.cooling) * felt / 2,
        forgetting=heating - exponent / 2 * now.cooling,
        relaxing=2 * heating + a2_relaxation(restitution, dim, exponent) * now.frequency,
    )


def settled(start: Settled, before: Balance, now: Balance, elapsed: float) -> Settled:
    """Errors by imbalance after a time, with rates that go evenly from those of one balance to another's."""
    a2 = grown(start.a2, before.a2, now.a2, now.relaxing, elapsed)
    other = grown(start.other, before.other, now.other, now.relaxing, elapsed)
    temperature = grown(
        start.temperature,
        before.temperature_growth(start.a2, start.other),
        now.temperature_growth(a2, other),
        now.forgetting,
        elapsed,
    )
    return Settled(temperature, a2, other)


def a2_relaxation(restitution: Restitution, dim: int, exponent: float) -> float:
    """Rate at which an error of a2 is taken to relax in a cooling gas, over the collision frequency.

    A restitution law counts by its value at unit impact speed.
    """
    e = float(restitution(np.ones(1))[0]) if callable(restitution) else float(restitution)
    return RELAXATION * theory.a2_relaxation_rate(e, dim, exponent)


def grown(error: float, before: float, now: float, forgetting: float, elapsed: float) -> float:
    """y at the end of y' = −forgetting y + growth, y = ``error`` at the start.

    The growth goes linearly from ``before`` to ``now`` in the time ``elapsed``: with z = −forgetting·elapsed,
    y = e^z error + elapsed [φ_1(z) before + φ_2(z) (now − before)], φ_1 = (e^z − 1)/z, φ_2 = (φ_1 − 1)/z.
    """
    z = -forgetting * elapsed
    if abs(z) < 1e-4:
        phi1, phi2 = 1.0 + z / 2.0, 0.5 + z / 6.0
    else:
        phi1 = float(np.expm1(z)) / z
        phi2 = (phi1 - 1.0) / z
    return float(np.exp(z) * error + elapsed * (phi1 * before + phi2 * (now - before)))
