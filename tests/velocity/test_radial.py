"""The radial grid: its quadrature, its Laplacian, and the way to and from the Cartesian grid."""

import numpy as np
import pytest
from comparison import assert_near
from hypothesis import given
from hypothesis import strategies as st

import granstudy as gs
from granstudy.velocity.moments import MOMENTS


def bkw(dim):
    return gs.load_scene(f"bkw{dim}d")


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("N", [4, 15, 64])
def test_nodes_and_weights(dim, N):
    grid = gs.RadialGrid(dim, N, 7.0)
    assert grid.shape == grid.nodes.shape == grid.weights.shape == (N,)
    assert np.all(np.diff(grid.nodes) > 0) and 0 < grid.nodes[0] and grid.nodes[-1] < grid.L
    assert np.all(grid.weights > 0)
    assert grid.L == pytest.approx(1.3 * 7.0)
    assert grid.spacing == pytest.approx(grid.L / N, rel=0.1)
    # the modes vanish at L
    assert np.max(np.abs(grid.mode_values(np.array([grid.L])))) < 1e-14


@pytest.mark.parametrize("dim", [2, 3])
def test_moments_of_a_maxwellian(dim):
    grid = gs.RadialGrid(dim, 36, 9.0)
    scene = gs.load_scene(f"maxwellian{dim}d", temperature=0.8)
    m = gs.moments(scene.density(grid), grid)
    assert set(m.data_vars) == set(MOMENTS)
    assert float(m.density) == pytest.approx(1.0, abs=1e-12)
    assert float(m.temperature) == pytest.approx(0.8, abs=1e-12)
    assert float(m.energy) == pytest.approx(dim / 2 * 0.8, abs=1e-12)
    np.testing.assert_array_equal(m.velocity, np.zeros(dim))
    np.testing.assert_allclose(m.pressure, 0.8 * np.eye(dim), atol=1e-12)
    assert abs(float(m.a2)) < 1e-10


@pytest.mark.parametrize("dim", [2, 3])
def test_moments_equal_those_on_the_cartesian_grid(dim):
    radial, cartesian = gs.RadialGrid(dim, 40, 9.0), gs.VelocityGrid(dim, 48, 9.0)
    m, n = (gs.moments(bkw(dim).density(grid), grid) for grid in (radial, cartesian))
    for name in set(MOMENTS) - {"minimum"}:
        np.testing.assert_allclose(m[name], n[name], atol=1e-9, err_msg=name)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_laplacian_is_exact(dim):
    grid = gs.RadialGrid(dim, 40, 8.0)
    T = 0.8
    f = gs.load_scene(f"maxwellian{dim}d", temperature=T).density(grid)
    assert_near(grid.laplacian(f), f * (grid.nodes**2 / T**2 - dim / T), 1e-11)


@pytest.mark.parametrize("dim", [2, 3])
def test_evaluation_at_any_speed(dim):
    grid = gs.RadialGrid(dim, 40, 8.0)
    f = bkw(dim).density(grid)
    assert_near(grid.evaluate(f, grid.nodes), f, 1e-13)
    speeds = np.linspace(0.0, 7.0, 23)
    assert_near(grid.evaluate(f, speeds), bkw(dim).initial(speeds, *(0.0,) * (dim - 1)), 1e-11)
    assert np.all(grid.evaluate(f, [grid.L, 2 * grid.L]) == 0.0)


@pytest.mark.parametrize("dim", [2, 3])
def test_to_the_cartesian_grid_and_back(dim):
    grid = gs.RadialGrid(dim, 40, 6.5)
    cartesian = gs.VelocityGrid(dim, 48, 6.5)
    f = bkw(dim).density(grid)
    F = grid.to_cartesian(f, cartesian)
    assert_near(F, bkw(dim).density(cartesian), 1e-9)
    assert_near(grid.from_cartesian(F, cartesian), f, 1e-9)


@pytest.mark.parametrize("dim", [2, 3])
def test_from_the_cartesian_grid_the_mean_over_directions_is_taken(dim):
    u, T = 1.2, 0.7
    grid, cartesian = gs.RadialGrid(dim, 24, 8.0), gs.VelocityGrid(dim, 36, 8.0)
    velocity = (0.6 * u, -0.8 * u, 0.0)[:dim]
    scene = gs.load_scene(f"maxwellian{dim}d", temperature=T, velocity=velocity)
    mean = grid.from_cartesian(scene.density(cartesian), cartesian)
    x = grid.nodes * u / T
    angular = np.i0(x) if dim == 2 else np.sinh(x) / x
    exact = angular * np.exp(-(grid.nodes**2 + u**2) / (2 * T)) / (2 * np.pi * T) ** (dim / 2)
    inside = grid.nodes < 0.9 * cartesian.L
    assert_near(mean[inside], exact[inside], 1e-7)


