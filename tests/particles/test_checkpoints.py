"""A run by particles that is interrupted and goes on has the bytes of one that was not."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

import granstudy as gs
from granstudy.datasets.storage.checkpoint import VARIABLE
from granstudy.particles.batch import Batch


def softening(v):
    """A law that leaves [0, 1] at 20."""
    return 1.0 - v / 20


BOX = {"N": 8, "R": 7.0, "method": "dsmc", "particles": 400, "batches": 4}
RUNS = {
    "hard spheres, heated": (
        gs.load_scene("maxwellian3d", restitution=0.7, kernel=gs.hard_spheres(3), diffusion=0.05),
        gs.Solver(**BOX),
    ),
    "plane": (gs.load_scene("double_well2d", restitution=0.5, diffusion=0.0), gs.Solver(**BOX)),
    "law": (
        gs.load_scene("maxwellian3d", restitution=gs.Viscoelastic(0.2), diffusion=0.0),
        gs.Solver(**BOX),
    ),
    "hard impact": (
        gs.load_scene("maxwellian2d", restitution=softening, diffusion=5.0),
        gs.Solver(**BOX | {"R": 4.0}),
    ),
}
TIMES = {"t_final": 2.0, "dt": 0.25, "save_every": 3, "progress": False}


class StoppedError(Exception):
    """A batch was interrupted."""


class Runs:
    """Runs of `RUNS`, of which one advance of a batch may be interrupted."""

    def __init__(self, folder, monkeypatch):
        self.folder, self.checkpoint = folder, folder / "checkpoint"
        self.made, self.at = 0, None
        advance = Batch.advance

        def counted(batch, duration):
            self.made += 1
            if self.made == self.at:
                raise StoppedError
            advance(batch, duration)

        monkeypatch.setattr(Batch, "advance", counted)

    def dataset(self, name, at=None, threads=1):
        self.made, self.at = 0, at
        scene, solver = RUNS[name]
        solver = replace(solver, threads=threads)
        return gs.simulate(scene, solver, **TIMES, checkpoint=self.checkpoint)

    def bytes(self, name, **how):
        path = self.folder / "run.nc"
        gs.write_dataset(self.dataset(name, **how), path)
        return path.read_bytes()


@pytest.fixture
def runs(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "0")
    return Runs(tmp_path, monkeypatch)


@pytest.mark.parametrize("name", RUNS)
def test_a_run_that_goes_on_has_the_bytes_of_one_undisturbed(runs, name):
    undisturbed = runs.bytes(name)
    whole = runs.made
    for at in np.unique(np.linspace(2, whole, 5, dtype=int)):
        with pytest.raises(StoppedError):
            runs.dataset(name, at=at)
        assert runs.checkpoint.exists()
        assert runs.bytes(name, threads=2) == undisturbed
        assert runs.made <= whole - at + 1
        assert not runs.checkpoint.exists()


def test_a_run_ends_early_after_going_on(runs):
    ds = runs.dataset("hard impact")
    assert "is beyond 4R = 16" in ds["status"].attrs["reason"] and 2 < ds.sizes["time"] < 9


def test_batches_that_are_interrupted_at_times_of_their_own(runs):
    name = "hard spheres, heated"
    undisturbed = runs.bytes(name)
    for at in (7, 5, 4, 3):
        # While one batch is interrupted, others go on for as long as they are let.
        with suppress(StoppedError):
            runs.dataset(name, at=at, threads=3)
            break
    assert runs.bytes(name) == undisturbed
