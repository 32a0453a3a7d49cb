"""What the screen of a study says, without a terminal: from files and records to lines."""

import io
import json
import logging
import threading
import time
from dataclasses import asdict, replace
from types import SimpleNamespace

import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from granstudy.support.reporter import JobProgress, write_progress
from snakemake_logger_plugin_granstudy import LogHandler, interrupt, text
from snakemake_logger_plugin_granstudy.locks import clear_stale
from snakemake_logger_plugin_granstudy.overview import Overview, now
from snakemake_logger_plugin_granstudy.screen import Screen
from snakemake_logger_plugin_granstudy.session import Session

OVERVIEW = Overview("my_study", "results/my_study", 250, 30, 400.0, 2, {"trusted": 30})


def job(name="a", **fields):
    usual = {
        "title": "cooling",
        "runs": 12,
        "started": 100.0,
        "updated": 120.0,
        "host": "elsewhere",
    }
    return JobProgress(name, **usual | fields)


RUNNING = job(
    done=3, run="e~0.5/N~24", step=140, steps=200, time=1.4, left=40.0, worth=10.0,
    labels={"trusted": 2, "marginal": 1},
)  # fmt: skip
DONE = job("b", done=12, state="done", worth=20.0, labels={"trusted": 11, "failed": 1})


@pytest.fixture
def study(tmp_path, monkeypatch):
    """The files of a study that runs now."""
    path = tmp_path / "overview.json"
    path.write_text(json.dumps(asdict(OVERVIEW)))
    monkeypatch.setenv("GRANSTUDY_OVERVIEW", str(path))
    since = {"started": time.time() + 1.0, "updated": time.time() + 2.0}
    write_progress(tmp_path / "b.progress.json", replace(DONE, **since))
    return tmp_path


def record(event=None, message="", level=logging.INFO, **fields):
    made = logging.LogRecord("snakemake", level, "", 0, message, None, None)
    made.__dict__.update(fields)
    if event:
        made.event = event
    return made


def started(jobid, rule, output, message=None, **wildcards):
    return record(
        LogEvent.JOB_INFO, jobid=jobid, rule_name=rule, rule_msg=message, output=output,
        wildcards=wildcards, reason="Missing output files: a, b, c",
    )  # fmt: skip


def failed(jobid, rule, logs, message=None, **aux):
    return record(
        LogEvent.JOB_ERROR, level=logging.ERROR, jobid=jobid, rule_name=rule, rule_msg=message,
        log=logs, aux=aux,
    )  # fmt: skip


def test_the_block_counts_runs_and_not_jobs():
    lines = text.block(now(OVERVIEW, [RUNNING, DONE], 90.0, 125.0), 0, ["table map"], 200)
    assert lines[0].startswith(
        "granstudy my_study  runs 45 of 250  trusted 43 marginal 1 untrusted 0 failed 1  about "
    )
    assert lines[1] == "  cooling  run 4 of 12  e~0.5/N~24  step 140 of 200  t = 1.4"
    assert lines[2] == "  making table map"
    narrow = text.block(now(OVERVIEW, [RUNNING], 90.0, 125.0), 2, [], 40)
    assert [len(line) <= 40 for line in narrow] == [True] * 3 and narrow[-1] == "  2 jobs start"
    assert narrow[0].endswith("...")


def test_jobs_of_an_earlier_call_and_dead_ones_do_not_count():
    study = now(OVERVIEW, [RUNNING, DONE], 110.0, 125.0)
    assert (study.done, study.running) == (30, [])
    assert now(OVERVIEW, [RUNNING], 90.0, 200.0).running == []


def test_many_jobs_are_counted():
    many = [job(str(number)) for number in range(9)]
    assert text.block(now(OVERVIEW, many, 90.0, 125.0), 0, [], 80)[-1] == "  and 3 more jobs"


def test_the_time_left_follows_cores_and_measured_speed():
    assert now(OVERVIEW, [], 0.0, 0.0).left == pytest.approx(200.0)
    slow = job(state="done", started=100.0, updated=300.0, worth=100.0)
    assert now(OVERVIEW, [slow], 0.0, 300.0).left == pytest.approx(300.0, rel=0.1)
    long = job(left=5000.0)
    assert now(OVERVIEW, [long], 0.0, 125.0).left == 5000.0