@given(st.sampled_from([2, 3]), st.integers(4, 40), st.floats(0.1, 50.0))
def test_values_and_coefficients_are_one_to_one(dim, N, R):
    grid = gs.RadialGrid(dim, N, R)
    f = np.random.default_rng(N).normal(size=N)
    c = grid.analysis @ f
    np.testing.assert_allclose(grid.mode_values(grid.nodes) @ c, f, atol=1e-11)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ((4, 16, 7.0), "dim=4: allowed are 2 and 3"),
        ((3, 3, 7.0), "N=3: must be an integer of at least 4"),
        ((3, 16.0, 7.0), "N=16.0: must be an integer"),
        ((3, 16, -7.0), "R=-7.0: must be a positive number"),
    ],
)
def test_fields(fields, message):
    with pytest.raises(ValueError, match=message):
        gs.RadialGrid(*fields)


def test_a_matrix_between_values_and_coefficients_has_to_fit_in_memory(monkeypatch):
    monkeypatch.setattr("granstudy.support.machine.memory", lambda: 1e9)
    assert gs.RadialGrid(3, 11_000, 7.0).shape == (11_000,)
    with pytest.raises(ValueError, match="N=12000: takes about 1.15 GB of memory"):
        gs.RadialGrid(3, 12_000, 7.0)


def test_other_grids_and_shapes():
    grid, flat = gs.RadialGrid(3, 8, 7.0), gs.VelocityGrid(2, 8, 7.0)
    for convert, shape in ((grid.to_cartesian, 8), (grid.from_cartesian, (8, 8))):
        with pytest.raises(ValueError, match="Cartesian grid has dim 2: the radial grid has 3"):
            convert(np.ones(shape), flat)
    with pytest.raises(ValueError, match=r"shape \(7,\): the grid's is \(8,\)"):
        grid.evaluate(np.ones(7), grid.nodes)
    with pytest.raises(ValueError, match=r"shape \(8,\): the grid's is \(8, 8, 8\)"):
        grid.from_cartesian(np.ones(8), gs.VelocityGrid(3, 8, 7.0))
    with pytest.raises(ValueError, match="grid has dim 3: the scene has dim 2"):
        bkw(2).density(grid)


@pytest.mark.parametrize("dim", [2, 3])
def test_functions_of_the_laplacian(dim):
    grid = gs.RadialGrid(dim, 32, 8.0)
    r, T = grid.nodes, 0.8
    f = np.exp(-(r**2) / (2 * T))
    later = np.exp(-(r**2) / (2 * (T + 0.2))) * (T / (T + 0.2)) ** (dim / 2)
    assert np.max(np.abs(grid.laplacian_functions(0.1, [(np.exp, f)]) - later)) < 1e-12
    assert grid.gradient(f) == [] and len(grid.invariants()["momentum"]) == 0


@pytest.mark.parametrize("dim", [2, 3])
def test_local_dilation_converges(dim):
    off = []
    for N in (32, 64):
        grid = gs.RadialGrid(dim, N, 8.0)
        f = np.exp(-(grid.nodes**2) / 1.6)
        off.append(np.max(np.abs(grid.dilation(f) - (dim - grid.nodes**2 / 0.8) * f)))
    assert off[0] < 1e-4 and off[1] < 5e-6


@pytest.mark.parametrize("dim", [2, 3])
def test_moments_of_what_moves_are_exact_even_for_noise(dim):
    grid = gs.RadialGrid(dim, 40, 8.0)
    r, w = grid.nodes, grid.weights
    f = np.where(np.arange(40) < 32, np.random.default_rng(0).normal(size=40), 0.0)
    for degree in (0, 2, 4, 6):
        moment = r**degree * w
        assert abs(moment @ (grid.dilation(f) + degree * f)) < 1e-11 * (moment @ np.abs(f))


@pytest.mark.parametrize("dim", [2, 3])
def test_what_moves_stays_where_it_is(dim):
    grid = gs.RadialGrid(dim, 40, 8.0)
    places = np.flatnonzero(grid.dilation(np.eye(40)[30]))
    assert places.min() == 22 and places.max() == 38
    # no part of a density grows faster than the gas shrinks
    assert np.max(np.linalg.eigvals(grid.dilation(np.eye(40))).real) < dim
