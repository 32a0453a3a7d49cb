"""Restitution by table against the law itself."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.particles.collisions import alpha_at
from granstudy.particles.restitution_table import alpha_table


def at(speeds, law, R=7.0):
    alphas, top = alpha_table(law, R)
    return np.array([alpha_at(speed, alphas, top) for speed in speeds])


def test_a_viscoelastic_law_over_fifteen_decades():
    law = gs.Viscoelastic(0.3)
    speeds = np.geomspace(1e-14, 28.0, 5001)
    assert np.abs(at(speeds, law) - (1 + law(speeds)) / 4).max() < 1e-6 / 4


def test_a_linear_law_is_itself():
    def law(v):
        return 1 - v / 100

    speeds = np.random.default_rng(0).uniform(0.0, 28.0, 1000)
    assert np.abs(at(speeds, law) - (1 + law(speeds)) / 4).max() < 1e-15


def test_beyond_its_ends_it_keeps_its_value():
    law = gs.Viscoelastic(0.3)
    low, high = at([0.0, 100.0], law)
    assert high == (1 + law(28.0)) / 4
    assert low == pytest.approx(0.5, abs=1e-4)


def test_a_law_that_leaves_its_range():
    with pytest.raises(ValueError, match="impact speeds up to 28"):
        alpha_table(lambda v: 1 - 0.1 * v, 7.0)
