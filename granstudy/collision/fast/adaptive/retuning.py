"""Checks during a run that a quadrature chosen for the initial density still meets the tolerance."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from granstudy.collision.fast.adaptive.plan import QuadraturePlan, TunedOperator
from granstudy.collision.protocol import CollisionOperator
from granstudy.support.errors import ToleranceError

CHECK_EVERY = 50
"""Steps between checks. A check takes about as long as a step of the Runge–Kutta scheme."""

FIRST_CHECK = 10
"""Step of the first check, as densities change fastest at the start."""

EASED = 0.1
"""Error, in parts of the tolerance, below which a quadrature is finer than it need be."""


class Tuning:
    """The quadratures of one run.

    Attributes
    ----------
    plans : list of dict
        Every plan as plain data, with the ``time`` from which it is used. Empty for an operator without a
        tolerance.
    """

    def __init__(self, operator: CollisionOperator) -> None:
        self._operator = operator if isinstance(operator, TunedOperator) else None
        self.plans: list[dict[str, Any]] = []
        self._record(0.0)

    def resume(self, plans: Sequence[dict[str, Any]]) -> None:
        """Go on with the last of these plans, which were in use until now."""
        if self._operator is None:
            return
        last = QuadraturePlan.of(plans[-1])
        if last != self._operator.plan:
            self._operator.use(last)
        self.plans[:] = plans

    def review(self, step: int, time: float, f: np.ndarray) -> dict[str, str]:
        """Check the quadrature at `FIRST_CHECK` and every `CHECK_EVERY` steps, and tune it anew where needed.

        Returns
        -------
        dict
            Warnings by name: ``rtol`` where the tolerance can no longer be reached.
        """
        operator = self._operator
        due = step == FIRST_CHECK or (step > 0 and step % CHECK_EVERY == 0)
        if operator is None or not due:
            return {}
        error, rtol = operator.check(f), operator.plan.rtol
        if EASED * rtol <= error <= rtol:
            return {}
        try:
            operator.tune(f)
        except ToleranceError as reason:
            if error <= rtol:
                return {}
            return {"rtol": f"the quadrature error of Q is {error:.1e}: {reason}"}
        self._record(time)
        return {}

    def _record(self, time: float) -> None:
        if self._operator is not None:
            self.plans.append({"time": time, **self._operator.plan.describe()})
