"""Newton's method with an exact derivative; its steps are solved for by elimination or by GMRES."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
import scipy

from granstudy.support.progress import Report

DENSE = 256
"""Largest number of unknowns with a derivative written out as a matrix; radial grids have fewer."""

FORCING = 1e-2
"""Part of the residual that GMRES leaves. A step so gains two digits; the next step would not use more."""

KRYLOV = 80
"""Vectors of GMRES before a restart."""

RESTARTS = 4
"""Largest number of restarts of GMRES. A step that needs more is a poor one; the residual shows it."""


class Equations(Protocol):
    """F(x) = 0."""

    def residual(self, x: np.ndarray) -> np.ndarray:
        """F(x), as long as x."""

    def derivative(self, x: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """h ↦ F'(x) h."""

    def size(self, residual: np.ndarray, x: np.ndarray) -> float:
        """Size of F(x) relative to its terms, 0 for a solution."""


class Solution(NamedTuple):
    """The end of Newton's method."""

    x: np.ndarray
    """The last iterate with a finite residual."""
    sizes: list[float]
    """Size of the residual at the start and after every step."""
    reason: str
    """Why x is no solution; "" where it is one."""


def newton(
    equations: Equations,
    x: np.ndarray,
    tolerance: float,
    max_iterations: int,
    report: Report = lambda done, time: None,
) -> Solution:
    """Solve F(x) = 0 by the steps x − F'(x)^{−1} F(x), until the residual has the size ``tolerance``.

    Up to `DENSE` unknowns, steps are exact and the residual falls quadratically. Beyond, GMRES finds each
    step to `FORCING`, by the action of the derivative.

    Parameters
    ----------
    equations : Equations
    x : ndarray
        The first iterate.
    tolerance : float
    max_iterations : int
        Largest number of steps.
    report : callable
        Called with the number of steps done, and NaN in place of a time.
    """
    F = equations.residual(x)
    sizes = [equations.size(F, x)]
    report(0, np.nan)
    while not sizes[-1] <= tolerance:
        if len(sizes) > max_iterations:
            left = f"{sizes[-1]:.2g} after {max_iterations} steps, the tolerance {tolerance:g}"
            return Solution(x, sizes, f"the relative residual is {left}")
        further = x - _step(equations.derivative(x), F)
        F = equations.residual(further) if np.all(np.isfinite(further)) else further
        if not np.all(np.isfinite(F)):
            return Solution(x, sizes, f"the residual is not finite after {len(sizes)} steps")
        x = further
        sizes.append(equations.size(F, x))
        report(len(sizes) - 1, np.nan)
    return Solution(x, sizes, "")


def _step(derivative: Callable[[np.ndarray], np.ndarray], F: np.ndarray) -> np.ndarray:
    """F'^{−1} F, exact or to `FORCING`."""
    n = F.size
    if n <= DENSE:
        return np.linalg.solve(np.column_stack([derivative(h) for h in np.eye(n)]), F)
    linalg = scipy.sparse.linalg
    operator = linalg.LinearOperator((n, n), matvec=derivative, dtype=float)
    step, _ = linalg.gmres(operator, F, rtol=FORCING, restart=KRYLOV, maxiter=RESTARTS)
    return step
