"""The accounts of a run's errors, by source, through all its grids."""

from granstudy.trust.changes import Change, counted
from granstudy.trust.error_estimate import (
    LARGEST,
    NOTHING,
    Balance,
    Settled,
    faded,
    settled,
)

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
                self._linear[source] = faded(now, self.balance, elapsed)
        made = counted(error)
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

    def estimates(self, passing: Change = NOTHING) -> dict[str, Change]:
        """Errors by source at the present time.

        ``passing`` are errors of a state inside a step, by interpolation; they count for the steps.
        """
        grid = self._grid
        if self.balance is not None:
            grid = settled(grid, self.balance, self.balance, self.since_balance)
        found = {"grid": Change(min(grid.temperature, LARGEST), min(grid.a2, LARGEST))}
        found |= self._linear
        return found | {"steps": found["steps"].plus(counted(passing))}

    def total(self, passing: Change = NOTHING) -> Change:
        """Errors by all sources together; ``passing`` as of `estimates`."""
        errors = self.estimates(passing).values()
        return Change(
            min(sum(error.temperature for error in errors), LARGEST),
            min(sum(error.a2 for error in errors), LARGEST),
        )
