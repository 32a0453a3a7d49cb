"""`granstudy run`, `status`, `open`."""

import os
import shlex
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tiny_workflow import Terminal, Tiny, processes

import granstudy as gs
from granstudy.commands import opening, watching
from granstudy.support.reporter import JobProgress, write_progress


@pytest.fixture
def started(monkeypatch):
    """Commands that were started, none of them really."""
    commands = []

    class Process:
        def __init__(self, command):
            commands.append(command)
            self.interrupts = 2

        def wait(self):
            if self.interrupts:
                self.interrupts -= 1
                raise KeyboardInterrupt
            return 3

    monkeypatch.setattr(subprocess, "Popen", Process)
    return commands


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("", "snakemake --cores 2 --config study=mine.yaml results=results"),
        ("--cores 4 -n", "snakemake --cores 4 -n --config study=mine.yaml results=results"),
        (
            "--results out --config a=1 --keep-going",
            "snakemake --cores 2 --config study=mine.yaml results=out a=1 --keep-going",
        ),
        (
            "--executor slurm --jobs 10",
            "snakemake --cores 2 --executor slurm --jobs 10 --config study=mine.yaml results=results",
        ),
    ],
)
def test_run_prints_the_command_of_snakemake_and_starts_it(type_, started, typed, told):
    Path("Snakefile").touch()
    status, output = type_(f"run mine.yaml {typed}")
    assert output == told + "\n"
    assert started == [[sys.executable, "-m", *told.split()]]
    assert status == 3, "the status is that of snakemake, which ^C reaches too"


def test_run_takes_the_workflow_of_the_package_where_the_folder_has_none(type_, started):
    status, output = type_("run mine.yaml")
    (command,) = started
    assert command[3] == "--snakefile" and Path(command[4]).is_file()
    assert command[5:] == ["--cores", "2", "--config", "study=mine.yaml", "results=results"]
    assert shlex.split(output) == command[2:] and status == 3


@pytest.mark.slow
def test_control_c_lets_snakemake_end_by_itself(tmp_path):
    class Typed(Tiny):
        def command(self, *arguments, **config):
            own = [f"{name}={value}" for name, value in config.items()]
            program = "from granstudy.commands.main import granstudy; granstudy()"
            return [sys.executable, "-c", program, "run", "mine.yaml", "--config", *own]

    tiny = Typed(tmp_path)
    terminal = Terminal(tiny, seconds=3)
    terminal.wait(lambda: len(tiny.computed) >= 2)
    terminal.control_c()
    status, output = terminal.end()
    assert status != 0 and "the same command goes on" in output and "Traceback" not in output
    others = [pid for pid, _ in processes(tiny.folder) if pid != os.getpid()]
    assert others == [] and not tiny.locked


def test_status_of_a_study_that_nobody_computes(type_):
    status, output = type_("status mine.yaml")
    assert status == 0 and "mine: 0 of 2 runs are done" in output
    assert "nothing runs now; on one core about" in output
    gs.open_study("mine.yaml").compute(workers=1, progress=False)
    status, output = type_("status mine.yaml --watch")
    assert status == 0 and "2 of 2 runs are done" in output and "left" not in output
    assert "2 trusted" in output or "untrusted" in output or "marginal" in output


def progress(job, **values):
    now = time.time()
    known = {"runs": 5, "done": 1, "started": now, "updated": now, "left": 90.0}
    return JobProgress(job=job, title="cooling", host=socket.gethostname(), **known | values)


def test_status_shows_what_each_job_computes(type_, here):
    study = gs.open_study("mine.yaml")
    jobs = study.layout.jobs
    alive = {"pid": os.getpid()}
    running = {
        "a": progress("a", run="cooling/e~0.5", step=3, steps=10, **alive),
        "b": progress("b", done=4, left=30.0, **alive),
        "ended": progress("ended", state="done", **alive),
        "dead": progress("dead", updated=0.0, **alive),
    }
    for name, one in running.items():
        write_progress(jobs / f"{name}.progress.json", one)
    status, output = type_("status mine.yaml")
    assert status == 0
    lines = output.splitlines()
    assert lines[1] == "  run 2 of 5  cooling/e~0.5  step 3 of 10  about 2 min left"
    assert lines[2] == "  run 5 of 5  cooling  about 30 s left"
    assert lines[3] == "  about 2 min left" and len(lines) == 4


def test_status_tells_of_stale_runs(type_):
    gs.open_study("mine.yaml").compute(workers=1, progress=False)
    text = Path("mine.yaml").read_text()
    Path("mine.yaml").write_text(text.replace("t_final: 0.1", "t_final: 0.2"))
    assert "2 of the others are stale (parameters or code changed)" in type_("status mine.yaml")[1]


def test_watching_ends_when_all_runs_are_done(type_, monkeypatch):
    looks = []

    def compute(seconds):
        looks.append(seconds)
        if len(looks) == 2:
            gs.open_study("mine.yaml").compute(workers=1, progress=False)

    monkeypatch.setattr(watching.time, "sleep", compute)
    status, output = type_("status mine.yaml --watch")
    assert status == 0 and looks == [watching.EVERY] * 2
    assert output.count("mine: 0 of 2") == 2 and output.count("mine: 2 of 2") == 1


def test_open_gives_the_study_to_ipython(type_, monkeypatch):
    begun = {}
    monkeypatch.setattr(opening.IPython, "start_ipython", lambda **how: begun.update(how))
    status, output = type_("open mine.yaml")
    assert status == 0 and begun["user_ns"]["study"].name == "mine"
    assert "0 of 2 runs are done" in output and "study.dataset('cooling')" in output
