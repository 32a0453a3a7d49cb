"""The accounts of a run's errors, by source, through all its grids."""

import numpy as np

from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import LARGEST, STEPS_COUNT, Balance, Settled, settled

SOURCES = ("grid", "steps", "changes")
"""Sources of errors: the discrete equation, its steps, and changes of the grid."""


class Ledger:
    """Estimated errors of T (relative) and a2 by source (docs/method.md §10).

    All are errors of the gas, not of a grid: they go on where a run changes its grid.

    Attributes
    ----------
    balance : Balance or None
        Rates of the last balance.
    """

    def __init__(self) -> None:
        self.balance: Balance | None = None
        self._clock = self._balanced_at = 0.0
        self._grid = Settled(0.0, 0.0, 0.0)
        self._linear = {"steps": Change(0.0, 0.0), "changes": Change(0.0, 0.0)}
        self._made = Change(0.0, 0.0)
        self._made_from = 0.0

    def step(self, clock: float, error: Change) -> None:
        """Count the error of a step that led to a collisions' time."""
        elapsed, self._clock = clock - self._clock, clock
        if self.balance is not None:
            for source, now in self._linear.items():
                self._linear[source] = self._faded(now, elapsed)
        made = Change(STEPS_COUNT * abs(error.temperature), STEPS_COUNT * abs(error.a2))
        self._linear["steps"] = self._linear["steps"].plus(made)
        self._made = self._made.plus(made)

    def weigh(self, balance: Balance) -> None:
        """Take the rates of a balance, and settle what the grid's errors have grown to."""
        elapsed = self._clock - self._balanced_at
        self._grid = settled(self._grid, self.balance or balance, balance, elapsed)
        self.balance, self._balanced_at = balance, self._clock

    def restart(self, balance: Balance, change: Change) -> None:
        """Go on from a balance on another grid; the change of grid made an error."""
        self.balance, self._balanced_at = balance, self._clock
        self._linear["changes"] = self._linear["changes"].plus(change)

    def step_rate(self) -> Change:
        """Errors that steps made in a unit of the collisions' time, since this was last asked."""
        elapsed = max(self._clock - self._made_from, 1e-300)
        rate = self._made.scaled(1.0 / elapsed)
        self._made, self._made_from = Change(0.0, 0.0), self._clock
        return rate

    @property
    def clock(self) -> float:
        """The collisions' time."""
        return self._clock

    @property
    def since_balance(self) -> float:
        """Collisions' time since the last balance."""
        return self._clock - self._balanced_at

    @property
    def by_grid(self) -> Change:
        """Errors by the grid up to the last balance."""
        return Change(self._grid.temperature, self._grid.a2)

    def estimates(self) -> dict[str, Change]:
        """Errors by source at the present time, which must be that of a balance."""
        grid = Change(min(self._grid.temperature, LARGEST), min(self._grid.a2, LARGEST))
        return {"grid": grid, **self._linear}

    def total(self) -> Change:
        """Errors by all sources together."""
        errors = self.estimates().values()
        return Change(
            min(sum(error.temperature for error in errors), LARGEST),
            min(sum(error.a2 for error in errors), LARGEST),
        )

    def _faded(self, error: Change, elapsed: float) -> Change:
        balance = self.balance
        assert balance is not None
        return Change(
            float(
                error.temperature * np.exp(-elapsed * balance.forgetting)
                + balance.shape * min(error.a2, LARGEST) * elapsed
            ),
            float(error.a2 * np.exp(-elapsed * balance.relaxing)),
        )
