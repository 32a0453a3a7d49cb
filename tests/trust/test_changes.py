"""The change of T and a2 against their differences."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.trust.changes import change_of_moments


def of(grid, f):
    m = gs.moments(f, grid)
    return float(np.log(m.temperature)), float(np.log1p(m.a2))


def assert_derivative(grid, f, change):
    h = 1e-5
    ahead, behind = of(grid, f + h * change), of(grid, f - h * change)
    derivative = (np.array(ahead) - behind) / (2 * h)
    found = change_of_moments(grid, f, change, scaling=0.3)
    assert found.temperature == pytest.approx(derivative[0] + 0.3, rel=1e-6, abs=1e-8)
    assert found.a2 == pytest.approx(derivative[1], rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (0.7, 0.0), (0.4, -0.9)], ids=str)
def test_it_is_the_derivative_of_the_moments(velocity):
    """For a gas of any mass that moves along an axis, aslant or not at all, and a change that moves it."""
    grid = gs.VelocityGrid(2, 32, 10.0)
    x, y = grid.velocities()
    c2 = (x - velocity[0]) ** 2 + 1.5 * (y - velocity[1]) ** 2
    f = 0.4 * np.exp(-c2 / 2) * (1.0 + 0.1 * (x - velocity[0]) ** 3 * np.exp(-c2 / 4))
    change = np.exp(-((x - 1.0) ** 2) - (y - 0.5) ** 2 / 2)
    assert_derivative(grid, f, change)


def test_it_is_the_derivative_where_the_momentum_has_a_component_that_is_exactly_zero():
    grid = gs.VelocityGrid(2, 8, 6.0)
    f = np.zeros(grid.shape)
    f[1, [3, 4]], f[5, [2, 5]] = 0.7, 0.4  # pairs of beams with opposite v_y
    x_momentum, y_momentum = grid.velocity_moments(f).momentum
    assert x_momentum != 0.0 and y_momentum == 0.0
    change = np.zeros(grid.shape)
    change[6, 3] = 0.2
    assert_derivative(grid, f, change)


@pytest.mark.parametrize("dim", [2, 3])
def test_it_is_the_derivative_of_the_moments_on_a_radial_grid(dim):
    grid = gs.RadialGrid(dim, 24, 8.0)
    f = np.exp(-(grid.nodes**2) / 2) * (1 + 0.1 * grid.nodes**4)
    assert_derivative(grid, f, np.exp(-(grid.nodes**2)) * (1 + grid.nodes**2))
