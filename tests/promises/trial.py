"""A trial of a promise, the small study that trials attack, and processes that can be killed."""

import hashlib
import json
import multiprocessing
import os
from dataclasses import dataclass
from pathlib import Path

import granstudy as gs
from granstudy.support.errors import DamagedFileError

EXPERIMENT = {
    "title": "Cooling",
    "run": "evolution",
    "scene": {"name": "maxwellian2d", "diffusion": 0.0},
    "solver": {"method": "radial", "N": 12, "R": 7.0},
    "time": {"t_final": 0.5, "dt": 0.05},
    "sweep": [{"e": {"start": 0.1, "stop": 0.9, "count": 9}}],
}

STUDY = {
    "title": "Attacked",
    "experiments": {
        "cooling": EXPERIMENT,
        "long": EXPERIMENT
        | {
            "time": {"t_final": 100.0, "time_rtol": 1e-8, "frame": "rescaled"},
            "sweep": [{"e": [0.3, 0.7, 1.0]}],
        },
    },
}
"""Twelve runs, of milliseconds and of tenths of a second."""

NAME = "attacked"

children = multiprocessing.get_context("forkserver")
"""Processes that have granstudy loaded and nothing computed."""
children.set_forkserver_preload(["promises.trial", "granstudy.workbench.open_study"])


@dataclass(frozen=True)
class Trial:
    """One trial: whether the promise was kept, and in a few words what happened."""

    kept: bool
    outcome: str


def study(folder):
    """The study that trials attack, with its results in a folder."""
    return gs.open_study(STUDY, name=NAME, results=folder / "results")


def compute(folder):
    """Compute what the study lacks, in one process."""
    os.chdir(folder)
    study(folder).compute(progress=False)


def start(function, *arguments):
    """A process of its own that calls a function; what it prints goes nowhere."""
    process = children.Process(target=_silent, args=(function, *arguments))
    process.start()
    return process


def _silent(function, *arguments):
    null = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(null, stream)
    os.setsid()
    function(*arguments)


def finished(folder):
    """A folder in which the study was computed and nothing went wrong."""
    process = start(compute, folder)
    process.join(300)
    assert process.exitcode == 0
    return folder


def digests(folder):
    """SHA-256 of every run in the store, by its key; the sidecars vary."""
    files = sorted((Path(folder) / "results/.runs").glob("??/[!.]*.nc"))
    return {file.stem: hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


def damaged_names(folder):
    """Files under final names that cannot be read: datasets by their checksum, JSON by its grammar."""
    found = []
    for file in sorted((Path(folder) / "results").rglob("*")):
        if file.name.startswith(".") or not file.is_file():
            continue
        try:
            if file.suffix == ".nc":
                gs.read_dataset(file)
            elif file.suffix == ".json":
                json.loads(file.read_text())
        except (OSError, ValueError, DamagedFileError):
            found.append(file.name)
    return found
