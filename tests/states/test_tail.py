"""Tails of densities on radial grids, without the oscillations of the last modes."""

import numpy as np

import granstudy as gs
from granstudy.states.tail import filtered_values


def test_a_filter_takes_away_what_a_sharp_top_leaves_far_out():
    """A power law below the oscillations that its own top makes: it is seen by the filter alone."""
    grid, speeds = gs.RadialGrid(3, 64, 16.0), np.linspace(10.0, 12.0, 21)
    g, exact = ((1.0 + v**2) ** -4.0 for v in (grid.nodes, speeds))
    assert np.max(np.abs(grid.evaluate(g, speeds) / exact - 1.0)) > 1.0
    np.testing.assert_allclose(filtered_values(grid, g, speeds), exact, rtol=1e-2)
