"""Runs computed by the workers of a cluster: the same bits, each once, and nothing lost with a worker."""

import os
import signal
import threading
import time

import pytest
from distributed import Client, LocalCluster
from gases import FAST, RADIAL, SHORT, my_gas, stored, sweep

import granstudy as gs
from granstudy.runs.store import Store
from granstudy.workbench import compute as computing
from granstudy.workbench.compute import Failure, compute

E = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]


@pytest.fixture(scope="module")
def cluster():
    """Two workers in two processes."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        yield cluster


@pytest.fixture
def client(cluster):
    with Client(cluster) as client:
        yield client


class Slow:
    """A task that takes its time and leaves a mark; picked up by reference."""

    def __init__(self, folder, number, seconds=0.0):
        self.folder, self.key, self.seconds = folder, f"{number:032d}", seconds

    def perform(self, store):
        with open(self.folder / "begun", "a") as file:
            file.write(f"{self.key} {os.getpid()}\n")
        time.sleep(self.seconds)
        return f"done by {os.getpid()}"


@pytest.mark.slow
def test_a_cluster_computes_the_same_bits_as_this_process(here, client, computed):
    over = {"e": E, "exponent": [0.0, 1.0]}
    there = gs.sweep("maxwellian2d", RADIAL, over=over, results="there", client=client, **SHORT)
    assert not computed
    own = sweep("maxwellian2d", RADIAL, over=over, results="own", **SHORT)
    assert len(computed) == 12 and own.identical(there)
    files = {folder: stored(here / folder) for folder in ("own", "there")}
    assert files["own"] == files["there"]
    for key in files["own"]:
        paths = [Store.beside(folder).path(key) for folder in files]
        assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.slow
def test_the_client_of_this_process_is_taken_unless_workers_are_asked_for(here, client, computed):
    gs.sweep("maxwellian2d", RADIAL, over={"e": [0.5]}, progress=False, **SHORT)
    assert not computed and len(stored(here / "results")) == 1
    gs.sweep("maxwellian2d", RADIAL, over={"e": [0.5, 0.6]}, workers=1, progress=False, **SHORT)
    assert len(computed) == 1


@pytest.mark.slow
def test_own_functions_go_to_workers(here, client, computed):
    my_gas(here)
    over = {"ratio": [1.0, 2.0], "kappa": [0.1, 0.2]}
    words = {"restitution": "my_gas.py:softening", **SHORT}
    ds = gs.sweep("my_gas.py:anisotropic", FAST, over=over, client=client, **words)
    assert not computed and (ds["status"] == 0).all()
    assert sweep("my_gas.py:anisotropic", FAST, over=over, **words).identical(ds) and not computed


@pytest.mark.slow
def test_a_function_of_the_user_is_called_by_workers(here, client):
    import xarray as xr

    def square(number):
        if number == 2:
            raise ValueError("not two")
        return xr.Dataset({"square": number**2})

    ds = gs.sweep(square, over={"number": [1, 2, 3]}, client=client)
    assert ds["square"].values[[0, 2]].tolist() == [1, 9]
    assert ds["reason"].values.tolist() == ["", "ValueError: not two", ""]


@pytest.mark.slow
def test_a_study_is_computed_by_a_cluster(here, client, computed):
    said = {
        "title": "cooling",
        "experiments": {
            "cooling": {
                "title": "cooling",
                "run": "evolution",
                "scene": {"name": "maxwellian2d", "diffusion": 0.0},
                "solver": {"method": "radial", "N": 12, "R": 7.0},
                "time": dict(SHORT),
                "sweep": [{"e": E}],
            }
        },
    }
    study = gs.open_study(said)
    study.compute(client=client, progress=False)
    assert not computed and set(study.runs["state"]) == {"done"}


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing(here):
    over = {"e": [round(0.02 * k, 2) for k in range(1, 31)]}
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
        Client(cluster) as client,
    ):
        pids = list(client.run(os.getpid).values())

        def kill_one():
            while len(stored(here / "results")) < 3:
                time.sleep(0.02)
            os.kill(pids[0], signal.SIGKILL)

        killer = threading.Thread(target=kill_one)
        killer.start()
        ds = gs.sweep("maxwellian2d", RADIAL, over=over, client=client, t_final=1.0, dt=0.05)
        killer.join()
        assert pids[0] not in client.run(os.getpid).values()
    assert (ds["status"] == 0).all() and len(stored(here / "results")) == 30


@pytest.mark.slow
def test_workers_of_this_machine_are_started_when_they_are_asked_for(here, computed):
    ds = gs.sweep("maxwellian2d", RADIAL, over={"e": E}, workers=2, progress=False, **SHORT)
    assert not computed and (ds["status"] == 0).all()


def test_work_is_divided_so_that_every_worker_has_some():
    class Costs:
        def __init__(self, seconds):
            self.seconds = seconds

    cheap = [Costs(0.01) for _ in range(200)]
    batches = computing._batches(cheap, workers=2)
    assert 6 <= len(batches) <= 7 and sum(map(len, batches)) == 200
    mixed = computing._batches([Costs(1.0), Costs(100.0), *cheap], workers=2)
    assert [task.seconds for task in mixed[0]] == [100.0] and len(mixed) == 2
    assert all(sum(task.seconds for task in batch) <= 6.0 for batch in mixed[1:])


def test_a_task_is_performed_once_whoever_names_it(here):
    tasks = [Slow(here, number % 2) for number in range(4)]
    found = compute(tasks, Store(here / "store"), workers=1, progress=False)
    assert len(found) == 2 and len((here / "begun").read_text().splitlines()) == 2


def test_the_cause_of_a_task_that_fails_is_told(here):
    class Full(Slow):
        def perform(self, store):
            raise OSError("no space left")

    found = compute([Full(here, 1)], Store(here / "store"), workers=1, progress=False)
    (failure,) = found.values()
    assert isinstance(failure, Failure) and failure.cause == "OSError: no space left"
