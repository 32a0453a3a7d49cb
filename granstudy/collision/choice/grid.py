"""A grid for a scene: R from the distances between its particles, N from the decay of its spectrum.

The grid holds the initial density. A gas that cools needs more points later; the health of a run shows when.
"""

from typing import Any

import numpy as np
import scipy.fft

from granstudy.collision.fast.adaptive.aliasing import SIZES, aliasing
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.support.errors import ToleranceError
from granstudy.velocity.cartesian import VelocityGrid

PROBE_N = {2: 128, 3: 64}
"""Points a dimension of the grid on which a density is probed, by dimension."""

EDGE = 1e-12
"""Largest |f| on the faces of a box that holds all of the density, over max|f|."""

LARGEST_R = 1000.0
"""R beyond which the search for such a box gives up."""

R_STEP = 0.25
"""Step of R: a chosen R is a multiple of it."""


def fit_solver(scene: Scene, rtol: float, **settings: Any) -> SizedSolver:
    """A solver with N and R chosen for a scene and a tolerance; the tolerance then chooses the quadrature.

    ===  ======================================================================================
    R    the least radius beyond which pairs exchange at most the part rtol of all energy:
         ∫_{|g|>R} |g|^{2+λ} a(g) dg ≤ rtol ∫ |g|^{2+λ} a(g) dg, with a(g) = ∫ f(v) f(v−g) dv
    N    the fewest points on which aliasing changes Q by at most rtol·max|Q|
    ===  ======================================================================================

    Parameters
    ----------
    scene : Scene
        Its initial density counts.
    rtol : float
        Tolerance, as of `granstudy.Solver`.
    settings
        Other fields of `granstudy.Solver`.

    Raises
    ------
    ValueError
        If a setting is not allowed, or no box or grid of reasonable size holds the density.
    """
    SizedSolver(N=SIZES[0], R=1.0, rtol=rtol, **settings)  # checks all, before any work
    R = collision_radius(scene, rtol)
    for N in SIZES:
        solver = SizedSolver(N=N, R=R, rtol=rtol, **settings)
        grid = solver.grid(scene.dim)
        f = scene.density(grid)
        if _holds(grid, f, rtol) and aliasing(scene, solver, f).everywhere <= rtol:
            return solver
    raise ToleranceError(
        f"rtol={rtol!r}: no N up to {SIZES[-1]} resolves initial={scene.initial!r} so well with "
        f"R={R:g}; take a larger rtol"
    )


def collision_radius(scene: Scene, rtol: float) -> float:
    """The least multiple of `R_STEP` beyond which pairs exchange at most the part rtol of all energy.

    R is raised until |f| on the faces of its box is at most rtol·max|f|.
    """
    grid, f = whole(scene)
    padded = (2 * grid.N,) * grid.dim
    pairs = scipy.fft.irfftn(np.abs(scipy.fft.rfftn(f, s=padded)) ** 2, s=padded)
    g = scipy.fft.fftfreq(2 * grid.N, 1 / (2 * grid.N * grid.spacing))
    speed = np.sqrt(sum(gi**2 for gi in np.meshgrid(*(g,) * grid.dim, indexing="ij", sparse=True)))
    rate = np.maximum(pairs, 0.0) * speed ** (2 + scene.kernel.exponent)
    bins = np.bincount((speed / R_STEP).astype(int).ravel(), weights=rate.ravel())
    beyond = 1.0 - np.cumsum(bins) / bins.sum()
    R = R_STEP * (1 + int(np.argmax(beyond <= rtol)))
    while R < grid.R and _face(scene.density(VelocityGrid(scene.dim, grid.N, R))) > rtol:
        R += R_STEP
    return float(R)


def whole(scene: Scene) -> tuple[VelocityGrid, np.ndarray]:
    """A grid that holds all of the density (`EDGE`), and the density on it."""
    R = 4.0
    while R < LARGEST_R:
        grid = VelocityGrid(scene.dim, PROBE_N[scene.dim], R)
        f = scene.density(grid)
        if _face(f) <= EDGE:
            return grid, f
        R *= 1.25
    raise ValueError(
        f"initial={scene.initial!r}: does not vanish within R={LARGEST_R:g}; choose R and N yourself"
    )


def _face(f: np.ndarray) -> float:
    """Largest |f| on the faces of the box, over max|f|."""
    faces = [np.take(f, [0, -1], axis=axis) for axis in range(f.ndim)]
    return float(max(np.max(np.abs(face)) for face in faces) / np.max(np.abs(f)))


def _holds(grid: VelocityGrid, f: np.ndarray, rtol: float) -> bool:
    """Whether the spectrum of f has fallen to rtol at the last modes of the grid."""
    f_hat = np.abs(scipy.fft.fftn(f))
    last = [np.take(f_hat, [grid.N // 2 - 1, grid.N // 2], axis=axis) for axis in range(grid.dim)]
    return bool(max(np.max(part) for part in last) <= rtol * np.max(f_hat))
