import numpy as np
import pytest
from comparison import Gaussians
from hypothesis import given, settings
from hypothesis import strategies as st

import granstudy as gs
from granstudy.velocity.moments import MOMENTS


@pytest.mark.parametrize("dim", [2, 3])
def test_moments_of_a_maxwellian(dim):
    grid = gs.VelocityGrid(dim, 40, 9.0)
    u = (0.5, -0.25, 0.75)[:dim]
    scene = gs.load_scene(f"maxwellian{dim}d", temperature=0.8, velocity=u)
    m = gs.moments(scene.density(grid), grid)
    assert set(m.data_vars) == set(MOMENTS)
    assert all({"long_name", "units"} <= set(m[name].attrs) for name in m.data_vars)
    assert float(m.density) == pytest.approx(1.0, abs=1e-10)
    assert m.velocity.sel(component="y").item() == pytest.approx(-0.25, abs=1e-10)
    assert float(m.temperature) == pytest.approx(0.8, abs=1e-10)
    assert float(m.energy) == pytest.approx(dim / 2 * 0.8 + np.square(u).sum() / 2, abs=1e-9)
    # the paper's measure counts the bulk motion
    assert float(m.paper_temperature) == pytest.approx(2 / dim * float(m.energy), rel=1e-14)
    np.testing.assert_allclose(m.pressure, 0.8 * np.eye(dim), atol=1e-9)
    assert abs(float(m.a2)) < 1e-8
    assert float(m.minimum) > 0.0


@settings(max_examples=10, deadline=None)
@given(st.sampled_from([2, 3]), st.integers(0, 10**6), st.floats(0.5, 3.0))
def test_moments_of_a_sum_of_gaussians(dim, seed, factor):
    grid = gs.VelocityGrid(dim, 32, 6.0)
    density = Gaussians(dim, seed, (0.5, 0.7), 0.6)
    m = gs.moments(factor * density(*grid.velocities()), grid)
    u = density.shares @ density.centres
    second = sum(
        share * (np.linalg.inv(precision) + np.outer(centre - u, centre - u))
        for share, centre, precision in zip(
            density.shares, density.centres, density.precisions, strict=True
        )
    )
    np.testing.assert_allclose(m.velocity, u, atol=1e-6)
    np.testing.assert_allclose(m.pressure, factor * second, atol=2e-6)
    assert float(m.density) == pytest.approx(factor, rel=1e-6)
    # the temperature knows no density
    assert float(m.temperature) == pytest.approx(np.trace(second) / dim, rel=1e-5)


def test_kurtosis_excess():
    # bkw3d at K: ⟨c⁴⟩/15 = 2K − K² for T = 1, so a2 = −(1 − K)²
    K = 1 - np.exp(-6.5 / 6)
    grid = gs.VelocityGrid(3, 48, 10.0)
    m = gs.moments(gs.load_scene("bkw3d").density(grid), grid)
    assert float(m.a2) == pytest.approx(-((1 - K) ** 2), abs=1e-8)


def test_of_a_complex_state_the_real_part_counts():
    grid = gs.VelocityGrid(2, 8, 5.0)
    f = gs.load_scene("bkw2d").density(grid)
    assert gs.moments(f + 0.1j, grid).identical(gs.moments(f, grid))
