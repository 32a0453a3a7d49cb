"""One evaluation of Q on a GPU beside the CPU of the same machine: tests, equality, seconds, memory.

    python benchmarks/gpu.py docs/results/checks

runs the tests of the GPU, then evaluates Q of a scene without symmetry on grids of ascending size. It writes
``gpu.csv``, ``gpu.md`` and the output of the tests, ``gpu_tests.txt``, into the folder; the tables anew after
each size. What does not fit into the time, or fails, is said in them. The exit status is 1 where a test or a
measurement failed, or a GPU's Q differs from the CPU's.
"""

import argparse
import contextlib
import functools
import gc
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from gpu_table import EQUAL, Report, Row, facts_of_machine

import granstudy as gs
from granstudy.collision.fast.adaptive.build import planned_operator
from granstudy.collision.fast.adaptive.plan import QuadraturePlan
from granstudy.collision.fast.adaptive.search import make_plan
from granstudy.collision.fast.gpu.device import LIBRARIES, Device
from granstudy.collision.fast.gpu.operator import operator_on
from granstudy.collision.fast.operator import GainLossOperator, fast_operator, nodal_operator
from granstudy.model.solver import SizedSolver
from granstudy.study.benchmark.timing import peak_memory_mb

ROOT = Path(__file__).parents[1]
TESTS = "tests/collision/fast/gpu"

