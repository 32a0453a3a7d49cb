"""Interpolation is exact for what it is of: waves and modes of a grid, polynomials."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.reading.weights import line_weights, speed_weights, trigonometric_weights


def test_trigonometric_weights_are_exact_for_what_the_nodes_represent():
    nodes = -3.0 + 0.5 * (np.arange(12) + 0.5)
    for x in (0.0, 0.13, nodes[3], nodes[3] + 1e-15):
        for k in range(6):
            wave = np.cos(2 * np.pi * k * nodes / 6.0 + 0.4)
            assert trigonometric_weights(nodes, x) @ wave == pytest.approx(
                np.cos(2 * np.pi * k * x / 6.0 + 0.4)
            )


@pytest.mark.parametrize("method", ["spectral", "local"])
def test_a_line_has_its_own_values_at_its_nodes_and_nothing_outside(method):
    grid = gs.VelocityGrid(2, 24, 8.0)
    np.testing.assert_allclose(line_weights(grid, grid.nodes, method), np.eye(24), atol=1e-12)
    assert not line_weights(grid, np.array([-3 * grid.L, np.inf, np.nan]), method).any()


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("method", ["spectral", "local"])
def test_speeds_have_their_own_values_at_the_nodes(dim, method):
    grid = gs.RadialGrid(dim, 20, 8.0)
    np.testing.assert_allclose(speed_weights(grid, grid.nodes, method), np.eye(20), atol=1e-11)
    assert not speed_weights(grid, np.array([2 * grid.L]), method).any()


def test_local_polynomials_are_exact_in_degree_15():
    grid = gs.VelocityGrid(2, 32, 8.0)
    x = np.linspace(-1.0, 1.0, 7)
    for degree in range(16):
        f = (grid.nodes / grid.L) ** degree
        np.testing.assert_allclose(
            line_weights(grid, x, "local") @ f, (x / grid.L) ** degree, atol=1e-12
        )


@pytest.mark.parametrize("dim", [2, 3])
def test_local_speeds_know_that_densities_are_even(dim):
    grid = gs.RadialGrid(dim, 60, 8.0)
    x = np.array([0.0, 0.05, 0.3])
    f = np.exp(-(grid.nodes**2) / 2)
    np.testing.assert_allclose(speed_weights(grid, x, "local") @ f, np.exp(-(x**2) / 2), rtol=1e-9)


@pytest.mark.parametrize("grid", [gs.VelocityGrid(2, 48, 12.0), gs.RadialGrid(3, 40, 10.0)])
def test_a_tail_keeps_its_digits_only_by_local_polynomials(grid):
    weights = line_weights if isinstance(grid, gs.VelocityGrid) else speed_weights
    # a cusp at 0, of which a series keeps a trace everywhere
    f, x = np.exp(-2.0 * np.abs(grid.nodes)), np.array([6.2, 7.3])
    exact = np.exp(-2.0 * x)
    errors = {m: np.abs(weights(grid, x, m) @ f / exact - 1.0).max() for m in ("spectral", "local")}
    assert errors["local"] < 1e-4 < 1e-2 < errors["spectral"]


def test_an_unknown_method_is_refused():
    with pytest.raises(ValueError, match="method='cubic': allowed are spectral, local"):
        line_weights(gs.VelocityGrid(2, 8, 7.0), np.zeros(1), "cubic")
