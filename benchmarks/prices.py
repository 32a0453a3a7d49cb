"""Prices told against prices paid: seconds and memory of runs, as a plan says them and as they were.

    python benchmarks/prices.py docs/results/checks/prices.csv [--each 4] [--gases 8] [--most 40] [--again]

computes runs of the shipped studies, and random gases to an accuracy, one after the other on one thread, as a
job does. It writes a line a run, and prints a summary; on Linux. ``--each`` runs of every experiment are
taken, those whose names have the smallest hashes, but for runs that are told to take more than ``--most``
seconds. ``--again`` keeps what was measured in an earlier table, and tells anew.

Seconds are of the processor, which other programs on the machine hardly change. Compiled loops are loaded
before: a plan counts that with the start of a job. Tensors begin from an empty cache, each told until a run
has made it.
"""

import argparse
import ctypes
import gc
import hashlib
import json
import os
import shutil
import signal
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

import granstudy as gs
from granstudy.accuracy.asked import Accuracy
from granstudy.collision.fourier.wisdom import wisdom_path
from granstudy.collision.operator import collision_operator
from granstudy.runs.computation import Computation
from granstudy.runs.estimates import estimate_run
from granstudy.runs.execute import execute
from granstudy.runs.labels.cases import random_case
from granstudy.study.study import load_study
from granstudy.support.cache import VARIABLE, cache_folder

ROOT = Path(__file__).parents[1]
LIBC = ctypes.CDLL(None)
STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")

ACCURACIES = (1e-2, 1e-4, 1e-6)
"""What the random gases are asked to."""

ROUNDS = 3
"""Evaluations of Q in a benchmark's run."""

PATIENCE = 90
"""Seconds of the processor after which a run is stopped."""

FACTOR, MEMORY_PART = 2.0, 0.25
"""A price is told well within this factor in seconds, and within this part in memory."""


class Case(NamedTuple):
    """A run: where it comes from, its name, and what it computes."""

    group: str
    name: str
    computation: Computation


class Paid(NamedTuple):
    """What a run took."""

    seconds: float
    memory_mb: float
    evaluations: int
    outcome: str


def cases(each: int, gases: int) -> Iterator[Case]:
    """Runs of the shipped studies, gases and states to an accuracy."""
    for file in sorted((ROOT / "studies").glob("*.yaml")):
        study = load_study(file)
        for experiment, runs in study.runs.items():
            names = sorted(runs, key=lambda name: hashlib.sha256(name.encode()).digest())
            for name in names[:each]:
                yield Case(f"{file.stem}/{experiment}", name, runs[name].computation)
    for seed, asked in [(seed, asked) for seed in range(gases) for asked in ACCURACIES]:
        case, solver = random_case(seed), Accuracy.of(asked).solver
        computation = Computation(
            "evolution", case.scene, solver, {"t_final": float(case.time["t_final"])}
        )
        yield Case("accuracy", f"seed~{seed}/accuracy~{asked:g}", computation)
    for e, asked in [(e, asked) for e in (0.2, 0.5, 0.8) for asked in ACCURACIES]:
        scene = gs.load_scene("maxwellian3d", exponent=0.5, restitution=e, diffusion=0.0)
        computation = Computation("cooling state", scene, Accuracy.of(asked).solver)
        yield Case("accuracy of states", f"e~{e}/accuracy~{asked:g}", computation)


def told(computation: Computation) -> Paid:
    """Seconds on one core, megabytes and evaluations, as a plan says them."""
    estimate = estimate_run(computation)
    seconds, evaluations = estimate.cost.seconds, estimate.evaluations
    if computation.kind == "benchmark":
        seconds, evaluations = estimate.cost.setup + ROUNDS * estimate.cost.each, ROUNDS
    return Paid(seconds, estimate.cost.memory_mb, evaluations, "")


def compute(computation: Computation) -> tuple[int, str]:
    """Compute a run, and say how many evaluations it made, where it says so, and how it ended."""
    scene, solver = computation.scene, replace(computation.solver, threads=1)
    if computation.kind != "benchmark":
        ds = execute(computation, threads=1)
        evaluations = json.loads(ds.attrs.get("steps", "{}")).get("evaluations", 0)
        return evaluations, "ok" if int(ds.get("status", 0)) == 0 else "ended early"
    operator = collision_operator(scene, solver)
    f = scene.density(operator.grid)
    for _ in range(ROUNDS):
        operator(f)
    return ROUNDS, "ok"


class TookTooLongError(Exception):
    """A run was stopped after `PATIENCE`."""


def measured(computation: Computation, first: float) -> Paid:
    """Compute a run, as a job does that has computed others before, and say what it took.

    ``first`` is the memory that the process held before all runs.
    """
    gc.collect()
    LIBC.malloc_trim(0)
    CLEAR.write_text("5")  # the peak begins anew
    before = megabytes("VmRSS")
    signal.setitimer(signal.ITIMER_PROF, PATIENCE)
    start = time.process_time()
    try:
        evaluations, outcome = compute(computation)
    except (ValueError, ArithmeticError) as error:
        evaluations, outcome = 0, f"failed: {type(error).__name__}"
    except TookTooLongError:
        evaluations, outcome = 0, f"stopped after {PATIENCE} s"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    seconds = time.process_time() - start
    # in a process of its own the run would begin with what this one held before all runs
    peak = megabytes("VmHWM") - before + first
    return Paid(seconds, peak, evaluations, outcome)


