"""A run that is killed goes on from its checkpoint in the store; one that cannot be used is thrown away."""

import multiprocessing
import os
import signal
import time

import pytest

import granstudy as gs
from granstudy.datasets.storage.checkpoint import VARIABLE
from granstudy.runs import execute
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.execute import obtain
from granstudy.runs.run_key import run_key
from granstudy.runs.store import FORGOTTEN, Store
from granstudy.workbench.pruning import remove, unused

SCENE = gs.load_scene("maxwellian2d", restitution=0.5, diffusion=0.01)
RADIAL = gs.Solver(N=12, R=7.0, method="radial")
PARTICLES = gs.Solver(N=8, R=7.0, method="dsmc", particles=2000, batches=4)
TIME = {"t_final": 1.0, "dt": 0.05, "save_every": 5}
LONG = Computation("evolution", SCENE, RADIAL, TIME)
KINDS = {"grid": LONG, "particles": Computation("evolution", SCENE, PARTICLES, TIME)}


@pytest.fixture(autouse=True)
def every_step(monkeypatch):
    """Checkpoints after every step, also in other processes."""
    monkeypatch.setenv(VARIABLE, "0")


@pytest.fixture
def store(tmp_path):
    return Store.beside(tmp_path)


def stop_at(time):
    """Progress function that stops a run as ^C does."""

    def progress(done, total, reached):
        if reached >= time:
            raise KeyboardInterrupt

    return progress


def interrupt(computation, store, time=0.5):
    """Interrupt a run; it leaves a checkpoint in the store."""
    key = run_key(computation)
    with pytest.raises(KeyboardInterrupt):
        obtain(computation, key, store, progress=stop_at(time))
    assert key not in store and store.checkpoint(key).is_file()
    return key


def undisturbed(computation, folder):
    """The bytes of the file of a run in a store of its own."""
    store, key = Store(folder), run_key(computation)
    obtain(computation, key, store)
    return store.path(key).read_bytes()


def _compute_slowly(computation, folder):
    obtain(computation, run_key(computation), Store(folder), 1, lambda *_: time.sleep(0.1))


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_that_is_killed_goes_on(store, tmp_path, caplog, kind):
    computation = KINDS[kind]
    key = run_key(computation)
    spawn = multiprocessing.get_context("spawn")
    process = spawn.Process(target=_compute_slowly, args=(computation, store.folder))
    process.start()
    end = time.monotonic() + 60.0
    while not store.checkpoint(key).is_file() and time.monotonic() < end:
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.join()
    assert store.unfinished() == {key} and store.keys() == set()
    with caplog.at_level("INFO", logger="granstudy"):
        assert obtain(computation, key, store).computed
    assert f"goes on from {store.checkpoint(key)}" in caplog.text
    assert store.path(key).read_bytes() == undisturbed(computation, tmp_path / "other")
    assert store.unfinished() == set() and store.keys() == {key}


def test_it_goes_on_and_does_not_begin_anew(store, tmp_path):
    key, seen = interrupt(LONG, store, 0.5), []
    obtain(LONG, key, store, progress=lambda done, total, time: seen.append(done))
    assert seen == list(range(10, 21))
    assert store.path(key).read_bytes() == undisturbed(LONG, tmp_path / "other")


def test_a_checkpoint_stays_until_the_file_of_the_run_is_there(store, monkeypatch):
    key = interrupt(LONG, store)

    def full(*args, **more):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("granstudy.runs.store.write_dataset", full)
        with pytest.raises(OSError, match="No space"):
            obtain(LONG, key, store)
    assert store.checkpoint(key).is_file()
    obtain(LONG, key, store)
    assert not store.checkpoint(key).exists()


@pytest.mark.parametrize("content", ["damaged", "of another run", "of another kind", "empty"])
def test_what_cannot_be_used_is_thrown_away_and_the_log_says_so(store, tmp_path, caplog, content):
    key = interrupt(LONG, store)
    path = store.checkpoint(key)
    data = path.read_bytes()
    if content == "of another run":
        other = Computation("evolution", SCENE, RADIAL, TIME | {"dt": 0.1})
        data = store.checkpoint(interrupt(other, store)).read_bytes()
    path.write_bytes(
        {"damaged": data[:-1], "of another kind": b"\0" * 1000, "empty": b""}.get(content, data)
    )
    seen = []
    obtain(LONG, key, store, progress=lambda done, total, time: seen.append(done))
    assert seen == list(range(21))
    assert "the run starts anew" in caplog.text
    assert ("time.dt is 0.1 in the file and 0.05 here" in caplog.text) == (
        content == "of another run"
    )
    assert store.path(key).read_bytes() == undisturbed(LONG, tmp_path / "other")
    assert not path.exists()


def test_a_run_that_fails_after_all_leaves_no_checkpoint(store, monkeypatch):
    key = interrupt(LONG, store)

    def fail(*args):
        raise OverflowError("too large")

    monkeypatch.setattr(execute, "execute", fail)
    assert obtain(LONG, key, store).status == "failed"
    assert store.unfinished() == set()


def test_each_rung_of_a_ladder_has_a_checkpoint_of_its_own(store, tmp_path):
    ladder = Computation(
        "evolution", SCENE, RADIAL, TIME, refinement=Refinement("N", (12, 16, 20), 1e-9, 1e-9)
    )
    key = run_key(ladder)
    with pytest.raises(KeyboardInterrupt):
        obtain(ladder, key, store, progress=stop_at(0.5))
    assert store.unfinished() == {run_key(LONG)}
    obtain(ladder, key, store)
    assert store.unfinished() == set()
    assert store.path(key).read_bytes() == undisturbed(ladder, tmp_path / "other")


def test_prune_lists_and_removes_checkpoints_that_nobody_wants(store, tmp_path):
    key = interrupt(LONG, store)
    half = store.checkpoint(key).with_name(".partial-abc.checkpoint")
    half.write_bytes(b"half")  # as a process leaves it that is killed while it writes
    found = unused(tmp_path)
    assert found.keys == [key] and found.bytes == store.checkpoint(key).stat().st_size
    remove(tmp_path, found.keys)
    assert unused(tmp_path).keys == [] and not store.checkpoint(key).exists()
    store.sweep(age=60.0, now=time.time() + 1000.0)
    assert not half.exists()


def test_the_sweep_knows_checkpoints(store):
    key, other = interrupt(LONG, store), interrupt(KINDS["particles"], store)
    kept = store.checkpoint(key).read_bytes()
    obtain(LONG, key, store)
    store.checkpoint(key).write_bytes(kept)  # as a process leaves it that is killed just then
    store.sweep(age=60.0, now=time.time() + 1000.0)
    assert store.unfinished() == {other} and store.keys() == {key}
    store.sweep(age=60.0, now=time.time() + 1.01 * FORGOTTEN)
    assert store.unfinished() == set()
