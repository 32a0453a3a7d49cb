"""Densities over velocities, from the dataset of a run."""

import pytest

import granstudy as gs

GOOD_SOLVER = {"N": 8, "R": 7.0}


def test_a_density_that_was_not_kept():
    scene = gs.load_scene("bkw2d", restitution=0.5)
    ds = gs.simulate(scene, gs.Solver(**GOOD_SOLVER), t_final=0.1, dt=0.1, progress=False)
    with pytest.raises(ValueError, match="holds no density: give simulate save_every"):
        gs.physical_density(ds)
