"""The log of a script, in processes of its own."""

import signal
import subprocess
import sys

SCRIPT = """
import os, sys, time
from granstudy.support.log import log_to
log_to(sys.argv[1])
print("said")
os.system("echo by another")
try:
    print("begun", flush=True)
    {work}
finally:
    print("swept")
"""


def start(log, work):
    return subprocess.Popen(
        [sys.executable, "-c", SCRIPT.format(work=work), str(log)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip


def test_all_that_is_said_and_raised_is_in_the_log(tmp_path):
    process = start(tmp_path / "logs/a.log", "raise ValueError('N=-10')")
    assert process.communicate()[0] == ""
    assert process.returncode == 1
    lines = (tmp_path / "logs/a.log").read_text().splitlines()
    assert lines[:4] == ["said", "by another", "begun", "swept"]
    assert lines[-1] == "ValueError: N=-10"


def test_sigterm_ends_it_through_the_stack_and_without_a_traceback(tmp_path):
    log = tmp_path / "a.log"
    process = start(log, "time.sleep(600)")
    while not (log.exists() and "begun" in log.read_text()):
        assert process.poll() is None
    process.send_signal(signal.SIGTERM)
    assert process.communicate(timeout=60)[0] == ""
    assert process.returncode == 128 + signal.SIGTERM
    assert log.read_text().splitlines() == ["said", "by another", "begun", "swept"]


def test_what_granstudy_logs_is_in_the_log_and_of_others_warnings_alone(tmp_path):
    work = (
        "import logging; [logging.getLogger(name).log(level, f'{name} {level}') "
        "for name in ('granstudy.runs.a', 'other') for level in (10, 20, 30)]"
    )
    assert start(tmp_path / "a.log", work).wait() == 0
    lines = [line.partition(" ")[2] for line in (tmp_path / "a.log").read_text().splitlines()]
    said = ["granstudy.runs.a 20", "granstudy.runs.a 30", "other 30"]
    assert [line for line in lines if line in said or "10" in line or "20" in line] == said