SCENE = gs.load_scene("three_gaussians3d", restitution=0.5, kernel=gs.hard_spheres(3))
R = 7.0
FIXED = {"N_rho": 30, "M_sph": 38, "sphere_rule": "lebedev"}
RULES: dict[str, dict[str, Any]] = {"30 x 38": FIXED, "rtol=1e-3": {"rtol": 1e-3}}

ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Variables that give each process of the tests one thread for its matrix products."""

ROUNDS = 15
"""Evaluations that a median is taken over."""

PATIENCE = 4.0
"""Seconds after which no further evaluation is timed."""

RESERVE = 20.0
"""Seconds kept for what is written last."""

BATCHES = (2**24, 2**26, 2**28, 2**30, 2**32)
"""Memory of a batch in bytes, tried on each size."""


Plan = Callable[[], QuadraturePlan | None]
"""Chooses a quadrature when it is first called."""


def no_plan() -> None:
    """No plan: a fixed rule."""


class Clock:
    """The time that is left, and what a measurement will take by the one on the last smaller grid."""

    def __init__(self, minutes: float) -> None:
        self._end = time.perf_counter() + 60.0 * minutes - RESERVE
        self._seconds: dict[tuple[str, str, str], tuple[int, float]] = {}

    @property
    def left(self) -> float:
        """Seconds that are left."""
        return self._end - time.perf_counter()

    def refusal(self, row: Row) -> str:
        """Why a measurement is left out, empty where it fits."""
        N, seconds = self._seconds.get((row.rule, row.precision, row.where), (row.N, 0.0))
        needed = 2.5 * seconds * (row.N / N) ** 3.3  # planning, and one or two evaluations
        return "" if needed < self.left else f"left out: {needed:.0f} s of {self.left:.0f} s left"

    def remember(self, row: Row) -> None:
        """Keep how long an evaluation takes."""
        self._seconds[row.rule, row.precision, row.where] = row.N, row.seconds


def timed(call: Callable[[], object], least: int = 2) -> list[float]:
    """Seconds of several calls after a first; of the first alone where it is long and ``least`` is 1."""
    times: list[float] = []
    while len(times) < least or (len(times) < 1 + ROUNDS and sum(times) < PATIENCE):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return times[1:] or times


class Memory:
    """Most memory of a GPU that a library has held since `__init__`."""

    def __init__(self, library: str) -> None:
        gc.collect()
        if library == "CuPy":
            import cupy

            cupy.fft.config.get_plan_cache().clear()
            pool = cupy.get_default_memory_pool()
            pool.free_all_blocks()
            self._peak = pool.total_bytes  # a pool gives nothing back by itself
        else:
            import torch

            torch.backends.cuda.cufft_plan_cache.clear()
            torch.cuda.empty_cache()
            torch.cuda.reset_peak_memory_stats()
            self._peak = torch.cuda.max_memory_reserved

    @property
    def peak_mb(self) -> float:
        """In MB of 2^20 bytes."""
        return self._peak() / 2**20


def solver_of(N: int, rule: str, precision: str, threads: int | None = None) -> SizedSolver:
    """The solver of a row."""
    settings = {**RULES[rule], "precision": precision, "threads": threads}
    return gs.Solver(N=N, R=R, method="fast", **settings).sized()


def operator_of(row: Row, plan: QuadraturePlan | None, device: Device | None) -> GainLossOperator:
    """The operator of a row: of a plan, or of the fixed rule."""
    threads = 2 if row.where == "CPU, 2 threads" else None
    solver = solver_of(row.N, row.rule, row.precision, threads)
    batch = None if np.isnan(row.batch_mb) else int(row.batch_mb * 2**20)
    make = nodal_operator if device is None else operator_on(device, batch)
    if plan is None:
        return fast_operator(SCENE, solver, make)
    return planned_operator(SCENE, solver, plan, make)


def measure(
    row: Row, plan: QuadraturePlan | None, device: Device | None, f: np.ndarray
) -> tuple[Row, np.ndarray]:
    """The row with its numbers, all but the difference, and Q."""
    memory = None if device is None else Memory(row.where)
    operator = operator_of(row, plan, device)
    Q = np.empty(0)

    def call() -> None:
        nonlocal Q
        Q = operator(f)

    times = timed(call, least=1 if device is None else 2)  # a GPU's first call compiles
    peak_mb = np.nan if memory is None else memory.peak_mb
    bare = timed(operator.transform) if device else [np.nan]
    measured = replace(
        row,
        transforms=operator.transforms,
        evaluations=len(times),
        seconds=statistics.median(times),
        transform_seconds=statistics.median(bare),
        memory_mb=peak_mb,
    )
    return measured, Q


def run_tests(folder: Path, seconds: float) -> str:
    """The last line of the tests' output, which is kept in ``gpu_tests.txt``."""
    processes = min(8, len(os.sched_getaffinity(0)))
    command = [sys.executable, "-m", "pytest", "-q", "-n", str(processes), "-p", "no:cacheprovider"]
    start = time.perf_counter()
    with open(folder / "gpu_tests.txt", "w") as log:
        try:
            status = subprocess.call(
                [*command, TESTS],
                cwd=ROOT,
                env=os.environ | dict.fromkeys(ONE_THREAD, "1"),
                stdout=log,
                stderr=subprocess.STDOUT,
                timeout=seconds,
            )
        except subprocess.TimeoutExpired:
            return f"failed: stopped after {seconds:.0f} s"
    last = (folder / "gpu_tests.txt").read_text().strip().rpartition("\n")[2].strip("= ")
    return f"{'failed: ' * (status != 0)}{last} [{time.perf_counter() - start:.0f} s]"


def find_devices(wanted: list[str]) -> tuple[dict[str, Device], dict[str, str]]:
    """The GPUs of the libraries that have one, and why the others have none."""
    devices, missing = {}, {}
    for library in wanted:
        try:
            device = LIBRARIES[library]()
        except ImportError as error:
            missing[library] = f"not installed ({error})"
            continue
        if device is None:
            missing[library] = "finds no GPU"
        else:
            devices[library] = device
    return devices, missing


def attempt(
    clock: Clock, row: Row, plan: Plan, device: Device | None, f: np.ndarray
) -> tuple[Row, np.ndarray | None]:
    """The row measured, and Q; or the row with a note why it is not, and None."""
    refusal = clock.refusal(row)
    if refusal:
        return replace(row, note=refusal), None
    try:
        measured, Q = measure(row, plan(), device, f)
    except Exception as error:  # whatever a GPU library raises, the other rows are worth having
        said = str(error).strip().splitlines() or [""]
        return replace(row, note=f"failed: {type(error).__name__}: {said[0][:200]}"), None
    clock.remember(measured)
    return measured, Q


