"""What runs are held against: another run, or particles with their standard errors."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.trust.truth import errors, truth_of_dataset


def test_a_truth_has_to_share_times_and_to_end():
    scene = gs.load_scene("maxwellian2d", kernel=gs.hard_spheres(2), restitution=0.4, diffusion=0.0)
    solver = gs.Solver(N=24, R=9.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=2.0, dt=0.1, frame="fixed", progress=False)
    truth = truth_of_dataset(ds)
    assert errors(ds, truth) == (0.0, 0.0)
    with pytest.raises(ValueError, match="truth: has no time in common.*give time.times"):
        errors(ds.assign_coords(time=ds["time"] * 1.01), truth)
    ended = ds.copy()
    ended["status"] = ended["status"] + np.int8(2)
    with pytest.raises(ValueError, match="truth: its run diverged"):
        truth_of_dataset(ended)
    # a run that stopped early counts up to there
    assert errors(ds.isel(time=slice(0, 5)), truth) == (0.0, 0.0)


def test_particles_as_truth_know_their_standard_errors():
    scene = gs.load_scene("maxwellian2d", restitution=0.5)
    solver = gs.Solver(N=16, R=8.0, method="dsmc", particles=4000, batches=4)
    ds = gs.simulate(scene, solver, t_final=1.0, time_rtol=1e-3, times=[0.5], progress=False)
    truth = truth_of_dataset(ds)
    relative = ds["temperature_standard_error"] / ds["temperature"]
    assert truth.temperature_uncertainty == float(relative.max())
    assert truth.source == "dsmc, 4,000 particles"
