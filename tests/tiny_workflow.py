"""A workflow of jobs that take as long as they are told, with the pieces of a study around them."""

import json
import os
import pty
import select
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]

SNAKEFILE = """
import json, os
from pathlib import Path
from snakemake_logger_plugin_granstudy import interrupt, locks

shell.prefix(interrupt.SHELL_PREFIX)
if workflow.is_main_process:
    interrupt.install()
    locks.clear_stale()
    import granstudy
    done = len(list(Path("store").glob("*"))) if Path("store").exists() else 0
    Path("results/tiny/jobs").mkdir(parents=True, exist_ok=True)
    Path("results/tiny/jobs/overview.json").write_text(json.dumps(dict(
        study="tiny", results="results/tiny", runs=6, done=done, seconds=3.0 * (6 - done), cores=2,
        labels={"trusted": done})))
    os.environ["GRANSTUDY_OVERVIEW"] = "results/tiny/jobs/overview.json"

JOBS = ["a", "b"]

rule all:
    default_target: True
    input: expand("results/tiny/tables/{name}.txt", name=["good", "bad"] if config.get("bad") else ["good"])

rule runs:
    output: "results/tiny/jobs/{job}.json"
    log: "results/tiny/logs/{job}.log"
    message: "cooling: 3 runs from {wildcards.job}0"
    params: seconds=float(config.get("seconds", 0.1))
    script: "scripts/runs.py"

rule table:
    input: expand("results/tiny/jobs/{job}.json", job=JOBS)
    output: "results/tiny/tables/{name}.txt"
    log: "results/tiny/logs/table_{name}.log"
    message: "table {wildcards.name}"
    params: seconds=float(config.get("table", 0.1))
    script: "scripts/table.py"
"""

RUNS = """
import time
from pathlib import Path

from granstudy.support.log import log_to
from granstudy.support.reporter import Reporter

log_to(snakemake.log[0])
job = snakemake.wildcards.job
store = Path("store")
store.mkdir(exist_ok=True)
output = Path(snakemake.output[0])
with Reporter(output.with_suffix(".progress.json"), job, "cooling", [3.0] * 3) as reporter:
    for number in range(3):
        run = store / f"{job}{number}"
        if run.exists():
            reporter.found("trusted")
            continue
        reporter.start(run.name)
        for step in range(10):
            time.sleep(snakemake.params.seconds / 10)
            reporter.step(step + 1, 10, 0.1 * step)
        run.touch()
        with open("computed", "a") as file:
            file.write(f"{run.name}\\n")
        reporter.finish("ok", "trusted")
output.write_text("{}")
"""

TABLE = """
import time
from pathlib import Path

from granstudy.support.log import log_to

log_to(snakemake.log[0])
Path(snakemake.output[0]).write_text("half")
print("reading runs")
time.sleep(snakemake.params.seconds)
if snakemake.wildcards.name == "bad":
    raise ValueError("no such quantity: temprature")
Path(snakemake.output[0]).write_text("whole")
"""


class Tiny:
    """The workflow in a folder."""

    def __init__(self, folder):
        self.folder = folder
        (folder / "scripts").mkdir()
        (folder / "Snakefile").write_text(SNAKEFILE)
        (folder / "scripts/runs.py").write_text(RUNS)
        (folder / "scripts/table.py").write_text(TABLE)
        shutil.copytree(REPOSITORY / "profiles", folder / "profiles")
        self.environment = os.environ | {"PYTHONPATH": str(REPOSITORY), "TERM": "xterm"}

    def command(self, *arguments, **config):
        command = [sys.executable, "-m", "snakemake", "--cores", "2", *arguments]
        return [
            *command,
            "--config",
            "none=1",
            *(f"{name}={value}" for name, value in config.items()),
        ]

    def run(self, *arguments, **config):
        """Run to the end, not on a terminal; returns exit status and all output."""
        done = subprocess.run(
            self.command(*arguments, **config), cwd=self.folder, env=self.environment, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
        )  # fmt: skip
        return done.returncode, done.stdout

    @property
    def table(self):
        path = self.folder / "results/tiny/tables/good.txt"
        return path.read_text() if path.exists() else None

    @property
    def computed(self):
        path = self.folder / "computed"
        return path.read_text().split() if path.exists() else []

    @property
    def locked(self):
        return any((self.folder / ".snakemake/locks").glob("*.lock"))


class Terminal:
    """A workflow in the foreground of a terminal of its own."""

    def __init__(self, tiny, *arguments, **config):
        self.output = b""
        self.pid, self._terminal = pty.fork()
        if self.pid == 0:
            os.chdir(tiny.folder)
            command = tiny.command(*arguments, **config)
            os.execve(command[0], command, tiny.environment)

    def wait(self, condition, seconds=120):
        """Read what is written until something holds."""
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"waited {seconds} s in vain:\n{self.text}"
            if not self._read():
                assert condition(), f"ended before:\n{self.text}"

    def control_c(self):
        os.write(self._terminal, b"\x03")

    def end(self):
        """Read to the end; returns the exit status, and what was written."""
        while self._read():
            pass
        _, status = os.waitpid(self.pid, 0)
        os.close(self._terminal)
        return os.waitstatus_to_exitcode(status), self.text

    @property
    def text(self):
        return self.output.decode()

    def _read(self):
        if select.select([self._terminal], [], [], 0.05)[0]:
            try:
                data = os.read(self._terminal, 65536)
            except OSError:  # Linux, where the last process has closed the terminal
                return False
            self.output += data
            return bool(data)
        return True


def processes(folder):
    """Processes that work in a folder, by Linux's /proc."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if (entry / "cwd").readlink() == folder:
                    found.append((int(entry.name), (entry / "cmdline").read_text()))
            except OSError:
                continue
    return found


def send(kind, terminal):
    """Interrupt a workflow on a terminal."""
    if kind == "terminal":
        terminal.control_c()
    elif kind == "alone":
        os.kill(terminal.pid, signal.SIGINT)
    elif kind == "group":
        os.killpg(terminal.pid, signal.SIGINT)
    elif kind == "terminate":
        os.kill(terminal.pid, signal.SIGTERM)
    else:
        os.killpg(terminal.pid, signal.SIGKILL)


def overview(folder):
    return json.loads((folder / "results/tiny/jobs/overview.json").read_text())
