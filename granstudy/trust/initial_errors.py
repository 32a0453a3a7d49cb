"""Errors that a grid makes in the moments of an initial density (docs/method.md §10)."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from granstudy.model.scene import Scene
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.space import VelocitySpace
from granstudy.velocity.sphere import sphere_area

FINER = {2: 5, 3: 3}
"""Nodes in each direction for one of the grid, within its box, by dimension."""

FINER_RADIAL = 8
"""Nodes over those of a radial grid."""

CHUNK = 1_000_000
"""Nodes at which a density is evaluated at a time, about."""


class StartMoments(NamedTuple):
    """ρ, T and a2 of a density."""

    density: float
    temperature: float
    a2: float


class InitialErrors(NamedTuple):
    """Errors of ρ and T relative to themselves, and of a2."""

    mass: float
    temperature: float
    a2: float


def errors_of(found: StartMoments, true: StartMoments) -> InitialErrors:
    """Absolute errors of moments that a grid, or particles, have at the start."""
    return InitialErrors(
        abs(found.density / true.density - 1.0),
        abs(found.temperature / true.temperature - 1.0),
        abs(found.a2 - true.a2),
    )


def true_start(scene: Scene, grid: VelocitySpace) -> StartMoments:
    """Moments of the initial density: as it states them, else by finer nodes, and by nodes on twice the box.

    They see what the grid does not: cores between its nodes, and mass beyond its border.

    Raises
    ------
    ValueError
        If the density fails, or is not finite, at those nodes.
    """
    stated = scene.moments
    if stated is not None:
        return StartMoments(stated.density, stated.temperature, stated.a2)
    return integrated(scene, grid, beyond=True)


def integrated(scene: Scene, grid: VelocitySpace, beyond: bool) -> StartMoments:
    """Moments of the initial density by finer nodes within the box, or the ball, of a grid.

    With ``beyond`` nodes on twice the box, or the ball, count as well.
    """
    if isinstance(grid, VelocityGrid):
        return _moments(scene, _Box(grid, beyond))
    return _moments(scene, _Ball(grid, beyond))


Part = tuple[tuple[np.ndarray, ...], float | np.ndarray]
"""Velocities that broadcast to a part of the nodes, and the weights of the nodes."""


class _Box:
    """Nodes of a finer Cartesian grid, and of the grid continued to twice its box, plane by plane."""

    def __init__(self, grid: VelocityGrid, beyond: bool) -> None:
        self._grid, self._beyond = grid, beyond

    def parts(self) -> Iterator[Part]:
        """All nodes, part by part."""
        grid = self._grid
        yield from self._planes(FINER[grid.dim] * grid.N, grid.L)
        if self._beyond:
            for v, cell in self._planes(2 * grid.N, 2 * grid.L):
                outside = np.any(np.broadcast_arrays(*(np.abs(vi) > grid.L for vi in v)), axis=0)
                yield v, cell * outside

    def _planes(self, count: int, half: float) -> Iterator[tuple[tuple[np.ndarray, ...], float]]:
        """Nodes and weights of a Cartesian grid of ``count`` nodes a direction on [−half, half]^d."""
        spacing, dim = 2 * half / count, self._grid.dim
        nodes = (np.arange(count) + 0.5) * spacing - half
        planes = max(1, CHUNK // count ** (dim - 1))
        for start in range(0, count, planes):
            axes = [nodes[start : start + planes], *(nodes,) * (dim - 1)]
            yield tuple(np.meshgrid(*axes, indexing="ij", sparse=True)), spacing**dim


class _Ball:
    """Gauss–Legendre nodes along the first axis, each for all directions."""

    def __init__(self, grid: VelocitySpace, beyond: bool) -> None:
        x, w = np.polynomial.legendre.leggauss(FINER_RADIAL * grid.shape[0])
        radius = (2.0 if beyond else 1.0) * grid.L
        r = radius * (x + 1.0) / 2.0
        self._velocities = (r, *(np.zeros_like(r),) * (grid.dim - 1))
        self._weights = sphere_area(grid.dim) * r ** (grid.dim - 1) * w * radius / 2.0

    def parts(self) -> Iterator[Part]:
        """The velocities and their weights, in one part."""
        yield self._velocities, self._weights


def _moments(scene: Scene, nodes: _Box | _Ball) -> StartMoments:
    """ρ, T and a2 by the sums over nodes; on a ball u = 0."""
    d = scene.dim
    first = np.zeros(1 + d)
    for v, weights in nodes.parts():
        f = _values(scene, v) * weights
        first += [np.sum(f), *(np.sum(vi * f) for vi in v)]
    u = first[1:] / first[0] if isinstance(nodes, _Box) else np.zeros(d)
    second = fourth = 0.0
    for v, weights in nodes.parts():
        f = _values(scene, v) * weights
        V = sum(np.square(vi - ui) for vi, ui in zip(v, u, strict=True))
        second += float(np.sum(V * f))
        fourth += float(np.sum(V**2 * f))
    T = second / (d * first[0])
    return StartMoments(
        float(first[0]), float(T), float(fourth / first[0] / (d * (d + 2) * T**2) - 1)
    )


def _values(scene: Scene, v: tuple[np.ndarray, ...]) -> np.ndarray:
    """The initial density at velocities; ValueError unless it is finite there."""
    reach = max(float(np.max(np.abs(vi))) for vi in v)
    asked = f"initial={scene.initial!r}: is asked for speeds up to {reach:.3g}, beyond the grid"
    with np.errstate(all="ignore"):
        try:
            f = np.asarray(scene.initial(*v), dtype=float)
        except Exception as error:
            raise ValueError(f"{asked}; there it raises {type(error).__name__}: {error}") from error
    if not np.all(np.isfinite(f)):
        raise ValueError(f"{asked}; there it must be finite: let it return 0 where there is no gas")
    return f
