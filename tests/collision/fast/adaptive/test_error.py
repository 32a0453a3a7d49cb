"""The quadrature error of Q as one number."""

from dataclasses import replace

import numpy as np
import pytest

import granstudy as gs
from granstudy.collision.fast.adaptive.build import planned_operator
from granstudy.collision.fast.adaptive.error import SAMPLES, ErrorScale, magnitude
from granstudy.collision.fast.adaptive.search import _choose_grid, make_plan
from granstudy.model.solver import SizedSolver


@pytest.mark.parametrize(("dim", "N"), [(2, 64), (2, 128), (3, 32), (3, 48), (3, 64), (3, 96)])
def test_samples_see_an_error_wherever_it_is(dim, N):
    """On 64³ points samples at equal distances lay in one face, and plans were off by 5e-4 for 1e-8."""
    grid = gs.VelocityGrid(dim, N, 8.0)
    v = grid.velocities()
    scale = ErrorScale(grid, np.ones(grid.shape), 1.0)
    for centre in (0.0, 1.3):
        error = np.exp(-sum((vi - centre) ** 2 for vi in v) / 4)
        samples, _ = scale.samples(error.ravel()[None])
        points = samples[0, : -(2 + dim)]
        assert len(points) <= SAMPLES
        assert np.max(points) > 0.6
        # about as many samples see it as there are points
        assert np.mean(points > 0.1) == pytest.approx(np.mean(error > 0.1), rel=0.5)


def test_products_on_a_smaller_grid_count_in_the_error():
    scene = gs.load_scene("bkw2d", restitution=0.5)
    solver = SizedSolver(N=64, R=8.0, rtol=1e-2)
    f = scene.density(solver.grid(2))
    plan = make_plan(scene, solver, f)
    assert plan.n < plan.N
    # the error on the full grid and what the smaller one adds, in the same scale
    full, small = (planned_operator(scene, solver, replace(plan, n=n)) for n in (64, plan.n))
    Q = full(f)
    added = np.max(np.abs(small(f) - Q)) / magnitude(full, f, Q)
    assert added > 1e-6
    chosen = _choose_grid(scene, solver, replace(plan, error=1e-3), f)
    assert chosen.n == plan.n and chosen.error == pytest.approx(1e-3 + added, rel=1e-9)
