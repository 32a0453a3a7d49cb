"""Aliasing: how much it disturbs Q on a grid, and the grids on which products may be formed."""

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from granstudy.collision.fast.adaptive.build import describe_plan, planned_operator
from granstudy.collision.fast.adaptive.error import difference, magnitude
from granstudy.collision.fast.gain import GainSum
from granstudy.collision.fourier.spectra import density, half_spectrum, resize
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.symmetry import Symmetry

PROBE = 3
"""Step of the ladder whose rule aliasing is measured with."""

PROBE_SHELLS = 12
"""Number of shells that aliasing is measured with."""

SIZES = (8, 10, 12, 14, 16, 20, 24, 32, 36, 40, 48, 64, 72, 80, 96, 128)
"""Points per dimension of the grids on which products may be formed.

A size is left out where the next larger one takes about as little time with the plans of `granstudy tune`
(docs/results/checks/fft_plans.csv): 18, 22, 26 to 30, 42, 44, 50 to 60. Without such plans the
sizes are the same: what a run chooses does not depend on them."""


class Aliasing(NamedTuple):
    """Change of Q, in a fixed quadrature, with the signs of the nodes.

    Without aliasing g and −g would give the same: the change measures aliasing.

    Attributes
    ----------
    kept : float
        Largest change over ``scale``, on the modes on which quadratures are compared.
    everywhere : float
        Largest change over ``scale``, on all modes.
    Q : ndarray
        Q(f,f) with the quadrature.
    scale : float
        The `magnitude` of Q.
    """

    kept: float
    everywhere: float
    Q: np.ndarray
    scale: float


def aliasing(scene: Scene, solver: SizedSolver, f: np.ndarray) -> Aliasing:
    """Measure the aliasing of Q(f,f) on the solver's grid."""
    scene = replace(scene, symmetry=Symmetry.named(scene.dim, "none"))
    operator = planned_operator(scene, solver, describe_plan(scene, solver, [PROBE] * PROBE_SHELLS))
    Q = operator(f)
    flipped = replace(operator.gain.nodes, vectors=-operator.gain.nodes.vectors)
    operator.gain = GainSum(
        scene, operator.gain.grid, flipped, solver.thread_count, precision=solver.precision
    )
    other = operator(f)
    scale = magnitude(operator, f, Q)
    changed = Q - other
    return Aliasing(difference(changed) / scale, float(np.max(np.abs(changed))) / scale, Q, scale)


def resolving_grids(
    grid: VelocityGrid, f: np.ndarray, tolerance: float
) -> Iterator[tuple[int, np.ndarray]]:
    """Sizes of grids that resolve f to max|f|·tolerance, smallest first, each with f on that grid.

    The sizes are those of `SIZES` below the grid's own N, and N last.
    """
    f_hat = half_spectrum(f.reshape(grid.three_axis_shape))
    for n in SIZES:
        if n < grid.N:
            small = resize(f_hat, n)
            lost = density(f_hat - resize(small, grid.N))
            if np.max(np.abs(lost)) <= tolerance * np.max(np.abs(f)):
                yield n, density(small).reshape((n,) * grid.dim)
    yield grid.N, f
