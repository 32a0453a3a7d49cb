"""Velocities drawn from a density are distributed like the density."""

import numpy as np
import pytest
from scipy import stats

import granstudy as gs
from granstudy.particles.sampling import Sampler, quiet


def sampler(initial, dim, N=16, R=6.0):
    scene = gs.Scene(dim=dim, initial=initial, kernel=gs.maxwell(dim))
    return Sampler(scene, gs.VelocityGrid(dim, N, R))


def ball(*v):
    return np.where(sum(vi**2 for vi in v) < 4.0, 1.0, 0.0)


@pytest.mark.parametrize(
    ("name", "dim"), [("bkw2d", 2), ("double_well2d", 2), ("bkw3d", 3), ("three_gaussians3d", 3)]
)
def test_cells_are_hit_in_proportion_to_their_mass(name, dim):
    n = 40_000
    v = sampler(name, dim).draw(n, np.random.default_rng(1))
    assert v.shape == (n, dim)
    grid = gs.VelocityGrid(dim, 16, 6.0)
    counts, _ = np.histogramdd(v, bins=8, range=[(-grid.L, grid.L)] * dim)
    # The mass of each of 8^d cells by the midpoint rule on 16 points a side and more.
    fine = gs.VelocityGrid(dim, 128 if dim == 2 else 64, 6.0)
    mass = gs.Scene(dim=dim, initial=name, kernel=gs.maxwell(dim)).density(fine)
    for axis in range(dim):
        mass = np.add.reduceat(mass, np.arange(0, fine.N, fine.N // 8), axis=axis)
    expected = n * mass / mass.sum()
    often = expected > 10.0
    observed = np.append(counts[often], counts[~often].sum())
    expected = np.append(expected[often], expected[~often].sum())
    assert len(expected) > 10
    assert stats.chisquare(observed, expected * observed.sum() / expected.sum()).pvalue > 1e-3


@pytest.mark.parametrize("dim", [2, 3])
def test_a_discontinuous_density(dim):
    # Mass that no corner of a cell sees is found, too.
    v = sampler(ball, dim, N=10).draw(40_000, np.random.default_rng(2))
    speeds = np.linalg.norm(v, axis=1)
    assert speeds.max() < 2.0
    assert stats.kstest((speeds / 2.0) ** dim, "uniform").pvalue > 1e-3


def test_majorants_need_not_be_bounds():
    # A spike narrower than a cell, of which the grid sees one corner at most: twice the density, not half.
    def spike(*v):
        squared = sum((vi - 0.1) ** 2 for vi in v)
        return np.exp(-sum(vi**2 for vi in v) / 2) / (2 * np.pi) + 20 * np.exp(-squared / 0.002)

    v = sampler(spike, 2, N=16).draw(200_000, np.random.default_rng(3))
    inside = np.sum((v - 0.1) ** 2, axis=1) < 0.02
    mass = 20 * np.pi * 0.002 * (1 - np.exp(-10.0)) + (np.pi * 0.02) / (2 * np.pi)
    expected = mass / (1.0 + 20 * np.pi * 0.002)
    assert inside.mean() == pytest.approx(expected, rel=0.05)
    assert len(np.unique(v, axis=0)) < len(v)


def test_a_quiet_start_has_the_covariance_asked_for():
    wanted = np.array([[2.0, 0.3, 0.0], [0.3, 1.0, -0.2], [0.0, -0.2, 0.5]])
    c = quiet(np.random.default_rng(4).normal(3.0, 1.0, (50, 3)), wanted)
    assert np.abs(c.mean(axis=0)).max() < 1e-14
    assert np.abs(c.T @ c / 50 - wanted).max() < 1e-14


@pytest.mark.parametrize(
    ("initial", "message"),
    [
        (lambda vx, vy: np.exp(-(vx**2) - vy**2) * (1 - vx), "nowhere negative; this one falls to"),
        (
            lambda vx, vy: np.exp(-(vx**2) - vy**2)[:16, :16],
            "must return finite values of the shape",
        ),
    ],
)
def test_mistakes(initial, message):
    with pytest.raises(ValueError, match=message):
        sampler(initial, 2)


def test_a_density_narrower_than_a_cell():
    with pytest.raises(ValueError, match="is not positive definite; take a larger N"):
        quiet(np.random.default_rng(5).normal(size=(50, 2)), np.zeros((2, 2)))
