"""What a job tells in its log and its progress file, by a clock that the tests turn."""

import json
import os
import socket
from dataclasses import asdict, replace

import pytest

from granstudy.support import reporter as module
from granstudy.support.reporter import (
    JobProgress,
    Reporter,
    duration,
    read_progress,
    read_progress_file,
    write_progress,
)


class Job:
    """A reporter of runs of 10 s each by estimate, with a clock and the lines of its log."""

    def __init__(self, folder, runs=3, **settings):
        self.time, self.lines = 1000.0, []
        self.path = folder / "a.progress.json"
        self.reporter = Reporter(
            self.path, "a", "cooling", [10.0] * runs, say=self.lines.append, now=lambda: self.time,
            **settings,
        )  # fmt: skip

    @property
    def written(self):
        return read_progress_file(self.path)


@pytest.fixture
def job(tmp_path):
    return Job(tmp_path)


def test_the_log_says_run_step_time_and_what_is_left(job):
    with job.reporter as reporter:
        reporter.found("trusted")
        reporter.start("e~0.5/N~24")
        for step in range(1, 201):
            job.time += 0.2  # four times as slow as estimated
            reporter.step(step, 200, 0.01 * step)
        reporter.finish("ok", "trusted")
        reporter.start("e~0.9")
        reporter.finish("diverged", "failed")
    first, *between, last = job.lines[:-2]
    assert first == "run 2 of 3  e~0.5/N~24  about 20 s left"
    assert between[0] == "run 2 of 3  e~0.5/N~24  step 50 of 200  t = 0.5  about 50 s left"
    assert [line.split("step ")[1].split()[0] for line in between] == ["50", "100", "150", "200"]
    assert last == "run 2 of 3  e~0.5/N~24  ok trusted  40.0 s  about 35 s left"
    assert job.lines[-1] == "run 3 of 3  e~0.9  diverged failed  0.0 s"


def test_the_file_says_the_same_and_is_written_once_a_second(job, monkeypatch):
    written = []

    def count(path, progress):
        written.append(job.time)
        write_progress(path, progress)

    monkeypatch.setattr(module, "write_progress", count)
    with job.reporter as reporter:
        reporter.start("e~0.5")
        for step in range(1, 101):
            job.time += 0.1
            reporter.step(step, 100, 0.1 * step)
        assert len(written) == 2 + 10
        now = job.written
        assert (now.job, now.title, now.run, now.step, now.steps) == (
            "a",
            "cooling",
            "e~0.5",
            100,
            100,
        )
        assert (now.runs, now.done, now.state) == (3, 0, "running")
        assert now.left == pytest.approx(20.0) and now.worth == pytest.approx(10.0)
        assert (now.pid, now.host) == (os.getpid(), socket.gethostname())
        reporter.finish("ok", "marginal")
        for run in ("e~0.7", "e~0.9"):
            reporter.start(run)
            reporter.finish("ok", "trusted")
    assert job.written.labels == {"marginal": 1, "trusted": 2}
    assert (job.written.done, job.written.state, job.written.left) == (3, "done", 0.0)


def test_what_is_left_follows_the_measured_speed(tmp_path):
    job = Job(tmp_path, runs=10)
    with job.reporter as reporter:
        for run in range(5):
            reporter.start(str(run))
            job.time += 30.0
            reporter.finish("ok", "trusted")
        assert reporter.progress.left == pytest.approx(3 * 50.0, rel=0.1)
        with pytest.raises(SystemExit), job.reporter:
            raise SystemExit(143)


@pytest.mark.parametrize(
    ("error", "state", "line"),
    [
        (SystemExit(143), "stopped", "stopped after 1 of 3 runs; the same command goes on"),
        (ValueError("bad"), "failed", "failed after 1 of 3 runs, in e~0.7"),
    ],
)
def test_an_end_before_the_end_is_said_and_written(job, error, state, line):
    with pytest.raises(type(error)), job.reporter as reporter:
        reporter.start("e~0.5")
        reporter.finish("ok", "trusted")
        reporter.start("e~0.7")
        raise error
    assert job.lines[-1] == line
    assert (job.written.state, job.written.done) == (state, 1)


def test_a_state_has_no_time(job):
    with job.reporter as reporter:
        reporter.start("e~0.5")
        job.time += 11.0
        reporter.step(2, 20, float("nan"))
        assert job.written.time is None
    assert "step 2 of 20  about" in job.lines[-1]


def test_damaged_files_are_left_out(tmp_path):
    good = JobProgress("b", "cooling", 3, labels={"trusted": 1})
    write_progress(tmp_path / "b.progress.json", good)
    whole = (tmp_path / "b.progress.json").read_text()
    (tmp_path / "half.progress.json").write_text(whole[: len(whole) // 2])
    (tmp_path / "old.progress.json").write_text('{"job": "c"}')
    (tmp_path / "list.progress.json").write_text("[1]")
    (tmp_path / "words.progress.json").write_text(json.dumps(asdict(good) | {"done": "three"}))
    (tmp_path / "other.json").write_text(whole)
    assert read_progress(tmp_path) == [good]
    assert read_progress(tmp_path / "nowhere") == []


def test_dead_jobs_are_stale(tmp_path):
    here = JobProgress("a", "", 3, updated=100.0, pid=os.getpid(), host=socket.gethostname())
    assert not here.is_stale(159.0) and here.is_stale(161.0)
    assert replace(here, pid=2**22 + 1).is_stale(101.0)
    elsewhere = replace(here, pid=2**22 + 1, host="elsewhere")
    assert not elsewhere.is_stale(101.0)
    assert not replace(here, state="done").is_stale(1e9)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0, "1 s"), (7.6, "8 s"), (38, "40 s"), (58, "1 min"), (170, "3 min"), (7900, "2 h 10 min"),
     (7190, "2 h"), (90_000, "1 day"), (250_000, "3 days")],
)  # fmt: skip
def test_durations_in_words(seconds, words):
    assert duration(seconds) == words
