"""The radial operator for isotropic densities: Q(f,f)(r_i) = Σ_{j≤l} T[jl, i] f_j f_l (docs/method.md §7)."""

from functools import cache, partial
from importlib.metadata import version
from typing import Any

import numpy as np

from granstudy.collision.protocol import check_state
from granstudy.collision.radial.tensor import unit_tensor
from granstudy.model.isotropy import check_isotropic
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.support.cache import cached_array
from granstudy.support.compiled import compiled
from granstudy.support.fingerprint import fingerprint
from granstudy.velocity.radial import RadialGrid

LIBRARIES = ("numpy", "scipy", "numba")
"""Libraries that the tensor is computed with: another version may give other digits."""

LARGEST_KEPT = 64
"""Largest N of which tensors are kept on disk. They are N³/2 numbers, and are made in 0.1 s at 64 speeds."""


class RadialOperator:
    """Q(f,f) of isotropic densities with u = 0, on the solver's N radial nodes.

    All integrals are computed to round-off. Q therefore converges spectrally in N to the truncated
    operator, as with `direct`, at N³/2 multiplications per call. The tensor is computed once for each
    (d, N, λ, e) and kept on disk (`granstudy.support.cache`).
    """

    transforms = 0

    def __init__(self, scene: Scene, solver: SizedSolver) -> None:
        check_isotropic(scene, solver.R)
        assert not callable(scene.restitution)
        self._recipe = scene, solver
        self.grid = grid = RadialGrid(scene.dim, solver.N, solver.R)
        exponent, e = float(scene.kernel.exponent), float(scene.restitution)
        make = partial(unit_tensor, grid.dim, grid.N, exponent, e, solver.thread_count)
        kept = grid.N <= LARGEST_KEPT
        unit = cached_array(tensor_name(grid.dim, grid.N, exponent, e), make) if kept else make()
        self.tensor = scene.kernel.strength * grid.R ** (grid.dim + exponent) * unit

    def __call__(self, f: np.ndarray) -> np.ndarray:
        """Q(f,f) at the nodes, from a real density at the nodes."""
        check_state(f, self.grid)
        if np.iscomplexobj(f):
            raise ValueError(f"density has type {f.dtype}: method 'radial' takes real densities")
        return bilinear(self.tensor, np.ascontiguousarray(f, dtype=np.float64))

    def derivative(self, f: np.ndarray) -> np.ndarray:
        """The matrix of h ↦ Q(f,h) + Q(h,f)."""
        check_state(f, self.grid)
        return bilinear_derivative(self.tensor, np.ascontiguousarray(f, dtype=np.float64)).T

    def transform(self) -> None:
        """Make the transforms of one call, for benchmarks: a call has none."""

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickled is what the operator is made from: the scene and the solver."""
        return type(self), self._recipe


def tensor_name(dim: int, N: int, exponent: float, restitution: float) -> str:
    """Name in the cache: the parameters of `unit_tensor`, its code, and versions of `LIBRARIES`."""
    parameters = f"{dim}d-N{N}-exponent{exponent!r}-e{restitution!r}"
    return f"radial-{parameters}-{_code()}"


@cache
def _code() -> str:
    libraries = "-".join(f"{name}{version(name)}" for name in LIBRARIES)
    return f"{fingerprint([unit_tensor.__module__])}-{libraries}"


@compiled()
def bilinear(T, f):
    """Σ_{j≤l} T[jl, :] f_j f_l."""
    n = f.size
    Q = np.zeros(n)
    pair = 0
    for j in range(n):
        for l in range(j, n):  # noqa: E741
            product = f[j] * f[l]
            for i in range(n):
                Q[i] += T[pair, i] * product
            pair += 1
    return Q


@compiled()
def bilinear_derivative(T, f):
    """D[j, i], the derivative of `bilinear`'s Q_i by f_j."""
    n = f.size
    D = np.zeros((n, n))
    pair = 0
    for j in range(n):
        for l in range(j, n):  # noqa: E741
            for i in range(n):
                D[j, i] += T[pair, i] * f[l]
                D[l, i] += T[pair, i] * f[j]
            pair += 1
    return D
