"""The quadrature that a tolerance leads to: shells and their rules, as plain data."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np

from granstudy.collision.protocol import CollisionOperator


@dataclass(frozen=True, repr=False)
class QuadraturePlan:
    """A quadrature: Gauss–Jacobi shells in ρ², the size of the rule on each shell, the grid of the products.

    Attributes
    ----------
    dim : int
    rtol : float
        The tolerance (`Solver.rtol`).
    N : int
        Points per dimension of the scene's grid.
    n : int
        Points per dimension on which the products f(v)f(v−g) are formed: N or fewer; 3N/2 with
        `Solver.dealias`.
    rule : str
        ``lebedev`` or ``circle``.
    radii : tuple of float
        ρ of the shells.
    sizes : tuple of int
        Points of the rule on each shell, 0 for a shell that is left out.
    symmetry : str
        Group under which one node of each orbit is evaluated.
    nodes : int
        Number of nodes evaluated: one of each pair ±g, or one of each orbit.
    transforms : int
        Real transforms of n^d points that one evaluation of Q makes.
    error : float
        Estimate of the error that ``rtol`` bounds, for the density that the plan was made for.
    aliasing : float
        Estimate of the error from products that wrap around the spectrum of N modes. No quadrature removes
        it; a larger N does.
    """

    dim: int
    rtol: float
    N: int
    n: int
    rule: str
    radii: tuple[float, ...]
    sizes: tuple[int, ...]
    symmetry: str
    nodes: int
    transforms: int
    error: float
    aliasing: float

    @property
    def N_rho(self) -> int:
        """Number of shells."""
        return len(self.radii)

    def describe(self) -> dict[str, Any]:
        """The plan as plain data, for a dataset's attributes."""
        return dataclasses.asdict(self)

    @classmethod
    def of(cls, described: Mapping[str, Any]) -> "QuadraturePlan":
        """The plan that `describe` described, by JSON or not; other keys do not count."""
        names = [field.name for field in dataclasses.fields(cls)]
        fields = {name: described[name] for name in names}
        shells = {name: tuple(fields[name]) for name in ("radii", "sizes")}
        return cls(**fields | shells)

    def __repr__(self) -> str:
        cells = [(f"{rho:.2f}", str(M)) for rho, M in zip(self.radii, self.sizes, strict=True)]
        widths = [max(map(len, cell)) for cell in cells]
        rows = [
            "  ".join(cell[row].rjust(width) for cell, width in zip(cells, widths, strict=True))
            for row in (0, 1)
        ]
        return (
            f"QuadraturePlan: error {self.error:.1e} for rtol {self.rtol:.1e}"
            f", aliasing {self.aliasing:.1e}\n"
            f"  ρ {rows[0]}\n"
            f"  M {rows[1]}\n"
            f"  {sum(self.sizes)} nodes ({self.rule}), symmetry {self.symmetry!r}: {self.nodes} "
            f"evaluated, {self.transforms} transforms of {self.n}^{self.dim} points (N={self.N})"
        )


@runtime_checkable
class TunedOperator(CollisionOperator, Protocol):
    """An operator with a quadrature chosen for a tolerance and a density (`Solver.rtol`)."""

    plan: "QuadraturePlan"

    def check(self, f: np.ndarray) -> float:
        """The error of Q(f,f) that the tolerance bounds, by a finer quadrature."""

    def tune(self, f: np.ndarray) -> "QuadraturePlan":
        """Choose the quadrature anew, for this density."""

    def use(self, plan: "QuadraturePlan") -> None:
        """Take a quadrature that was chosen before."""
