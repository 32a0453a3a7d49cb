"""One store of runs: a sweep begun in Python, stopped, continued by snakemake, extended, renamed, run again.

`python benchmarks/one_store.py` does all of it in a temporary folder, for real: ^C is a SIGINT, snakemake is
started. It prints a table of what each stage computed. Every point must be computed once.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import click
import numpy as np

import granstudy as gs

REPOSITORY = Path(__file__).parents[1]

WORDS = {"diffusion": 0.0, "exponent": 1.0, "t_final": 0.5, "dt": 0.05}
"""What all points share: a gas of hard disks that cools for ten steps, on a radial grid of 16 speeds."""

SOLVER = {"method": "radial", "N": 16, "R": 8.0}

STUDY = """
title: One store
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {{name: maxwellian2d, exponent: 1.0, diffusion: 0.0}}
    solver: {{method: radial, N: 16, R: 8.0}}
    time: {{t_final: 0.5, dt: 0.05}}
    sweep:
      - e: {values}
    table: {{quantity: temperature}}
"""

STOPPED = "a sweep in Python, stopped by ^C"
CONTINUED = "the study of the same points, by snakemake"
EXTENDED = "the sweep in Python with more points"
RENAMED = "the study with all points, renamed, by snakemake"
AGAIN = "the same again"


@dataclass(frozen=True)
class Stage:
    """What one stage did.

    Attributes
    ----------
    name : str
    points : int
        Points that it asked for.
    computed : int
        Runs that it computed.
    there : int
        Runs in the store at its end.
    seconds : float
    """

    name: str
    points: int
    computed: int
    there: int
    seconds: float


def restitutions(points: int, more: int) -> list[float]:
    """The values of e: first those of the first sweep, then the further ones."""
    first = np.linspace(0.1, 0.9, points).round(6)
    further = np.linspace(0.1, 0.9, points + more + 2).round(6)
    return [*first.tolist(), *[e for e in further.tolist() if e not in first][:more]]


def written(results: Path) -> dict[str, int]:
    """When each run of the store was computed; a run that is computed again has another time."""
    files = (results / ".runs").glob("??/*.nc.json")
    return {file.name: file.stat().st_mtime_ns for file in files}


def sweep(values: list[float], results: Path) -> None:
    """What a notebook does."""
    over = {"e": values}
    gs.sweep("maxwellian2d", gs.Solver(**SOLVER), over=over, results=results, workers=2, **WORDS)


def stopped_sweep(values: list[float], results: Path) -> None:
    """The sweep in a process of its own, which gets ^C once a third of the runs is there."""
    code = (
        "import json, sys; import one_store; one_store.sweep(json.loads(sys.argv[1]), sys.argv[2])"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, json.dumps(values), str(results)],
        env=os.environ | {"PYTHONPATH": f"{Path(__file__).parent}:{REPOSITORY}"},
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while len(written(results)) < len(values) // 3 and process.poll() is None:
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does
    said = process.communicate()[1]
    if "are done and kept; the same call goes on" not in said:
        raise RuntimeError(f"the sweep was not stopped, but said:\n{said}")


def snakemake(folder: Path, study: str, values: list[float]) -> None:
    """Write the study file, and compute it."""
    for name in ("mine.yaml", "renamed.yaml"):
        (folder / name).unlink(missing_ok=True)
    (folder / study).write_text(STUDY.format(values=values))
    done = subprocess.run(
        [sys.executable, "-m", "snakemake", "--cores", "2", "--config", f"study={study}"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(REPOSITORY)},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stdout + done.stderr)


def stages(folder: Path, points: int, more: int) -> list[Stage]:
    """All stages one after the other, in a folder."""
    shutil.copy(REPOSITORY / "Snakefile", folder)
    shutil.copytree(REPOSITORY / "profiles", folder / "profiles")
    every = restitutions(points, more)
    first, results = every[:points], folder / "results"
    found = []
    for name, asked, work in (
        (STOPPED, first, lambda: stopped_sweep(first, results)),
        (CONTINUED, first, lambda: snakemake(folder, "mine.yaml", first)),
        (EXTENDED, every, lambda: sweep(every, results)),
        (RENAMED, every, lambda: snakemake(folder, "renamed.yaml", every)),
        (AGAIN, every, lambda: snakemake(folder, "renamed.yaml", every)),
    ):
        before, start = written(results), time.perf_counter()
        work()
        after, seconds = written(results), time.perf_counter() - start
        computed = sum(before.get(key) != when for key, when in after.items())
        found.append(Stage(name, len(asked), computed, len(after), seconds))
    return found


def runs_of_study(folder: Path) -> int:
    """Runs in the one dataset that the renamed study has at the end."""
    return int(gs.read_dataset(folder / "results/renamed/datasets/cooling.nc").sizes["run"])


@click.command()
@click.option("--points", default=200, show_default=True, help="Points of the first sweep.")
@click.option("--more", default=50, show_default=True, help="Points that are added.")
def main(points: int, more: int) -> None:
    """Print what each stage computed; exit with 1 unless every point was computed once."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        found = stages(folder, points, more)
        click.echo("| stage | points | computed | in the store | seconds |")
        click.echo("| :-- | --: | --: | --: | --: |")
        for one in found:
            row = (one.name, one.points, one.computed, one.there, f"{one.seconds:.1f}")
            click.echo(f"| {' | '.join(map(str, row))} |")
        total, runs = sum(one.computed for one in found), runs_of_study(folder)
        click.echo(f"\n{points + more} points, {total} computed; {runs} runs in one dataset.")
        sys.exit(0 if total == runs == points + more else 1)


if __name__ == "__main__":
    main()
