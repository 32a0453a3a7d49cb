"""Laplacian and spectral tail against sums of single waves."""

import numpy as np
import pytest

import granstudy as gs


@pytest.mark.parametrize("dim", [2, 3])
def test_the_largest_eigenvalue_of_the_radial_laplacian(dim):
    grid = gs.RadialGrid(dim, 12, 6.0)
    matrix = np.stack([grid.laplacian(one) for one in np.eye(12)], axis=1)
    largest = np.max(np.abs(np.linalg.eigvals(matrix)))
    assert grid.largest_laplacian == pytest.approx(largest, rel=1e-9)


@pytest.mark.parametrize("axis", [0, 1])
def test_waves_along_either_axis_count_alike_in_the_tail(axis):
    """The last axis of a real transform has half the modes, which stand for two each: all but the ends."""
    N = 16
    grid = gs.VelocityGrid(2, N, 6.0)
    x = 2 * np.pi * np.arange(N) / N
    for high, share in (
        (6, 0.0),
        (7, 1.0),
        (8, 2.0),
    ):  # 6 = 3N/8 is low; the wave ±1 has twice the square
        f = 1.0 + 0.6 * np.cos(2 * x) + 0.8 * np.cos(high * x)
        square = 1.0 + 0.18 + 0.32 * max(share, 1.0)
        f = np.moveaxis(f[:, None] * np.ones((N, N)), 0, axis)
        assert grid.spectral_tail(f) == pytest.approx(0.32 * share / square, abs=1e-14)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_radial_tail_begins_with_the_last_quarter_of_the_modes(dim):
    grid = gs.RadialGrid(dim, 16, 6.0)
    modes = grid.mode_values(grid.nodes)
    assert grid.spectral_tail(modes[:, 11]) == pytest.approx(0.0, abs=1e-14)
    assert grid.spectral_tail(modes[:, 12]) == pytest.approx(1.0, abs=1e-14)
