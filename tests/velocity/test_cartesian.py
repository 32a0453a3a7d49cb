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


@pytest.mark.parametrize("dim", [2, 3])
def test_local_derivatives_and_dilation_converge(dim):
    off = []
    for N in (24, 48):
        grid = gs.VelocityGrid(dim, N, 8.0)
        f, c, T = gaussian(grid)
        slopes = grid.gradient(f)
        off.append([np.max(np.abs(s + ci / T * f)) for s, ci in zip(slopes, c, strict=True)])
        v = grid.velocities()
        dilated = dim * f - sum(vi * ci for vi, ci in zip(v, c, strict=True)) / T * f
        off[-1].append(np.max(np.abs(grid.dilation(f) - dilated)))
    assert np.max(off[1]) < 1e-5
    # of order 16 in the spacing
    assert np.all(np.log2(np.divide(*off)) > 10.0)
    # complex states, of the literal method
    assert np.max(np.abs(grid.dilation(f * (1 + 2j)) - (1 + 2j) * grid.dilation(f))) < 1e-12


@pytest.mark.parametrize("dim", [2, 3])
def test_moments_of_what_moves_are_exact_even_for_noise(dim):
    grid = gs.VelocityGrid(dim, 24, 8.0)
    inside = (slice(8, -8),) * dim
    f = np.zeros(grid.shape)
    f[inside] = np.random.default_rng(0).normal(size=f[inside].shape)
    x, y = grid.velocities()[:2]
    # φ of degree n and of degree m in x: v·∇φ = nφ, ∂φ/∂x = mφ/x
    for phi, degree, in_x in (
        (np.ones_like(f), 0, 0),
        (x**2 * y**2 + 0 * f, 4, 2),
        (x**6 + 0 * f, 6, 6),
        (x**9 * y + 0 * f, 10, 9),
    ):
        size = np.sum(np.abs(phi * f))
        assert abs(np.sum(phi * (grid.dilation(f) + degree * f))) < 1e-11 * size
        assert abs(np.sum(phi * (grid.gradient(f)[0] + in_x / x * f))) < 1e-11 * size


def test_what_moves_stays_where_it_is():
    """Noise in one place reaches 8 nodes: noise at the border does not get into the gas, nor the reverse."""
    grid = gs.VelocityGrid(2, 32, 8.0)
    f = np.zeros(grid.shape)
    f[20, 3] = 1.0
    places = np.argwhere(grid.dilation(f))
    assert np.max(np.abs(places - [20, 3])) == 8
    assert 0.3 * np.pi * grid.N / 2 < grid.largest_dilation < 1.5 * np.pi * grid.N / 2


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
