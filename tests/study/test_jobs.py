"""Runs that share a job: how they are divided, and that nothing computed is lost."""

import pytest

from granstudy import read_dataset
from granstudy.datasets.netcdf import write_dataset
from granstudy.study import execute
from granstudy.study.jobs import JOB_SECONDS, jobs
from granstudy.study.run_key import run_key

STUDY = """
title: test
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw2d}
    solver: {R: 7.8, N_rho: 4, M_cir: 4, N: 8}
    time: {t_final: 0.2, dt: 0.1}
    sweep:
      - {e: [0.2, 0.5, 0.8], method: [fast, literal]}
"""


@pytest.fixture
def runs(load):
    return list(load().runs["cooling"].values())


def test_cheap_runs_share_a_job_and_long_ones_are_alone(load):
    sweep = "- {e: [0.2, 0.5], N: [8, 32768, 10, 12], method: [fast]}"
    text = STUDY.replace("- {e: [0.2, 0.5, 0.8], method: [fast, literal]}", sweep)
    runs = list(load(text=text.replace(", N: 8}", "}")).runs["cooling"].values())
    divided = jobs(runs)
    assert [run for job in divided for run in job.runs] == runs
    assert [[run.solver.N for run in job.runs] for job in divided] == [
        [8],
        [32768],
        [10, 12, 8],
        [32768],
        [10, 12],
    ]
    assert [job.number for job in divided] == [1, 2, 3, 4, 5]
    assert divided[1].seconds > JOB_SECONDS > divided[2].seconds
    assert divided[1].minutes > divided[2].minutes >= 5
    assert divided[1].memory_mb > divided[2].memory_mb


def test_keys_tell_parameters_and_methods_apart(runs):
    keys = [run_key(run) for run in runs]
    assert len(set(keys)) == len(runs)
    assert keys == [run_key(run) for run in runs]


def test_a_job_that_failed_goes_on_where_it_stopped(runs, tmp_path, monkeypatch):
    keys = [run_key(run) for run in runs]
    paths = [tmp_path / "runs" / f"{run.path}.nc" for run in runs]
    unfinished = tmp_path / "unfinished"
    computed = []
    compute = execute.execute

    def fails_at_the_fourth(run, threads):
        computed.append(run.path)
        if len(computed) == 4:
            raise MemoryError
        return compute(run, threads)

    monkeypatch.setattr(execute, "execute", fails_at_the_fourth)
    with pytest.raises(MemoryError):
        execute.execute_job(runs, keys, paths, 1, unfinished)
    for path in paths:  # as Snakemake does with the outputs of a failed job
        path.unlink(missing_ok=True)
    computed += [""]
    execute.execute_job(runs, keys, paths, 1, unfinished)
    assert computed[5:] == [run.path for run in runs[3:]]
    assert [read_dataset(path).attrs["run_key"] for path in paths] == keys
    assert list(unfinished.iterdir()) == []


def test_only_runs_of_another_key_or_with_damaged_files_are_computed(runs, tmp_path, monkeypatch):
    keys = [run_key(run) for run in runs]
    paths = [tmp_path / f"{i}.nc" for i in range(len(runs))]
    execute.execute_job(runs, keys, paths, 1, tmp_path / "unfinished")
    written = [path.read_bytes() for path in paths]
    paths[1].write_bytes(written[1][:1000])
    computed = []
    compute = execute.execute
    monkeypatch.setattr(
        execute, "execute", lambda run, threads: computed.append(run) or compute(run, threads)
    )
    write_dataset(read_dataset(paths[3]).assign_attrs(run_key="another"), paths[3])
    execute.execute_job(runs, keys, paths, 1, tmp_path / "unfinished")
    assert computed == [runs[1], runs[3]]
    assert [path.read_bytes() for path in paths] == written


def test_a_run_that_changed_since_the_workflow_started_is_refused(runs, tmp_path):
    path = tmp_path / "0.nc"
    with pytest.raises(ValueError, match="changed since the workflow started"):
        execute.execute_job(runs[:1], [run_key(runs[1])], [path], 1, tmp_path / "unfinished")
    assert not path.exists()
