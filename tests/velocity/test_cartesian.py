import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import granstudy as gs


def test_box_of_the_paper():
    # docs/method.md §2 gives L to four decimals
    for R, L in ((7.0, 7.7249), (7.8, 8.6078), (8.0, 8.8284)):
        assert gs.VelocityGrid(2, 32, R).L == pytest.approx(L, abs=1e-4)


@given(st.sampled_from([2, 3]), st.integers(2, 20).map(lambda n: 2 * n), st.floats(0.1, 50.0))
def test_nodes_are_cell_centres(dim, N, R):
    grid = gs.VelocityGrid(dim, N, R)
    assert grid.shape == (N,) * dim
    np.testing.assert_allclose(np.diff(grid.nodes), grid.spacing, rtol=1e-9)
    assert grid.nodes[0] == pytest.approx(-grid.L + grid.spacing / 2)
    np.testing.assert_allclose(grid.nodes, -grid.nodes[::-1], atol=1e-12 * R)
    assert grid.cell * N**dim == pytest.approx((2 * grid.L) ** dim)


def test_velocities_broadcast_to_the_shape():
    grid = gs.VelocityGrid(3, 4, 1.0)
    v = grid.velocities()
    assert [vi.shape for vi in v] == [(4, 1, 1), (1, 4, 1), (1, 1, 4)]
    assert np.broadcast_shapes(*(vi.shape for vi in v)) == grid.shape


@pytest.mark.parametrize("dim", [2, 3])
def test_wavenumbers_are_in_the_order_of_the_transform(dim):
    grid = gs.VelocityGrid(dim, 8, 2.0)
    assert grid.wavenumbers.tolist() == [0, 1, 2, 3, -4, -3, -2, -1]
    k2 = grid.wavenumber_squared()
    assert k2.shape == grid.shape
    assert k2[(1, 5, 2)[:dim]] == (1 + 9 + 4 if dim == 3 else 1 + 9)
    assert np.array_equal(grid.wavenumber_squared(half=True), k2[..., :5])
    # e^{iπk·v/L} on the nodes is one entry of the spectrum
    phase = sum(k * v for k, v in zip((2, -3, 1), grid.velocities(), strict=False))
    wave = np.exp(1j * np.pi / grid.L * phase)
    spectrum = np.abs(np.fft.fftn(wave)) / wave.size
    assert spectrum[(2, -3, 1)[:dim]] == pytest.approx(1.0)
    assert spectrum.sum() == pytest.approx(1.0)


def gaussian(grid, u=0.4, T=1.2):
    """A Gaussian that moves along the first axis."""
    c = [v - (u if i == 0 else 0.0) for i, v in enumerate(grid.velocities())]
    return np.exp(-sum(ci**2 for ci in c) / (2 * T)), c, T


@pytest.mark.parametrize(("dim", "N"), [(2, 40), (3, 32)])
def test_derivatives_and_dilation_are_exact_for_what_the_grid_holds(dim, N):
    grid = gs.VelocityGrid(dim, N, 8.0)
    f, c, T = gaussian(grid)
    tolerance = 1e-9 if dim == 2 else 1e-6
    for slope, ci in zip(grid.gradient(f), c, strict=True):
        assert np.max(np.abs(slope + ci / T * f)) < tolerance
    v = grid.velocities()
    dilated = dim * f - sum(vi * ci for vi, ci in zip(v, c, strict=True)) / T * f
    assert np.max(np.abs(grid.dilation(f) - dilated)) < 10 * tolerance
    # complex states, of the literal method
    assert np.max(np.abs(grid.dilation(f * (1 + 2j)) - (1 + 2j) * grid.dilation(f))) < 1e-12


@pytest.mark.parametrize("N", [16, 32])
def test_dilation_neither_grows_nor_piles_up(N):
    """In L² it grows by d/2, as on an unbounded space, whatever lies at the border."""
    grid = gs.VelocityGrid(2, N, 8.0)
    f = np.random.default_rng(0).normal(size=grid.shape)
    assert np.sum(f * grid.dilation(f)) == pytest.approx(np.sum(f * f), rel=1e-12)
    assert 0.7 * np.pi * N / 2 < grid.largest_dilation < 1.5 * np.pi * N / 2


def test_functions_of_the_laplacian():
    grid = gs.VelocityGrid(2, 40, 8.0)
    f, _, T = gaussian(grid)
    later = gaussian(grid, T=T + 0.2)[0] * T / (T + 0.2)
    assert np.max(np.abs(grid.laplacian_functions(0.1, [(np.exp, f)]) - later)) < 1e-9
    both = grid.laplacian_functions(0.1, [(np.exp, f), (np.exp, -2 * f)])
    assert np.max(np.abs(both + later)) < 1e-9
    wave = np.cos(20 * np.pi * (grid.velocities()[0] - grid.nodes[0]) / grid.L) * np.ones(
        grid.shape
    )
    wave *= np.cos(20 * np.pi * (grid.velocities()[1] - grid.nodes[0]) / grid.L)
    ratio = np.sum(wave * grid.laplacian(wave)) / np.sum(wave**2)
    assert ratio == pytest.approx(-grid.largest_laplacian, rel=1e-12)
