"""What a radius cuts off, against what a truncated operator loses."""

import numpy as np
import pytest
from comparison import asymmetric_scene

import granstudy as gs
from granstudy.accuracy.grids.truncation import truncation
from granstudy.trust.changes import change_of_moments
from granstudy.trust.pair_rates import CollisionRates


def test_all_pairs_together_have_the_exact_rates():
    scene = asymmetric_scene(3, exponent=1.0, restitution=0.5)
    grid = gs.VelocityGrid(3, 32, 10.0)
    f = scene.density(grid)
    cut, exact, m = (
        truncation(scene, grid, f),
        CollisionRates(scene, grid)(f),
        grid.velocity_moments(f),
    )
    # All pairs but those within half a spacing, whose part is small.
    cooling = 2.0 * exact.energy / np.trace(m.pressure)
    assert cut.temperature[0] == pytest.approx(abs(cooling), rel=1e-3)
    assert cut.a2[0] >= 0.99 * abs(exact.fourth / m.fourth - 2.0 * cooling)
    assert np.all(np.diff(cut.temperature) <= 0.0)
    assert np.all(np.diff(cut.a2) <= 0.0)


@pytest.mark.parametrize("R", [5.5, 6.5])
def test_a_truncated_operator_loses_what_the_pairs_say(R):
    scene = gs.load_scene("maxwellian2d", kernel=gs.hard_spheres(2), restitution=0.5)
    probe = gs.VelocityGrid(2, 64, 12.0)
    cut = truncation(scene, probe, scene.density(probe))
    grid = gs.VelocityGrid(2, 40, R)
    operator = gs.collision_operator(scene, gs.Solver(N=40, R=R, N_rho=40, M_cir=48))
    f = scene.density(grid)
    found = change_of_moments(grid, f, operator(f))
    exact, m = CollisionRates(scene, grid)(f), grid.velocity_moments(f)
    lost = found.temperature - 2.0 * exact.energy / np.trace(m.pressure)
    assert abs(lost) == pytest.approx(np.interp(R, cut.radii, cut.temperature), rel=0.5)


def test_the_radius_is_the_least_one_that_does():
    scene = gs.load_scene("maxwellian2d", kernel=gs.hard_spheres(2), restitution=0.5)
    grid = gs.VelocityGrid(2, 64, 12.0)
    cut = truncation(scene, grid, scene.density(grid))
    R = cut.radius(1e-4, 1e-3, 1.0)
    assert cut.at(R)[0] <= 1e-4
    assert cut.at(R)[1] <= 1e-3
    before = cut.at(R - grid.spacing / 2)
    assert before[0] > 1e-4 or before[1] > 1e-3


def test_a_radius_holds_the_pairs_of_an_elastic_gas_too():
    scene = gs.load_scene("two_beams2d", kernel=gs.maxwell(2), restitution=1.0, separation=2.0)
    grid = gs.VelocityGrid(2, 64, 14.0)
    cut = truncation(scene, grid, scene.density(grid))
    assert cut.temperature.max() < 1e-12  # no collision changes T
    assert cut.radius(1.0, 1.0, 1.0) < 1.0
    held = cut.radius(1.0, 1.0, 1e-3)
    assert held > 5.0
    assert cut.at(held)[2] <= 1e-3