def megabytes(name: str) -> float:
    """Memory of this process as the system calls it: ``VmRSS`` now, ``VmHWM`` at the peak."""
    lines = STATUS.read_text().splitlines()
    return int(next(line for line in lines if line.startswith(name)).split()[1]) / 1024


def stop(*signalled: object) -> None:
    """What the alarm does."""
    raise TookTooLongError


def warm_up() -> None:
    """Load the compiled loops of all methods."""
    scene = gs.load_scene("three_gaussians3d", exponent=1.0)
    for method in ("fast", "literal", "direct", "carleman"):
        solver = gs.Solver(N=8, R=8.0, N_rho=4, M_sph=6, method=method, threads=1)
        elastic = replace(scene, restitution=1.0 if method == "carleman" else 0.5)
        gs.simulate(elastic, solver, t_final=0.02, dt=0.01, progress=False)
    gas = gs.load_scene("maxwellian3d", exponent=1.0, diffusion=0.0)
    gs.simulate(gas, t_final=0.1, accuracy=1e-2, progress=False)
    gs.simulate(gas, gs.Solver(N=8, R=8.0, particles=1000, method="dsmc"), t_final=0.1, dt=0.1)


def table(given: argparse.Namespace, before: pd.DataFrame | None) -> pd.DataFrame:
    """A line a run: what was told and what was paid; ``before`` has what was paid already."""
    known = {}
    if before is not None:
        known = {
            (row.group, row.name_): Paid(row.seconds, row.memory_mb, row.evaluations, row.outcome)
            for row in before.rename(columns={"name": "name_"}).itertuples()
        }
    rows, first = [], megabytes("VmRSS")
    for found in cases(given.each, given.gases):
        if not found.group.startswith(given.only):
            continue
        # A copy: the study's own was estimated when it was read, before any tensor was there.
        case = found._replace(computation=replace(found.computation))
        if before is not None and (case.group, case.name) not in known:
            continue
        price = told(case.computation)
        if before is not None:  # a run that computes a tensor keeps it for those to come
            for name, _ in estimate_run(case.computation).cost.kept:
                (cache_folder() / f"{name}.npy.sha256").touch()
        if before is None and price.seconds > given.most:
            continue
        paid = known.get((case.group, case.name)) or measured(case.computation, first)
        row = {
            "group": case.group,
            "name": case.name,
            "kind": kind_of(case),
            "told_seconds": float(f"{price.seconds:.3g}"),
            "seconds": float(f"{paid.seconds:.3g}"),
            "told_memory_mb": price.memory_mb,
            "memory_mb": round(paid.memory_mb, 0),
            "told_evaluations": price.evaluations,
            "evaluations": paid.evaluations,
            "outcome": paid.outcome,
        }
        rows.append(row)
        print(*row.values(), flush=True)
        pd.DataFrame(rows).to_csv(given.file, index=False)
    return pd.DataFrame(rows)


def kind_of(case: Case) -> str:
    """Kind of a run, by what decides its price."""
    computation = case.computation
    if case.group.startswith("accuracy"):
        return case.group
    if computation.kind in ("benchmark", "labels", "collision"):
        return computation.kind
    method = estimate_run(computation).choice.solver.method
    if computation.time is None:
        return f"state, {method}"
    steps = "steps" if computation.time.time_rtol is None else "adaptive"
    return f"evolution, {method}" + (f", {steps}" if method != "dsmc" else "")


def summary(rows: pd.DataFrame) -> str:
    """By kind: runs, the share told well, and the told over the paid."""
    rows = rows[rows["outcome"] == "ok"]
    ratio = rows["told_seconds"] / rows["seconds"]
    memory = rows["told_memory_mb"] / rows["memory_mb"] - 1.0
    lines = pd.DataFrame(
        {
            "kind": rows["kind"],
            "well": (ratio > 1 / FACTOR) & (ratio < FACTOR),
            "ratio": ratio,
            "memory well": memory.abs() < MEMORY_PART,
            "memory": memory + 1.0,
        }
    )
    by_kind = lines.groupby("kind").agg(
        runs=("well", "size"),
        well=("well", "mean"),
        least=("ratio", "min"),
        median=("ratio", "median"),
        most=("ratio", "max"),
        memory_well=("memory well", "mean"),
        memory=("memory", "median"),
    )
    whole = f"all {len(lines)} runs: {lines['well'].mean():.3f} within a factor {FACTOR:g}, "
    whole += f"memory {lines['memory well'].mean():.3f} within {MEMORY_PART:g}"
    return f"{by_kind.round(2).to_string()}\n{whole}"


def main() -> None:
    """Tell, compute, write, sum up."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("file", type=Path, help="the table")
    parser.add_argument("--each", type=int, default=4, help="runs of an experiment")
    parser.add_argument("--gases", type=int, default=8, help="random gases to an accuracy")
    parser.add_argument("--most", type=float, default=40.0, help="seconds told at most")
    parser.add_argument("--only", default="", help="groups of runs whose name begins so")
    parser.add_argument("--again", action="store_true", help="tell anew what was measured before")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    before = pd.read_csv(given.file) if given.again else None
    kept = wisdom_path()
    with tempfile.TemporaryDirectory() as cache:
        os.environ[VARIABLE] = cache
        if kept.is_file():
            shutil.copy(kept, cache)
        if before is None:
            signal.signal(signal.SIGPROF, stop)
            warm_up()
        rows = table(given, before)
    print(summary(rows))


if __name__ == "__main__":
    sys.exit(main())
