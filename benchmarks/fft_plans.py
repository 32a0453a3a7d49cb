"""What FFTW's plans are worth: transforms and evaluations of Q with ESTIMATE's plans and with kept wisdom.

`granstudy tune`, then `python benchmarks/fft_plans.py` writes docs/results/checks/fft_plans.csv. All that a
row compares is timed in turn in one process. Times are medians of the CPU time of all threads, so that other
processes on the machine count little; `--wall` takes the time of the clock.

=============  ==========================================================================================
column         what it holds
=============  ==========================================================================================
what           ``transforms``: a transform and its inverse on n^3 points; else the density of Q's gas
N, rtol, n     points per dimension of the grid, tolerance, points per dimension of the products
transforms     real transforms of one call
estimate_us    microseconds with ESTIMATE's plans
wisdom_us      microseconds with the plans of `granstudy tune`
gain           estimate_us over wisdom_us
bare_us        microseconds of the call's transforms alone, with the plans of `granstudy tune`
overhead       wisdom_us over bare_us
over_literal   time of `literal` with 30 x 38 nodes on the same N over wisdom_us; gas without symmetry only
=============  ==========================================================================================
"""

import csv
import io
import statistics
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click
import numpy as np

import granstudy as gs
from granstudy.collision.fourier import wisdom
from granstudy.collision.fourier.transforms import REAL, aligned_zeros
from granstudy.collision.fourier.tuning import pair_seconds
from granstudy.support.files import write_text

TABLE = Path(__file__).parents[1] / "docs" / "results" / "checks" / "fft_plans.csv"

HEADER = "what N rtol n transforms estimate_us wisdom_us gain bare_us overhead over_literal"

SIZES = (8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30, 32, 36, 40, 42, 44, 48, 50, 56, 60, 64)

GASES = {"three_gaussians3d": (1e-3, 1e-4), "bkw3d": (1e-2, 1e-3, 1e-4)}
"""Scenes, without symmetry and octahedral, and their tolerances."""

LITERAL = {"method": "literal", "N_rho": 30, "sphere_rule": "lebedev", "M_sph": 38}

TURN_SECONDS = 0.02
"""A call that takes less is repeated in its turn."""


def medians(calls: Sequence[Callable[[], object]], rounds: int, clock: Any) -> list[float]:
    """Median seconds of some calls, taken in turn."""
    taken: list[list[float]] = [[] for _ in calls]
    for turn in range(rounds + 1):
        for call, times in zip(calls, taken, strict=True):
            count = 1 if turn < 2 else max(1, round(TURN_SECONDS / max(times[0], 1e-6)))
            for _ in range(count):
                begin = clock()
                call()
                if turn > 0:  # the first turn warms up
                    times.append(clock() - begin)
    return [statistics.median(times) for times in taken]


def of_transforms(n: int, known: wisdom.Wisdom) -> dict[str, Any]:
    """The row of a transform and its inverse."""
    spectrum = aligned_zeros((n, n, n // 2 + 1), np.result_type(REAL["double"], np.complex64))
    planners = [wisdom.Planner(wisdom.Wisdom()), wisdom.Planner(known)]
    estimate, patient = pair_seconds([one.plans(spectrum, n) for one in planners], spectrum)
    return {
        **{"what": "transforms", "n": n, "transforms": 2},
        **{"estimate_us": 1e6 * estimate, "wisdom_us": 1e6 * patient, "gain": estimate / patient},
    }


def of_evaluations(
    name: str, N: int, known: wisdom.Wisdom, threads: int, rounds: int, clock: Any
) -> list[dict[str, Any]]:
    """A row for every tolerance of one gas on one grid."""
    scene = gs.load_scene(name, restitution=0.5, exponent=1.0)
    solvers = [
        gs.Solver(method="fast", N=N, R=7.0, rtol=rtol, threads=threads) for rtol in GASES[name]
    ]
    with wisdom.planning_with(wisdom.Wisdom()):
        guessed = [gs.collision_operator(scene, solver) for solver in solvers]
    with wisdom.planning_with(known):
        tuned = [gs.collision_operator(scene, solver) for solver in solvers]
    literal = gs.collision_operator(scene, gs.Solver(N=N, R=7.0, threads=threads, **LITERAL))
    f = scene.density(literal.grid)
    calls: list[Callable[[], object]] = []
    for estimate, best in zip(guessed, tuned, strict=True):
        calls += [lambda Q=estimate: Q(f), lambda Q=best: Q(f), best.transform]
    if name == "three_gaussians3d":
        calls.append(lambda: literal(f))
    seconds = medians(calls, rounds, clock)
    over = seconds[-1] if name == "three_gaussians3d" else float("nan")
    rows = []
    for i, (solver, operator) in enumerate(zip(solvers, tuned, strict=True)):
        estimate, best, bare = seconds[3 * i : 3 * i + 3]
        rows.append(
            {
                **{"what": name, "N": N, "rtol": solver.rtol, "n": operator.plan.n},
                **{"transforms": operator.transforms, "estimate_us": 1e6 * estimate},
                **{"wisdom_us": 1e6 * best, "gain": estimate / best, "bare_us": 1e6 * bare},
                **{"overhead": best / bare, "over_literal": over / best},
            }
        )
    return rows


def as_csv(rows: Sequence[dict[str, Any]]) -> str:
    """The rows as CSV; numbers with three digits, nothing where there is none."""

    def cell(value: Any) -> str:
        if isinstance(value, float):
            return "" if np.isnan(value) else f"{value:.3g}" if value < 1e3 else f"{value:.0f}"
        return str(value)

    buffer = io.StringIO()
    table = csv.writer(buffer, lineterminator="\n")
    columns = HEADER.split()
    table.writerow(columns)
    table.writerows([[cell(row.get(name, "")) for name in columns] for row in rows])
    return buffer.getvalue()


@click.command()
@click.option("--threads", default=2, show_default=True)
@click.option("--rounds", default=9, show_default=True)
@click.option("--largest", default=64, show_default=True, help="Most points per dimension of Q.")
@click.option(
    "--wall", is_flag=True, help="Time of the clock, on a machine with nothing else to do."
)
@click.option("--output", type=click.Path(path_type=Path), default=TABLE, show_default=True)
def main(threads: int, rounds: int, largest: int, wall: bool, output: Path) -> None:
    """Write the table."""
    known = wisdom.kept()
    missing = [n for n in SIZES if f"double {n}x{n}x{n}" not in known.texts]
    if missing:
        raise click.ClickException(f"no wisdom for n = {missing}: run `granstudy tune` first")
    clock = time.perf_counter if wall else time.process_time
    rows = [of_transforms(n, known) for n in SIZES]
    for name in GASES:
        for N in (32, 64):
            if largest >= N:
                rows += of_evaluations(name, N, known, threads, rounds, clock)
    text = as_csv(rows)
    write_text(output, text)
    click.echo(text)


if __name__ == "__main__":
    main()
