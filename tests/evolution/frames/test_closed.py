"""Frames that give ρ, T and a2 of Maxwell molecules their exact rates."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import granstudy as gs
from granstudy import theory
from granstudy.accuracy.leg import Gas, make_leg
from granstudy.evolution.frames.closed import distinct_changes, is_closed
from granstudy.evolution.frames.rescaled import Place
from granstudy.trust.changes import change_of_moments
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.sphere import sphere_area


def leg(dim, e, diffusion, rescaled, N=16, R=5.0):
    """A leg on a grid that cuts off much of the density."""
    scene = gs.load_scene(f"maxwellian{dim}d", exponent=0.0, restitution=e, diffusion=diffusion)
    return make_leg(Gas(scene, np.zeros(dim), 1.0, rescaled), gs.Solver(N=N, R=R, method="radial"))


def shape(grid, weight):
    """Two Gaussians, the wider of which the grid cuts off."""
    c2 = np.square(grid.nodes)
    f = np.exp(-c2 / 2) + weight * np.exp(-c2 / 6)
    return f / np.sum(grid.measure * f)


@given(
    dim=st.sampled_from([2, 3]),
    e=st.floats(0.0, 1.0),
    diffusion=st.floats(0.0, 0.5),
    weight=st.floats(0.0, 0.3),
    rescaled=st.booleans(),
)
@settings(deadline=None, max_examples=30)
def test_mass_temperature_and_kurtosis_have_their_exact_rates(dim, e, diffusion, weight, rescaled):
    """Against the closed law of docs/theory.md §1, on a grid whose own rates are wrong by up to a tenth."""
    one = leg(dim, e, diffusion, rescaled)
    f = shape(one.grid, weight)
    state = one.start(f, Place(0.0, 0.0, np.zeros(dim)))
    rate = one.frame.rate(state)
    found = one.frame.moment_change(state, rate)
    m = one.grid.velocity_moments(f)
    T = np.trace(m.pressure) / dim
    a2 = m.fourth / (dim * (dim + 2) * T**2) - 1.0
    gas = {
        "restitution": e,
        "diffusion": diffusion,
        "density": 1.0,
        "cross_section": sphere_area(dim) * one.gas.scene.kernel.strength,
    }
    h = 1e-4
    times = np.array([0.0, h, 2 * h])
    one_sided = np.array([-1.5, 2.0, -0.5]) / h
    exact_T = one_sided @ theory.maxwell_temperature(times, T, **gas) / T
    exact_a2 = one_sided @ theory.maxwell_a2(times, T * np.eye(dim), a2, **gas) / (1.0 + a2)
    assert found.temperature == pytest.approx(exact_T, abs=1e-6)
    assert found.a2 == pytest.approx(exact_a2, abs=1e-6)
    assert np.sum(one.grid.measure * one.frame.density(rate)) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("rescaled", [False, True])
def test_what_a_scheme_takes_off_changes_nothing_else(rescaled):
    """The rate less εΔf is the whole rate less εΔf."""
    one = leg(2, 0.5, 0.2, rescaled)
    state = one.start(shape(one.grid, 0.1), Place(0.0, 0.0, np.zeros(2)))
    taken_off = one.frame.diffusivity(state)
    difference = one.frame.rate(state) - one.frame.rate(state, taken_off)
    laplacian = one.frame.form.diffusion(taken_off)(one.frame.form.state(one.frame.density(state)))
    np.testing.assert_allclose(difference[: laplacian.size], laplacian, atol=1e-12)


@given(dim=st.sampled_from([2, 3]), weight=st.floats(0.0, 1.0), s=st.floats(4.0, 60.0))
@settings(deadline=None, max_examples=20)
def test_changes_are_distinct(dim, weight, s):
    """The second has no mass, the third neither mass nor energy."""
    grid = RadialGrid(dim, 20, 6.0)
    f = shape(grid, weight)
    changes = distinct_changes(grid, 1.3, s)
    mass = changes @ grid.measure
    energy = change_of_moments(grid, f, changes[2]).temperature
    assert mass[1] == pytest.approx(0.0, abs=1e-10)
    assert mass[2] == pytest.approx(0.0, abs=1e-9)
    assert energy == pytest.approx(0.0, abs=1e-9)


def test_only_maxwell_molecules_with_constant_restitution_are_closed():
    assert is_closed(gs.load_scene("maxwellian2d", exponent=0.0, restitution=0.5))
    assert not is_closed(gs.load_scene("maxwellian2d", exponent=0.5, restitution=0.5))
    law = gs.load_scene("maxwellian2d", exponent=0.0, restitution=gs.Viscoelastic(0.2))
    assert not is_closed(law)