def test_a_session_from_its_beginning_to_its_end(study):
    session = Session()
    (study / "table.log").write_text("".join(f"line {n}\n" for n in range(40)))
    stats = record(LogEvent.RUN_INFO, "Job stats: ...")
    assert session.take(stats) == ["my_study: 208 of 250 runs to compute, about 1 min on 2 cores"]
    assert session.take(started(1, "runs", [str(study / "jobs/c.json")], "cooling: 12 runs")) == []
    assert session.take(started(2, "table", ["t.nc"], None, experiment="map")) == []
    assert session.take(started(3, "figure", ["f.svg"], "figure map")) == []
    assert session.take(started(4, "all", [])) == []
    assert session.making == ["table map", "figure map"] and session.starting(session.now()) == 1
    assert session.take(record(LogEvent.JOB_FINISHED, job_id=1)) == []
    assert session.take(record(LogEvent.JOB_FINISHED, job_id=3)) == ["made  figure map"]
    assert session.take(record(LogEvent.JOB_FINISHED, job_id=4)) == []
    process = "CalledProcessError: Command 'x' returned non-zero exit status 1."
    assert session.take(record(LogEvent.ERROR, process, logging.ERROR)) == []
    error = session.take(failed(2, "table", [str(study / "table.log")], external_jobid=7))
    assert error[:3] == ["FAILED  table map", "  external_jobid: 7", f"  log {study}/table.log:"]
    assert error[3:] == [f"    line {n}" for n in range(25, 40)]
    assert session.take(failed(2, "table", [str(study / "table.log")])) == []
    assert session.end() == [
        "results/my_study: 42 of 250 runs are done: trusted 41 marginal 0 untrusted 0 failed 1",
        "  made    figure map",
        "  failed  table map",
    ]


def test_the_last_line_names_the_page_that_shows_the_study(study, monkeypatch):
    page = study / "index.html"
    (study / "overview.json").write_text(json.dumps(asdict(replace(OVERVIEW, page=str(page)))))
    session = Session()
    session.take(record(LogEvent.RUN_INFO, "Job stats: ..."))
    assert not any("index.html" in line for line in session.end()), "there is none yet"
    page.touch()
    assert session.end()[-1] == f"  read    {page}"
    stop = threading.Event()
    stop.set()
    monkeypatch.setattr(interrupt, "_stopped", stop)
    monkeypatch.setattr(interrupt, "_said", threading.Event())
    assert not any("index.html" in line for line in session.end()), "it may be an older one"


def test_a_job_that_succeeds_when_it_is_tried_again_has_not_failed(study):
    session = Session()
    session.take(record(LogEvent.RUN_INFO, "Job stats: ..."))
    for _ in range(2):
        session.take(started(1, "runs", [str(study / "jobs/c.done")], "12 runs"))
        session.take(failed(1, "runs", []))
    assert session.end()[-1] == "  failed  12 runs"
    session.take(started(1, "runs", [str(study / "jobs/c.done")], "12 runs"))
    session.take(record(LogEvent.JOB_FINISHED, job_id=1))
    assert not any("failed  " in line for line in session.end()[1:])


def test_logs_that_are_empty_or_missing_are_called_so(tmp_path):
    (tmp_path / "empty").write_text("\n")
    logs = [str(tmp_path / "empty"), str(tmp_path / "none")]
    assert text.error("table", logs, False)[1:] == [
        f"  log {logs[0]}: empty",
        f"  log {logs[1]}: no such file",
    ]
    (tmp_path / "long").write_text("line\n" * 100)
    assert len(text.error("table", [str(tmp_path / "long")], whole=True)) == 102


@pytest.mark.parametrize(
    ("message", "level", "shown"),
    [
        ("Building DAG of jobs...", logging.INFO, False),
        ("Select jobs to execute...", logging.INFO, False),
        ("resources before selection", logging.DEBUG, False),
        ("Nothing to be done (all requested files are present).", logging.INFO, True),
        ("LockException:\nError: Directory cannot be locked.", logging.ERROR, True),
        ("WorkflowError:\nN=-10: must be an even integer", logging.ERROR, True),
        ("WorkflowError:\nAt least one job did not complete successfully.", logging.ERROR, False),
        ("Will exit after finishing currently running jobs (scheduler).", logging.INFO, True),
        ("a message of Snakemake 10", logging.INFO, True),
        ("Command 'x' died with <Signals.SIGKILL: 9>.", logging.ERROR, True),
    ],
)
def test_messages_that_matter_come_through(message, level, shown):
    assert bool(Session().take(record(None, message, level))) == shown


