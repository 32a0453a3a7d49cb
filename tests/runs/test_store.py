"""The store: every run once, whoever asks for it, and nothing but whole runs."""

import multiprocessing
import threading
import time

import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy.datasets.netcdf import write_dataset
from granstudy.runs import execute
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.execute import obtain
from granstudy.runs.run_key import run_key, rung_keys
from granstudy.runs.store import Store, is_link, link, sidecar


def cooling(e=0.5, **solver):
    """A tiny evolution."""
    settings = {"N": 12, "R": 7.0, "method": "radial"} | solver
    scene = gs.load_scene("maxwellian2d", restitution=e, diffusion=0.0)
    return Computation("evolution", scene, gs.Solver(**settings), {"t_final": 0.1, "dt": 0.05})


def ladder_of_N(*values, temperature=1e-4, a2=1e-3):
    return Refinement("N", values, temperature, a2)


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "store")


@pytest.fixture
def computed(monkeypatch):
    """Computations that were made, in their order."""
    made = []
    compute = execute.execute
    monkeypatch.setattr(
        execute, "execute", lambda one, *more: made.append(one) or compute(one, *more)
    )
    return made


def test_a_run_is_computed_once_and_then_found(store, computed):
    one = cooling()
    key = run_key(one)
    assert key not in store
    first, second = obtain(one, key, store), obtain(cooling(), key, store)
    assert len(computed) == 1 and first.computed and not second.computed
    assert (first.status, first.trust, first.label) == (second.status, second.trust, second.label)
    assert store.keys() == {key} and key in store
    assert store.read(key).attrs["run_key"] == key


@pytest.mark.fault("C6")
def test_what_is_equal_has_one_key_however_it_is_written():
    scene = gs.load_scene("maxwellian2d", restitution=0.5, diffusion=0.0)
    solver = gs.Solver(N=12, R=7.0, method="radial")
    ways = [
        {"t_final": 1, "dt": 0.05},
        {"t_final": 1.0, "dt": np.float64(0.05), "scheme": "rk3"},
        {"t_final": 1.0, "dt": 0.05, "frame": "fixed", "conserve": (), "save_every": None},
    ]
    assert len({run_key(Computation("evolution", scene, solver, way)) for way in ways}) == 1
    assert run_key(Computation("evolution", scene, solver, {"t_final": 2.0, "dt": 0.05})) not in {
        run_key(Computation("evolution", scene, solver, way)) for way in ways
    }


@pytest.mark.fault("A6")
def test_a_damaged_run_and_another_runs_file_are_computed_anew(store, computed):
    one, other = cooling(0.5), cooling(0.7)
    keys = [run_key(one), run_key(other)]
    for computation, key in zip((one, other), keys, strict=True):
        obtain(computation, key, store)
    right = [store.path(key).read_bytes() for key in keys]
    store.path(keys[0]).write_bytes(right[0][:1000])
    store.path(keys[1]).write_bytes(right[0])
    for computation, key in zip((one, other), keys, strict=True):
        assert obtain(computation, key, store).computed
    assert [store.path(key).read_bytes() for key in keys] == right
    assert len(computed) == 4


def test_a_run_that_changed_since_it_was_planned_is_refused(store):
    with pytest.raises(ValueError, match="changed since"):
        obtain(cooling(0.5), run_key(cooling(0.7)), store)
    assert store.keys() == set()


def test_a_run_that_must_fail_is_kept_as_failed_and_not_tried_again(store, monkeypatch):
    one = cooling()
    key = run_key(one)
    tried = []

    def fail(computation, *more):
        tried.append(computation)
        raise OverflowError("too large")

    monkeypatch.setattr(execute, "execute", fail)
    outcome = obtain(one, key, store)
    assert outcome.status == "failed" and outcome.label == "failed"
    assert outcome.reason == "OverflowError: too large"
    ds = store.read(key)
    assert ds["status"].attrs["reason"] == outcome.reason and float(ds["e"]) == 0.5
    assert not obtain(one, key, store).computed and len(tried) == 1


def test_an_error_of_the_machine_keeps_nothing(store, monkeypatch):
    def fail(computation, *more):
        raise MemoryError

    monkeypatch.setattr(execute, "execute", fail)
    with pytest.raises(MemoryError):
        obtain(cooling(), run_key(cooling()), store)
    assert store.keys() == set()
    monkeypatch.undo()
    assert obtain(cooling(), run_key(cooling()), store).computed


