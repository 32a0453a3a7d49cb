"""What only Linux has is not needed: a study runs where it is taken away."""

import os
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]

TAKEN_AWAY = """
import os, signal, sys
from pathlib import Path
import dask.distributed, matplotlib.pyplot, numba, psutil, scipy.integrate, snakemake.api, xarray

for name in ("fcntl", "resource", "termios", "pwd", "grp"):
    sys.modules[name] = None  # Windows has none of these
for name in ("sched_getaffinity", "sysconf", "O_DIRECTORY", "fork", "getuid", "killpg", "setsid"):
    delattr(os, name)
for name in ("SIGKILL", "SIGALRM", "SIGHUP", "pthread_kill"):
    delattr(signal, name)

def refuse(*paths, **how):
    raise OSError("this disk knows no links")

os.link = os.symlink = refuse
open_ = os.open
os.open = lambda path, *how: refuse() if os.path.isdir(path) else open_(path, *how)
read_text = Path.read_text
Path.read_text = lambda path, *how, **more: (
    refuse() if str(path).startswith(("/proc", "/sys")) else read_text(path, *how, **more)
)
is_file = Path.is_file
Path.is_file = lambda path: not str(path).startswith("/proc") and is_file(path)
"""

EVERYTHING = """
import pkgutil
import granstudy, snakemake_logger_plugin_granstudy
for package in (granstudy, snakemake_logger_plugin_granstudy):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        __import__(module.name)
"""

A_STUDY = """
import granstudy as gs
from snakemake_logger_plugin_granstudy import interrupt, locks
from granstudy.study.sizes import machine_memory_mb
from granstudy.support import machine
from granstudy.support.reporter import _alive

if __name__ == "__main__":
    study = gs.open_study({
        "title": "cooling",
        "experiments": {"cooling": {
            "title": "cooling", "run": "evolution",
            "scene": {"name": "maxwellian2d", "diffusion": 0.0},
            "solver": {"method": "radial", "N": 12, "R": 7.0},
            "time": {"t_final": 0.1, "dt": 0.05},
            "sweep": [{"e": [0.5, 0.7]}],
            "table": {"quantity": "temperature"},
        }},
    })
    study.compute(workers=1, progress=False)
    assert study.dataset("cooling")["temperature"].sizes["e"] == 2
    assert len(list(Path("results/.runs").rglob("*.nc"))) == 2
    assert machine.cores() >= 1 and machine.memory() is None and machine_memory_mb() > 256
    assert _alive(os.getpid()) and not _alive(2**30)
    locks.clear_stale()
    interrupt.install()
    print("whole")
"""

MEMORY = """
import types
from granstudy.study.benchmark import timing

class Process:
    def memory_info(self):
        return types.SimpleNamespace(peak_wset=2048 * 1024)

psutil.Process = Process
assert timing._peak_kilobytes() == 2048
print("whole")
"""


def run(folder, *parts):
    script = folder / "script.py"
    script.write_text("\n".join(parts))
    environment = os.environ | {"PYTHONPATH": str(REPOSITORY)}
    done = subprocess.run(
        [sys.executable, str(script)], cwd=folder, env=environment, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False,
    )  # fmt: skip
    assert done.returncode == 0 and "whole" in done.stdout, done.stdout


def test_a_study_needs_nothing_that_only_linux_has(tmp_path):
    run(tmp_path, TAKEN_AWAY, EVERYTHING, A_STUDY)


def test_the_peak_of_memory_is_asked_of_windows(tmp_path):
    run(tmp_path, TAKEN_AWAY, MEMORY)
