"""Changes of grid: moments are kept, local noise stays local, extended grids interpolate nothing."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.accuracy.grids.isotropy import isotropic_part, switching_error
from granstudy.accuracy.grids.regrid import Kept, interpolated, kept_moments, regrid, with_moments


def gas(name, dim, **law):
    return gs.load_scene(f"{name}{dim}d", kernel=gs.hard_spheres(dim), restitution=0.5, **law)


def assert_kept(f, grid, g, other):
    for before, after in zip(kept_moments(f, grid), kept_moments(g, other), strict=True):
        np.testing.assert_allclose(after, before, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("kind", [gs.VelocityGrid, gs.RadialGrid])
def test_mass_momentum_energy_and_fourth_moment_are_kept(kind, dim):
    scene = gas("bkw", dim) if kind is gs.RadialGrid else gas("two_beams", dim, separation=2.0)
    source, target = kind(dim, 24, 9.0), kind(dim, 30, 8.0)
    f = scene.density(source)
    assert_kept(f, source, regrid(f, source, target), target)


@pytest.mark.parametrize("kind", [gs.VelocityGrid, gs.RadialGrid])
def test_interpolation_is_of_order_sixteen(kind):
    scene = gas("maxwellian", 2)
    target = kind(2, 50, 7.9)
    # Spacings of 0.6 to 0.35 thermal speeds: below round-off does not matter, above nothing converges.
    sizes = np.array([28, 36, 48]) if kind is gs.VelocityGrid else np.array([18, 24, 32])
    errors, spacings = [], []
    for N in sizes:
        source = kind(2, int(N), 8.0)
        off = interpolated(scene.density(source), source, target) - scene.density(target)
        errors.append(np.max(np.abs(off)))
        spacings.append(source.spacing)
    orders = np.diff(np.log(errors)) / np.diff(np.log(spacings))
    assert np.all(orders > 9.0)
    assert errors[-1] < 3e-6


def test_a_local_change_of_grid_spoils_a2_far_less_than_the_modes_do():
    scene = gas("bkw", 2)
    source, target = gs.VelocityGrid(2, 32, 8.0), gs.VelocityGrid(2, 32, 7.6)
    f = scene.density(source)
    local = interpolated(f, source, target)
    k = np.pi / source.L * source.wavenumbers
    waves = np.exp(1j * np.multiply.outer(target.nodes - source.nodes[0], k)) / source.N
    by_modes = np.einsum("ij,kl,jl->ik", waves, waves, np.fft.fft2(f)).real
    true = gs.moments(scene.density(target), target)["a2"].item()
    off = [abs(gs.moments(g, target)["a2"].item() - true) for g in (local, by_modes)]
    assert off[0] < 2e-4
    assert off[1] > 50 * off[0]


@pytest.mark.parametrize("dim", [2, 3])
def test_a_radial_grid_that_reaches_further_keeps_its_speeds(dim):
    source = gs.RadialGrid(dim, 20, 7.0)
    first = gs.RadialGrid(dim, 28, 7.0).nodes[0]
    target = gs.RadialGrid(dim, 28, 7.0 * source.nodes[0] / first)
    np.testing.assert_allclose(target.nodes[:20], source.nodes, rtol=1e-12)
    f = gas("bkw", dim).density(source)
    g = interpolated(f, source, target)
    np.testing.assert_allclose(g[:20], f, atol=1e-12)
    assert not g[20:].any() or np.max(np.abs(g[20:])) < 1e-12


@pytest.mark.parametrize("dim", [2, 3])
def test_the_mean_over_directions_keeps_mass_temperature_and_a2(dim):
    velocity = (0.4, -0.2, 0.1)[:dim]
    scene = gas("maxwellian", dim, velocity=velocity)
    grid = gs.VelocityGrid(dim, 32, 8.5)
    f = scene.density(grid)
    mean, fine = isotropic_part(f, grid)
    before, after = kept_moments(f, grid), kept_moments(mean, fine)
    np.testing.assert_allclose(after.density, before.density, rtol=1e-12)
    np.testing.assert_allclose(after.second, before.second, rtol=1e-12)
    np.testing.assert_allclose(after.fourth, before.fourth, rtol=1e-12)
    at_rest = gas("maxwellian", dim).density(fine)
    assert np.max(np.abs(mean - at_rest)) < 1e-4 * at_rest.max()


def test_what_a_switch_to_the_mean_costs_is_of_second_order():
    grid = gs.VelocityGrid(2, 40, 9.0)
    found = []
    for separation in (1.0, 0.5):
        scene = gas("two_beams", 2, separation=separation)
        f = scene.density(grid)
        found.append(switching_error(scene, f, grid, *isotropic_part(f, grid)))
    # The anisotropy goes as separation²; its square as separation⁴.
    ratio = np.array(found[0]) / np.array(found[1])
    assert np.all(ratio > 10.0)
    assert np.all(ratio < 22.0)


def test_a_grid_too_coarse_for_a_density_is_no_error():
    grid = gs.VelocityGrid(2, 16, 300.0)
    kept = Kept(1.0, np.zeros(2), 4.0, 16.0)
    f = with_moments(gas("maxwellian", 2).density(grid), grid, kept)
    assert np.all(np.isfinite(f))
