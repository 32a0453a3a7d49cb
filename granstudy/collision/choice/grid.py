"""A grid for a scene: R from how far apart its particles are, N from where its spectrum has decayed.

For the initial density. A gas that cools needs more points as time goes on, at a time that the checks of
a run report.
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
"""Points a dimension of the grid that the density is looked at on."""

EDGE = 1e-12
"""Largest |f| on the box's faces over max|f|, of a box that holds all of the density."""

LARGEST_R = 1000.0

R_STEP = 0.25
"""R is a multiple of this."""


def fit_solver(scene: Scene, rtol: float, **settings: Any) -> SizedSolver:
    """A solver with N, R and the quadrature chosen for a scene and a tolerance.

    R: collisions of particles further apart than R exchange no more than rtol of all energy,
    ∫_{|g|>R} |g|^{2+λ} a(g) dg ≤ rtol ∫ |g|^{2+λ} a(g) dg with a(g) = ∫ f(v) f(v−g) dv. N: the
    fewest points for which aliasing changes Q by no more than rtol·max|Q|.

    Parameters
    ----------
    settings
        Other fields of `Solver`.

    Raises
    ------
    ValueError
        If a setting is not allowed, or no box or grid of reasonable size holds the density.
    """
    SizedSolver(N=SIZES[0], R=1.0, rtol=rtol, **settings)  # checks them before any work
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
    """The smallest multiple of `R_STEP` beyond which no more than rtol of the energy is exchanged.

    The box that goes with it holds f but for rtol·max|f| on its faces.
    """
    grid, f = _whole(scene)
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


def _whole(scene: Scene) -> tuple[VelocityGrid, np.ndarray]:
    """A grid on whose faces the density vanishes, and the density there."""
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
    """Largest |f| on the box's faces over the largest of all."""
    faces = [np.take(f, [0, -1], axis=axis) for axis in range(f.ndim)]
    return float(max(np.max(np.abs(face)) for face in faces) / np.max(np.abs(f)))


def _holds(grid: VelocityGrid, f: np.ndarray, rtol: float) -> bool:
    """Whether f's spectrum has fallen to rtol at the grid's last modes."""
    f_hat = np.abs(scipy.fft.fftn(f))
    last = [np.take(f_hat, [grid.N // 2 - 1, grid.N // 2], axis=axis) for axis in range(grid.dim)]
    return bool(max(np.max(part) for part in last) <= rtol * np.max(f_hat))