def one_size(N: int, devices: dict[str, Device], clock: Clock, report: Report) -> None:
    """All rows of one grid."""
    cores = len(os.sched_getaffinity(0))
    places: dict[str, Device | None] = {f"CPU, {cores} threads": None, **devices}
    if cores > 2:
        places["CPU, 2 threads"] = None
    f = SCENE.density(gs.VelocityGrid(3, N, R))
    for rule, settings in RULES.items():
        plan: Plan = no_plan
        if "rtol" in settings:
            plan = functools.cache(partial(make_plan, SCENE, solver_of(N, rule, "double"), f))
        reference = None
        for precision in EQUAL:
            for where, device in places.items():
                row = Row(N, rule, precision, where)
                row, Q = attempt(clock, row, plan, device, f)
                if reference is None:
                    reference = Q
                elif Q is not None:
                    difference = np.max(np.abs(Q - reference)) / np.max(np.abs(reference))
                    row = replace(row, difference=float(np.nan_to_num(difference, nan=np.inf)))
                report.add(row)
    report.write()


def batches(N: int, devices: dict[str, Device], clock: Clock, report: Report) -> None:
    """Rows of one grid with batches that take more and less memory."""
    f = SCENE.density(gs.VelocityGrid(3, N, R))
    for library, device in devices.items():
        for batch in BATCHES:
            row = Row(N, "30 x 38", "double", library, batch_mb=batch / 2**20)
            report.add(attempt(clock, row, no_plan, device, f)[0])
    report.write()


def warm_up(devices: dict[str, Device]) -> None:
    """Compile what is compiled at a first call, before many processes of the tests do."""
    f = SCENE.density(gs.VelocityGrid(3, 8, R))
    for precision in EQUAL:
        solver = solver_of(8, "30 x 38", precision)
        fast_operator(SCENE, solver)(f)
        for device in devices.values():
            with contextlib.suppress(Exception):  # the rows will say what does not work
                fast_operator(SCENE, solver, operator_on(device))(f)


def add_cpu_memory(report: Report, clock: Clock) -> None:
    """Fill in the CPU's memory, of planning and one evaluation in processes of their own."""
    cores = len(os.sched_getaffinity(0))
    known = [row for row in report.rows if row.where == f"CPU, {cores} threads" and not row.note]

    def with_peak(row: Row) -> Row:
        if clock.left < 15.0 + 3.0 * row.seconds * max(1, cores // 4):
            return replace(row, note="memory left out: no time was left")
        return replace(
            row, memory_mb=peak_memory_mb(SCENE, solver_of(row.N, row.rule, row.precision))
        )

    with ThreadPoolExecutor(max(1, min(4, cores // 4))) as pool:
        peaks = dict(zip(map(id, known), pool.map(with_peak, known), strict=True))
    report.rows = [peaks.get(id(row), row) for row in report.rows]
    report.write()


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, write, and say by the exit status whether all is well."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="where the tables are written")
    parser.add_argument("--minutes", type=float, default=7.5, help="time that all may take")
    parser.add_argument("--sizes", type=int, nargs="+", default=[32, 64, 96, 128], help="N")
    parser.add_argument("--libraries", nargs="+", choices=LIBRARIES, default=list(LIBRARIES))
    parser.add_argument("--commit", default="", help="the commit, where there is no git to ask")
    parser.add_argument("--no-tests", action="store_true", help="leave out the tests")
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    clock = Clock(options.minutes)
    devices, missing = find_devices(options.libraries)
    report = Report(options.folder, facts_of_machine(options.commit) | missing)
    warm_up(devices)
    tests = "left out"
    if not options.no_tests:
        tests = run_tests(options.folder, min(150.0, clock.left))
    report.facts["tests of the GPU"] = tests
    print("\n".join(f"{name}: {value}" for name, value in report.facts.items()), flush=True)
    for N in sorted(options.sizes):
        one_size(N, devices, clock, report)
    for N in sorted(options.sizes):
        batches(N, devices, clock, report)
    add_cpu_memory(report, clock)
    print((options.folder / "gpu.md").read_text())
    if not devices:
        print("no GPU: nothing was measured on one")
    return int(not devices or tests.startswith("failed") or any(row.wrong for row in report.rows))


if __name__ == "__main__":
    sys.exit(main())
