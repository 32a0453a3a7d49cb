"""A run that is interrupted and goes on from its checkpoint has the bytes of one that was not."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import granstudy as gs
from granstudy.collision.fast.adaptive import retuning
from granstudy.datasets.storage import checkpoint
from granstudy.datasets.storage.checkpoint import VARIABLE, Checkpoint, CheckpointError
from granstudy.evolution import evolve, simulate
from granstudy.evolution.schemes import SCHEMES


def drifting(vx, vy):
    """A gas of no symmetry, with a bulk velocity."""
    wide = np.exp(-((vx - 0.3) ** 2) / 3 - vy**2 / 2)
    return (wide + np.exp(-(vx**2) / 2 - (vy + 0.2 * vx) ** 2 / 2)) / 14


def beams(vx, vy):
    """Two beams; what is left of them when they have merged needs fewer nodes."""
    return (np.exp(-((vx - 1.6) ** 2) - vy**2) + np.exp(-((vx + 1.6) ** 2) - vy**2)) / 6.28


def narrow(vx, vy):
    """A gas too narrow for `ROUGH`."""
    return np.exp(-((vx - 0.3) ** 2) / 2 - vy**2) + np.exp(-(vx**2) - 2 * vy**2)


HEATED = gs.load_scene("bkw3d", kernel=gs.hard_spheres(3), restitution=0.2, diffusion=0.01)
DRIFTING = gs.Scene(2, drifting, kernel=gs.VHS(1.0, 0.2), restitution=0.6, diffusion=0.02)
RADIAL = gs.Solver(N=14, R=7.0, method="radial")
PLANE = gs.Solver(N=16, R=8.0, N_rho=10, M_cir=10)
ROUGH = gs.Solver(N=16, R=7.0, N_rho=4, M_cir=4)
TUNED, RETUNED = gs.Solver(N=32, R=8.0, rtol=1e-3), {"t_final": 2.0, "time_rtol": 1e-3}
FIXED, ADAPTIVE = {"t_final": 0.4, "dt": 0.1}, {"t_final": 2.0, "time_rtol": 1e-5, "times": [1.0]}
RESCALED, ALL = {"frame": "rescaled"}, {"conserve": ("mass", "momentum", "energy")}

RUNS = {
    f"{scheme} {frame} {'adaptive' if 'time_rtol' in time else 'fixed'}": (
        HEATED,
        RADIAL,
        time | {"scheme": scheme, "frame": frame, "save_every": 2},
    )
    for scheme in SCHEMES
    for frame in ("fixed", "rescaled")
    for time in (FIXED, ADAPTIVE)
} | {
    "conserving": (DRIFTING, PLANE, ADAPTIVE | RESCALED | ALL),
    "drifting": (DRIFTING, PLANE, ADAPTIVE | RESCALED | {"save_every": 1}),
    "literal": (DRIFTING, replace(PLANE, method="literal"), ADAPTIVE | {"save_every": 1}),
    "single": (DRIFTING, replace(PLANE, precision="single"), FIXED | {"save_every": 1}),
    "law": (
        replace(DRIFTING, restitution=gs.Viscoelastic(0.3), diffusion=0.0),
        PLANE,
        FIXED | RESCALED,
    ),
    "carleman": (
        gs.load_scene("double_well2d", restitution=1.0, diffusion=0.01),
        replace(PLANE, method="carleman"),
        ADAPTIVE,
    ),
    "tuned": (gs.Scene(2, beams, gs.VHS(1.0, 0.3), 0.9, diffusion=0.05), TUNED, RETUNED),
    "diverging": (replace(HEATED, diffusion=0.4), RADIAL, {"t_final": 20.0, "dt": 1.0}),
    "lost": (replace(HEATED, diffusion=0.0), RADIAL, {"t_final": 100.0, "time_rtol": 1e-3}),
    "stopping": (replace(DRIFTING, initial=narrow), ROUGH, ADAPTIVE | RESCALED),
}
"""Scene, solver and time by name: every scheme, frame and kind of steps, and what else has a state."""


class Runs:
    """Runs of `RUNS` into a folder, of which evaluations of Q are counted, and one may be interrupted."""

    def __init__(self, folder, monkeypatch):
        self.folder, self.checkpoint = folder, folder / "checkpoint"
        self.made, self.at = 0, None
        collisions = evolve.collisions
        monkeypatch.setattr(evolve, "collisions", lambda op: self._counted(collisions(op)))

    def _counted(self, Q):
        def counted(state):
            self.made += 1
            if self.made == self.at:
                raise KeyboardInterrupt
            return Q(state)

        return counted

    @property
    def near(self):
        """Whether the interruption is near: within three steps or so."""
        return self.at is not None and self.made > self.at - 20

    def interrupt(self, name, at, **changes):
        """Interrupt a run at an evaluation; it leaves a checkpoint."""
        with pytest.raises(KeyboardInterrupt):
            self.dataset(name, at, **changes)
        assert self.checkpoint.exists()

    def dataset(self, name, at=None, **changes):
        """The dataset of a run, which goes on where there is a checkpoint."""
        self.made, self.at = 0, at
        scene, solver, time = RUNS[name]
        time = time | {"progress": False, "checkpoint": self.checkpoint} | changes
        return gs.simulate(scene, solver, **time)

    def bytes(self, name):
        """The bytes of the file of that dataset."""
        path = self.folder / "run.nc"
        gs.write_dataset(self.dataset(name), path)
        return path.read_bytes()


@pytest.fixture
def runs(tmp_path, monkeypatch):
    monkeypatch.setattr(retuning, "CHECK_EVERY", 10)
    runs = Runs(tmp_path, monkeypatch)
    # A file a step takes far longer than the steps: the last ones before an interruption do.
    monkeypatch.setattr(Checkpoint, "due", lambda one: runs.near)
    return runs


@pytest.mark.parametrize("name", RUNS)
def test_a_run_that_goes_on_has_the_bytes_of_one_undisturbed(runs, name):
    undisturbed = runs.bytes(name)
    whole = runs.made
    assert not runs.checkpoint.exists()
    for part in (0.3, 0.9):
        runs.interrupt(name, round(part * whole))
        if part == 0.9:
            runs.interrupt(name, 2)  # and once more, in the next step
        assert runs.bytes(name) == undisturbed
        assert 0 < runs.made <= (1 - part) * whole + 10
        assert not runs.checkpoint.exists()


def test_the_runs_have_the_endings_that_they_are_here_for(runs):
    reasons = {name: runs.dataset(name).status.attrs["reason"] for name in RUNS}
    assert {name for name, reason in reasons.items() if reason} == {"diverging", "lost", "stopping"}
    assert "the step fell to" in reasons["stopping"]
    plans = json.loads(runs.dataset("tuned").attrs["quadrature"])
    assert len({plan["nodes"] for plan in plans}) > 1


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    name=st.sampled_from([name for name, (_, solver, _) in RUNS.items() if solver is RADIAL]),
    parts=st.lists(st.floats(0.0, 1.0), min_size=1, max_size=4),
)
def test_wherever_and_however_often_it_is_interrupted(runs, name, parts):
    undisturbed = runs.bytes(name)
    whole = runs.made
    for part in parts:
        try:
            runs.dataset(name, max(1, round(part * whole / len(parts))))
        except KeyboardInterrupt:
            continue
    assert runs.bytes(name) == undisturbed


@pytest.mark.parametrize("text", ["soon", "-1", "nan"])
def test_seconds_that_are_none_are_refused(runs, monkeypatch, text):
    monkeypatch.setenv(VARIABLE, text)
    with pytest.raises(ValueError, match=f"{VARIABLE}='{text}': must be seconds of at least 0"):
        runs.dataset("dopri54 fixed fixed")


def test_a_checkpoint_of_another_run_is_refused_and_says_what_differs(runs):
    runs.interrupt("rk3 fixed fixed", 10)
    kept = runs.checkpoint.read_bytes()
    with pytest.raises(
        CheckpointError,
        match=r"is of another run: time.dt is 0.1 in the file and 0.05 here; time.scheme is 'rk3' in the "
        r"file and 'dopri54' here. Name another file, or delete this one",
    ):
        runs.dataset("rk3 fixed fixed", dt=0.05, scheme="dopri54")
    with pytest.raises(CheckpointError, match=r"run: scene.dim is 3 .* and \d+ more. Name"):
        runs.dataset("conserving")
    assert runs.checkpoint.read_bytes() == kept


def test_a_checkpoint_of_other_code_is_refused(runs, monkeypatch):
    runs.interrupt("rk3 fixed fixed", 10)
    monkeypatch.setattr(simulate, "fingerprint", lambda modules: "of today")
    with pytest.raises(CheckpointError, match="code is '[0-9a-f]{16}' in the file and 'of today'"):
        runs.dataset("rk3 fixed fixed")


def test_a_file_of_another_kind_is_never_overwritten(runs):
    runs.checkpoint.write_text("a year of notes")
    with pytest.raises(CheckpointError, match="is a file of another kind; name another file"):
        runs.dataset("rk3 fixed fixed")
    assert runs.checkpoint.read_text() == "a year of notes"


@pytest.mark.parametrize("path", ["", 5, True])
def test_a_path_that_is_none_is_refused(runs, path):
    with pytest.raises(ValueError, match=f"checkpoint={path!r}: must be the path of a file"):
        runs.dataset("rk3 fixed fixed", checkpoint=path)


@pytest.mark.parametrize("damage", ["cut", "flipped", "emptied"])
def test_a_damaged_checkpoint_is_ignored_and_the_log_says_so(runs, caplog, damage):
    name = "exponential rescaled adaptive"
    undisturbed = runs.bytes(name)
    whole = runs.made
    runs.interrupt(name, whole // 2)
    data = bytearray(runs.checkpoint.read_bytes())
    if damage == "flipped":
        data[2 * len(data) // 3] ^= 1
    runs.checkpoint.write_bytes(data[: {"cut": -1, "flipped": len(data), "emptied": 0}[damage]])
    assert runs.bytes(name) == undisturbed and runs.made == whole
    assert "this checkpoint is damaged: the run starts anew" in caplog.text


def test_a_full_disk_does_not_stop_a_run(runs, monkeypatch, caplog):
    undisturbed = runs.bytes("rk3 fixed fixed")

    def full(path, write):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(checkpoint, "write_whole", full)
    monkeypatch.setattr(Checkpoint, "due", lambda one: True)
    ds = runs.dataset("rk3 fixed fixed")
    monkeypatch.undo()
    gs.write_dataset(ds, runs.folder / "full.nc")
    assert (runs.folder / "full.nc").read_bytes() == undisturbed
    assert "cannot write a checkpoint: [Errno 28] No space left on device" in caplog.text