def _hold(folder, key, claimed, done):
    with Store(folder).claim(key):
        claimed.set()
        done.wait(60)


def test_two_processes_never_compute_one_run_at_once(store, computed):
    one = cooling()
    key = run_key(one)
    spawn = multiprocessing.get_context("spawn")
    claimed, done = spawn.Event(), spawn.Event()
    holder = spawn.Process(target=_hold, args=(store.folder, key, claimed, done))
    holder.start()
    assert claimed.wait(60)
    waiting = threading.Thread(target=obtain, args=(one, key, store))
    waiting.start()
    waiting.join(2.0)
    assert waiting.is_alive() and not computed
    holder.kill()  # a claim ends with the process that has it
    holder.join()
    waiting.join(60.0)
    assert len(computed) == 1 and key in store


def test_a_link_is_the_run_under_another_name(store, tmp_path):
    key = run_key(cooling())
    obtain(cooling(), key, store)
    target = tmp_path / "runs/e~0.5.nc"
    link(store.path(key), target)
    assert is_link(store.path(key), target) and sidecar(target).is_file()
    assert gs.read_dataset(target).identical(store.read(key))
    store.remove(key)
    assert not is_link(store.path(key), target) and gs.read_dataset(target).attrs["run_key"] == key


def test_unfinished_files_of_killed_processes_go_after_a_while(store):
    obtain(cooling(), run_key(cooling()), store)
    partial = store.path(run_key(cooling())).parent / ".partial-abc.nc"
    partial.write_bytes(b"half")
    store.sweep(age=60.0, now=time.time())
    assert partial.exists()
    store.sweep(age=60.0, now=time.time() + 100.0)
    assert not partial.exists() and len(store.keys()) == 1


def test_a_refinement_stops_where_the_answer_settles(store, computed):
    refinement = ladder_of_N(12, 16, 24, 32)
    one = cooling(method="radial")
    one = Computation(one.kind, one.scene, one.solver, one.time_fields, refinement=refinement)
    outcome = obtain(one, run_key(one), store)
    ds = store.read(run_key(one))
    assert outcome.status == "ok"
    assert float(ds["temperature_change"]) <= 1e-4 and float(ds["a2_change"]) <= 1e-3
    made = len(computed)
    assert 2 <= made < 4 and float(ds["N"]) == refinement.values[made - 1]
    # The rungs are runs of their own: a finer ladder starts where this one did.
    finer = ladder_of_N(*refinement.values[: made - 1], 20, 28)
    again = Computation(
        one.kind,
        one.scene,
        one.solver,
        one.time_fields,
        refinement=finer,
    )
    obtain(again, run_key(again), store)
    assert [one.solver.N for one in computed[made:]] in ([20], [20, 28])


def test_a_ladder_that_ends_too_early_says_so(store):
    one = cooling()
    short = ladder_of_N(6, 8, temperature=1e-12)
    one = Computation(one.kind, one.scene, one.solver, one.time_fields, refinement=short)
    outcome = obtain(one, run_key(one), store)
    assert outcome.status == "failed" and "add finer values to refine.N" in outcome.reason
    assert isinstance(store.read(run_key(one)), xr.Dataset)


def test_files_beside_runs_do_not_count_as_runs(store):
    obtain(cooling(), run_key(cooling()), store)
    write_dataset(store.read(run_key(cooling())), store.folder / "index.nc")
    assert store.keys() == {run_key(cooling())}


def test_damaged_runs_are_found_and_removed_to_be_computed_anew(store):
    keys = [run_key(one) for one in (cooling(0.5), cooling(0.7))]
    for one, key in zip((cooling(0.5), cooling(0.7)), keys, strict=True):
        obtain(one, key, store)
    assert store.heal(keys) == []
    data = bytearray(store.path(keys[0]).read_bytes())
    data[len(data) // 2] ^= 4
    store.path(keys[0]).write_bytes(data)
    assert store.heal(keys) == [keys[0]] and store.keys() == {keys[1]}


def test_the_rungs_of_a_ladder_have_keys_of_their_own(store):
    one = cooling()
    ladder = ladder_of_N(12, 16)
    refined = Computation(one.kind, one.scene, one.solver, one.time_fields, refinement=ladder)
    obtain(refined, run_key(refined), store)
    assert rung_keys([one]) == [] and set(rung_keys([refined])) < store.keys()
