"""Newton's method with an exact derivative, its steps by elimination or by GMRES."""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

DENSE = 256
"""Unknowns up to which the derivative is written out as a matrix: radial grids, not Cartesian ones."""

FORCING = 1e-2
"""Part of a residual that GMRES leaves: each step gains two digits; more would be thrown away by the next."""

KRYLOV = 80
"""Vectors of GMRES before a restart."""

RESTARTS = 4
"""GMRES stops after so many restarts; the step is then a poorer one, which the residual shows."""


class Equations(Protocol):
    """F(x) = 0."""

    def residual(self, x: np.ndarray) -> np.ndarray:
        """F(x), as long as x."""

    def derivative(self, x: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """Map h to F'(x) h."""

    def size(self, residual: np.ndarray, x: np.ndarray) -> float:
        """How far F(x) is from 0, relative to its terms."""


class Solution(NamedTuple):
    """Where Newton's method ended."""

    x: np.ndarray
    """The last one with a finite residual"""
    sizes: list[float]
    """Size of the residual at the start and after every step."""
    reason: str
    """Why it is no solution; empty where it is one."""


def newton(equations: Equations, x: np.ndarray, tolerance: float, max_iterations: int) -> Solution:
    """Solve F(x) = 0 from ``x`` by x − F'(x)^{−1} F(x), to a residual of size ``tolerance``.

    Up to `DENSE` unknowns the steps are exact and the residual falls quadratically; beyond, GMRES with the
    derivative's action finds them to `FORCING`.
    """
    F = equations.residual(x)
    sizes = [equations.size(F, x)]
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
    return Solution(x, sizes, "")


def _step(derivative: Callable[[np.ndarray], np.ndarray], F: np.ndarray) -> np.ndarray:
    """F'^{−1} F, or nearly."""
    n = F.size
    if n <= DENSE:
        return np.linalg.solve(np.column_stack([derivative(h) for h in np.eye(n)]), F)
    operator = LinearOperator((n, n), matvec=derivative, dtype=float)
    step, _ = gmres(operator, F, rtol=FORCING, restart=KRYLOV, maxiter=RESTARTS)
    return step