def test_a_killed_job_is_told_from_a_failed_one():
    message = "Command 'x' died with <Signals.SIGKILL: 9>."
    lines = Session().take(record(LogEvent.ERROR, message, logging.ERROR))
    assert lines == ["a job was ended by SIGKILL: the machine may have run out of memory"]


def test_a_stopped_session_says_so_and_shows_no_errors(study, monkeypatch):
    stop = threading.Event()
    monkeypatch.setattr(interrupt, "_stopped", stop)
    monkeypatch.setattr(interrupt, "_said", threading.Event())
    session = Session()
    session.take(record(LogEvent.RUN_INFO))
    stop.set()
    assert session.take(failed(1, "runs", [])) == []
    assert session.end()[0] == "stopped: 42 of 250 runs are done; the same command goes on"
    assert Session().end() == ["stopped: the same command goes on"]


def test_a_dry_run_says_a_line_a_job_without_reasons(study):
    session = Session(dry_run=True)
    assert session.take(record(LogEvent.RUN_INFO, "Job stats:\njob  count")) == [
        "Job stats:\njob  count"
    ]
    assert session.take(record(LogEvent.RUN_INFO, "Job stats:\njob  count")) == []
    assert session.take(started(1, "table", ["t.nc"], "table map")) == ["job 1  table map"]
    assert session.take(started(2, "all", [])) == []
    assert session.end() == [] and not session.running


def test_without_an_overview_only_jobs_are_told(monkeypatch):
    monkeypatch.delenv("GRANSTUDY_OVERVIEW", raising=False)
    session = Session()
    assert session.take(record(LogEvent.RUN_INFO)) == []
    session.take(started(1, "table", ["t.nc"], "table map"))
    assert session.take(record(LogEvent.JOB_FINISHED, job_id=1)) == ["made  table map"]
    assert session.end() == []


class Terminal(io.StringIO):
    encoding = "ascii"

    def isatty(self):
        return True


def test_the_block_is_drawn_below_what_stays(study, monkeypatch):
    monkeypatch.setattr("sys.stderr", Terminal())
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "50")
    session = Session()
    session.take(record(LogEvent.RUN_INFO))
    screen = Screen(session)
    screen.start()
    screen.show(["made  table é"])
    screen.show(["FAILED  table b"])
    screen.stop()
    written = screen.stream.getvalue()
    head = "granstudy my_study  runs 42 of 250  trusted 41..."
    assert written.startswith(
        f"made  table ?\n{head}\n\033[1F\033[J\033[31mFAILED  table b\033[0m\n{head}\n"
    )
    assert written.endswith("\033[1F\033[J")


def handler(**settings):
    usual = {
        "dryrun": False, "show_failed_logs": False, "quiet": set(), "stdout": False, "nocolor": True,
        "verbose": False, "debug_dag": False, "printshellcmds": False,
    }  # fmt: skip
    return LogHandler(SimpleNamespace(**usual | settings), None)


@pytest.fixture
def signals_kept(monkeypatch):
    monkeypatch.setattr(interrupt, "install", lambda: None)


def test_a_fault_of_the_screen_leaves_the_rest_to_snakemakes_own(signals_kept, monkeypatch, capsys):
    monkeypatch.setattr(Session, "take", lambda self, record: 1 / 0)
    shown = handler()
    shown.emit(record(None, "first"))
    shown.emit(record(None, "second"))
    shown.close()
    said = capsys.readouterr().err
    assert "the screen of granstudy failed (ZeroDivisionError" in said
    assert said.count("first") == said.count("second") == 1


def test_verbose_is_snakemakes_own(signals_kept, capsys):
    handler(verbose=True).emit(record(None, "Building DAG of jobs..."))
    assert "Building DAG of jobs" in capsys.readouterr().err


def test_a_lock_is_stale_when_its_owner_is_dead(tmp_path):
    lock = tmp_path / "locks/0.input.lock"
    lock.parent.mkdir()
    lock.touch()
    assert not clear_stale(tmp_path) and lock.exists(), "nobody of ours was here before"
    assert not clear_stale(tmp_path) and lock.exists(), "this process lives"
