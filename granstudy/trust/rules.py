"""What labels and estimates promise (docs/method.md §10): rules that a run beside a truth keeps or breaks."""

from dataclasses import dataclass

from granstudy.trust.flags import Trust
from granstudy.trust.truth import Errors

EXACTLY = Errors(0.0, 0.0)
"""How well an exact law is known."""

TRUSTED = Errors(1e-2, 1e-2)
"""Errors that no trusted run has, of T relative to T and of a2."""

SMALL = 1e-6
"""No untrusted run has both its errors below this; estimates of smaller errors are not judged."""

LOST = 0.1
"""An error above which the gas is lost: no estimate can tell how far."""

UNDER, OVER = 3.0, 100.0
"""An estimate is at most so many times below, and above, the error."""

STANDARD_ERRORS = 5.0
"""Standard errors of particles, within which their errors lie; estimates of theirs are two of them."""

RULES = ("trusted_wrong", "untrusted_right", "underestimated", "overestimated")
"""The rules, by what breaks them."""


@dataclass(frozen=True)
class Judged:
    """A run that is held against its truth.

    Attributes
    ----------
    trust : Trust
    ended : bool
        Whether the run reached its final time.
    errors : Errors
        Distances from the truth.
    estimates : Errors
        The run's own estimates of them.
    known : Errors
        How well the truth itself is known: an error is known up to these.
    by_particles : bool
        Whether the estimates are two standard errors.
    """

    trust: Trust
    ended: bool
    errors: Errors
    estimates: Errors
    known: Errors = EXACTLY
    by_particles: bool = False

    @property
    def broken(self) -> list[str]:
        """The `RULES` that the run breaks, whatever its truth is within what is known of it.

        An error that is not a number is a large one. A run that stopped is not to be trusted, whatever its
        errors up to there, and its estimates are not judged.
        """
        found = []
        if self.trust is Trust.TRUSTED and not all(self._at_most(TRUSTED)):
            found.append("trusted_wrong")
        if not self.ended:
            return found
        surely_small = (e + k < SMALL for e, k in zip(self.errors, self.known, strict=True))
        if self.trust is Trust.UNTRUSTED and all(surely_small):
            found.append("untrusted_right")
        if any(self._is_under(*one) for one in self._quantities):
            found.append("underestimated")
        if not self.by_particles and any(self._is_over(*one) for one in self._quantities):
            found.append("overestimated")
        return found

    @property
    def ratios(self) -> Errors:
        """Estimate over error of T and of a2; NaN where the error is not surely above `SMALL`."""
        return Errors(*(self._ratio(*one) for one in self._quantities))

    @property
    def _quantities(self) -> list[tuple[float, float, float]]:
        return list(zip(self.errors, self.estimates, self.known, strict=True))

    def _at_most(self, largest: Errors) -> list[bool]:
        limits = zip(self.errors, self.known, largest, strict=True)
        return [error - known <= limit for error, known, limit in limits]

    def _is_under(self, error: float, estimate: float, known: float) -> bool:
        least = error - known
        if self.by_particles:
            return least > max(SMALL, STANDARD_ERRORS / 2 * estimate)
        return least > SMALL and estimate * UNDER < min(least, LOST)

    def _is_over(self, error: float, estimate: float, known: float) -> bool:
        return error - known > SMALL and estimate > OVER * (error + known)

    def _ratio(self, error: float, estimate: float, known: float) -> float:
        if not self.ended or not error - known > SMALL or error < 2 * known:
            return float("nan")
        return estimate / min(error, LOST)
