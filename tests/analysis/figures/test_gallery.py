"""Densities along an axis, in thermal units: a Maxwellian is the same on every grid and in every frame."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.analysis.figures.gallery import thermal_profile


@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
@pytest.mark.parametrize("method", ["fast", "radial"])
def test_a_maxwellian_is_a_gaussian(method, frame):
    velocity = (0.7, -0.3) if method == "fast" else (0.0, 0.0)
    scene = gs.load_scene("maxwellian2d", temperature=0.8, velocity=velocity, restitution=1.0)
    solver = gs.Solver(N=32, R=8.0, M_cir=8, N_rho=8, method=method)
    ds = gs.simulate(
        scene, solver, t_final=1e-3, dt=1e-3, frame=frame, save_every=5, progress=False
    )
    x, y = thermal_profile(ds)
    assert np.all(np.diff(x) > 0) and x[0] < -5 and x[-1] > 5
    np.testing.assert_allclose(y, np.exp(-(x**2) / 2) / (2 * np.pi), atol=2e-4)


def test_there_is_none_without_a_density():
    scene = gs.load_scene("bkw2d")
    solver = gs.Solver(N=8, R=8.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1, progress=False)
    assert thermal_profile(ds) is None
