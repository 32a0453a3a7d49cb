"""The quadrature error of Q as one number."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.collision.fast.adaptive.error import SAMPLES, ErrorScale


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
