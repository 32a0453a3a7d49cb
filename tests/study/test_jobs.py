"""Runs that share a job: how they are divided over cores."""

import pytest

from granstudy.study.jobs import LONGEST, SHORTEST, Job, jobs
from granstudy.study.sizes import MEMORY
from granstudy.study.study import Member

STUDY = """
title: test
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw2d}
    solver: {R: 7.8, N_rho: 4, M_cir: 4}
    time: {t_final: 0.2, dt: 0.1}
    sweep:
      - {e: [0.2, 0.5], N: [8, 32768, 10, 12], method: [fast]}
"""


@pytest.fixture(autouse=True)
def large_machine(monkeypatch):
    """A machine that holds all runs, none of which is computed."""
    monkeypatch.setenv(MEMORY, "1000")


def left(study):
    """Every run, by itself, as one that is missing."""
    return [[member] for member in study.members]


def sizes(study, job):
    return [study.run(experiment, path).solver.N for experiment, path, _ in job.runs]


def test_cheap_runs_share_a_job_and_long_ones_are_alone(load):
    study = load()
    divided = jobs(left(study), cores=None)
    small = [sizes(study, job) for job in divided if sizes(study, job) != [32768]]
    assert sorted(small) == [[8], [10, 12], [10, 12, 8]] and len(divided) == 5
    assert sorted(run for job in divided for run in job.runs) == sorted(
        (m.experiment, m.path, m.key) for m in study.members
    )
    assert divided[0].total > LONGEST > divided[2].total
    assert divided[0].minutes > divided[2].minutes >= 5
    assert divided[0].memory_mb > divided[2].memory_mb
    assert [job.total for job in divided] == sorted((job.total for job in divided), reverse=True)


@pytest.mark.parametrize("cores", [1, 2])
def test_work_is_divided_by_its_cost_so_that_all_cores_have_some(load, cores):
    """Sixty equal runs of some seconds: every core gets several jobs, none of them tiny."""
    study = load("{e: [0.2, 0.5], N: [8, 32768, 10, 12]", "{e: [0.5], N: [2048, 4096]")
    one = left(study)
    divided = jobs(one * 15, cores)
    total = sum(job.total for job in divided)
    assert total > cores * SHORTEST * 3, "the runs of this test are too cheap to be divided"
    assert len(divided) >= 2 * cores
    assert max(job.total for job in divided) < LONGEST + max(max(job.seconds) for job in divided)


def test_runs_whose_seconds_are_shown_share_the_job_of_their_experiment(load):
    """What a process loads at its first run is then part of the seconds of one run alone."""
    truth = "    truth: {solver: {method: radial, N: 16, R: 8.0}, time: {dt: 0.1}}\n    sweep:"
    timed = load("    sweep:", f"    table: {{quantity: a2, seconds: true}}\n{truth}")
    (job,) = jobs(left(timed), cores=2)
    assert len(job.runs) == len(timed.members) == 10  # the truths, too
    others = left(load())
    divided = jobs([*left(timed), *others], cores=2)
    assert job in divided and jobs(others, cores=2) == [one for one in divided if one != job]


def test_two_runs_of_some_seconds_are_two_jobs_on_two_cores(load):
    study = load("{e: [0.2, 0.5], N: [8, 32768, 10, 12]", "{e: [0.2, 0.5], N: [4096]")
    assert [len(job.runs) for job in jobs(left(study), cores=2)] == [1, 1]


def test_a_run_with_two_names_is_computed_by_one_job_and_counted_once(load):
    study = load("N: [8, 32768, 10, 12]", "N: [8]")
    a, b = study.members
    (job,) = jobs([[a, Member("other", "path", a.run, a.key)], [b]], cores=1)
    assert [run[:2] for run in job.runs] == [
        ("cooling", a.path),
        ("other", "path"),
        ("cooling", b.path),
    ]
    assert job.seconds[1] == 0.0 < job.seconds[0]


def test_a_job_is_read_as_it_was_written(load, tmp_path):
    (job, *_) = jobs(left(load()), cores=2)
    job.write(tmp_path / "job.json")
    assert Job.read(tmp_path / "job.json") == job
    assert Job.read(tmp_path / "job.json").id == job.id
