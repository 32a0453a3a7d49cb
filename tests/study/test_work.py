"""The work of a job: each run once, names for all that asked, and what happens to one that fails."""

import json
import multiprocessing
from pathlib import Path

import numpy as np
import pytest
from studies import load_text

from granstudy.runs import execute
from granstudy.runs.store import Store, is_link
from granstudy.study.jobs import jobs
from granstudy.study.layout import Layout
from granstudy.study.state import State
from granstudy.study.study import read_study
from granstudy.study.work import JobError, work
from granstudy.support.reporter import read_progress

STUDY = """
title: test
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian2d, diffusion: 0.0}
    solver: {method: radial, N: 12, R: 7.0}
    time: {t_final: 0.5, dt: 0.05}
    sweep:
      - e: {start: 0.05, stop: 0.95, count: 10}
  again:
    title: the same gas under another name
    run: evolution
    scene: {name: maxwellian2d, e: 0.05, diffusion: 0.0}
    solver: {method: radial, R: 7.0}
    time: {t_final: 0.5, dt: 0.05}
    sweep:
      - N: [12]
"""


@pytest.fixture
def layout(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return Layout(load_text(tmp_path, STUDY))


def one_job(layout):
    (job,) = jobs(State(layout).missing, cores=1)
    return job


def test_a_job_computes_its_runs_names_them_and_writes_a_receipt(layout, capsys):
    job = one_job(layout)
    work(job, layout, 1, layout.receipt(job.id))
    labels = json.loads(Path(layout.receipt(job.id)).read_text())
    assert set(labels) == layout.store.keys() == {key for _, _, key in job.runs}
    assert len(labels) == 10 and set(labels.values()) <= {"trusted", "marginal", "untrusted"}
    for experiment, path, key in job.runs:
        assert is_link(layout.store.path(key), Path(layout.run_file(experiment, path)))
    (progress,) = read_progress(layout.jobs)
    assert (progress.state, progress.done, progress.runs) == ("done", 10, 10)
    assert "run 10 of 10" in capsys.readouterr().err


def test_runs_that_are_there_are_found_and_not_computed(layout, monkeypatch):
    job = one_job(layout)
    work(job, layout, 1, layout.receipt(job.id))
    monkeypatch.setattr(execute, "execute", None)
    Path(layout.receipt(job.id)).unlink()
    work(job, layout, 1, layout.receipt(job.id))
    assert len(json.loads(Path(layout.receipt(job.id)).read_text())) == 10
    (progress,) = read_progress(layout.jobs)
    assert progress.done == sum(progress.labels.values()) == 10


@pytest.mark.fault("B5")
def test_a_run_that_the_machine_fails_keeps_no_other_from_its_result(layout, monkeypatch):
    compute = execute.execute

    def full(computation, *more):
        if computation.scene.restitution == pytest.approx(0.15):
            raise MemoryError("none left")
        return compute(computation, *more)

    monkeypatch.setattr(execute, "execute", full)
    job = one_job(layout)
    with pytest.raises(JobError, match="cooling/e~0.15: MemoryError: none left"):
        work(job, layout, 1, layout.receipt(job.id))
    assert not Path(layout.receipt(job.id)).exists() and len(layout.store.keys()) == 9
    assert len(list(Path(layout.runs).rglob("*.nc"))) == 10
    (progress,) = read_progress(layout.jobs)
    assert progress.state == "failed" and progress.labels["failed"] == 1


@pytest.mark.fault("B2")
def test_a_run_that_fails_by_its_own_parameters_is_a_result(layout, monkeypatch):
    def fail(computation, *more):
        raise ZeroDivisionError("by zero")

    monkeypatch.setattr(execute, "execute", fail)
    job = one_job(layout)
    work(job, layout, 1, layout.receipt(job.id))
    assert set(json.loads(Path(layout.receipt(job.id)).read_text()).values()) == {"failed"}


@pytest.mark.fault("B9")
def test_an_interrupted_job_keeps_what_it_did(layout, monkeypatch, capsys):
    compute, made = execute.execute, []

    def stopped(computation, *more):
        if len(made) == 3:
            raise KeyboardInterrupt
        made.append(computation)
        return compute(computation, *more)

    monkeypatch.setattr(execute, "execute", stopped)
    job = one_job(layout)
    with pytest.raises(KeyboardInterrupt):
        work(job, layout, 1, layout.receipt(job.id))
    assert len(layout.store.keys()) == 3 and not Path(layout.receipt(job.id)).exists()
    (progress,) = read_progress(layout.jobs)
    assert progress.state == "stopped" and "the same command goes on" in capsys.readouterr().err


def test_a_study_that_changed_since_the_job_was_planned_is_refused(layout):
    job = one_job(layout)
    later = Layout(load_text(".", STUDY.replace("t_final: 0.5", "t_final: 0.4")))
    with pytest.raises(JobError, match="changed since the work was planned; start it again"):
        work(job, later, 1, layout.receipt(job.id))
    assert layout.store.keys() == set()


def _compute_all(folder, log, start):
    """What a job of another process does, its evaluations counted in a file."""
    compute = execute.execute

    def counted(computation, *more):
        with open(log, "a") as file:
            file.write(f"{computation.scene.restitution}\n")
        return compute(computation, *more)

    execute.execute = counted
    study = Layout(read_study(Path(folder) / "test.yaml"), f"{folder}/results")
    job = one_job(study)
    start.wait(60)
    work(job, study, 1, f"{log}.{multiprocessing.current_process().name}")


def test_two_processes_with_the_same_runs_compute_each_once(layout, tmp_path):
    spawn = multiprocessing.get_context("spawn")
    start, log = spawn.Barrier(2), tmp_path / "computed"
    processes = [
        spawn.Process(target=_compute_all, args=(str(tmp_path), str(log), start)) for _ in range(2)
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join(120)
        assert process.exitcode == 0
    computed = sorted(map(float, log.read_text().split()))
    assert computed == pytest.approx(np.linspace(0.05, 0.95, 10))
    store = Store.beside(tmp_path / "results")
    keys = store.keys()
    assert len(keys) == 10 and all(store.read(key) is not None for key in keys)
    receipts = list(tmp_path.glob("computed.*"))
    assert len(receipts) == 2 and all(len(json.loads(r.read_text())) == 10 for r in receipts)
