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
