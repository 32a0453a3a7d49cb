"""Forecast of a study: seconds and memory of every run before it starts, to read and to load."""

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from granstudy.accuracy.asked import Accuracy
from granstudy.analysis.tables.markdown import github_table
from granstudy.collision.choice.cost import on_threads
from granstudy.collision.choice.methods import OPERATORS
from granstudy.evolution.forecast import Forecast, plan
from granstudy.runs.computation import Computation
from granstudy.runs.estimates import chosen, estimate_run, expected_evaluations, planned_scene
from granstudy.runs.kinds import KINDS
from granstudy.study.run import Run
from granstudy.study.study import Study
from granstudy.support.files import write_text

HEADINGS = {
    "method": "method",
    "N": "N",
    "R": "R",
    "nodes": "nodes",
    "transforms": "transforms",
    "evaluations": "evaluations",
    "seconds": "seconds (estimated)",
    "memory_mb": "memory (MB)",
}
"""Numbers of a `Forecast` in the table, and their headings."""

ONLY_CSV = ("threads", "seconds_per_evaluation", "error", "reason")
"""Further columns of the CSV file."""

Row = tuple[str, Forecast]


def study_forecasts(study: Study) -> list[Row]:
    """Forecasts of every run, references among them, by experiment and path.

    Each run has the threads of its experiment. A benchmark's runs count one evaluation each.
    """
    return [
        (f"{name}/{path}", forecast(run))
        for name, runs in study.runs.items()
        for path, run in runs.items()
    ]


def forecast(run: Run) -> Forecast:
    """Forecast one run; seconds include those of runs that it makes on its way."""
    solver = replace(run.solver, threads=run.model.threads)
    time, computation = run.time, run.computation
    if solver.accuracy is not None:
        return _to_accuracy(computation, run.model.threads)
    if time is None:
        one = plan(planned_scene(computation), solver)
        evaluations = expected_evaluations(computation)
        further = (evaluations - one.evaluations) * one.seconds_per_evaluation
        further += KINDS[computation.kind].seconds(chosen(computation).solver)
        return replace(one, evaluations=evaluations, seconds=one.seconds + further)
    one = plan(run.scene, solver, time.t_final, time.dt, time.time_rtol, time.scheme, time.frame)
    if KINDS[computation.kind].parts(computation):
        one = replace(one, seconds=estimate_run(computation).cost.seconds)
    return one


def _to_accuracy(computation: Computation, threads: int) -> Forecast:
    """Forecast of a run or a state to an accuracy, without the search for its grid."""
    estimate = estimate_run(computation)
    solver, cost = estimate.choice.solver, estimate.cost
    method = OPERATORS[solver.method].cost
    transforms = method.transforms(computation.scene, solver)
    return Forecast(
        method=solver.method,
        reason=estimate.choice.reason,
        dim=computation.scene.dim,
        N=solver.N,
        R=float(solver.R),
        nodes=method.nodes(computation.scene, solver),
        transforms=transforms,
        n=solver.N,
        threads=threads,
        seconds_per_evaluation=on_threads(cost.each, method.efficiency, threads),
        evaluations=estimate.evaluations,
        seconds=on_threads(cost.seconds, method.efficiency, threads),
        memory_mb=cost.memory_mb,
        error=None,
        plan=None,
        accuracy=Accuracy.of_solver(computation.solver).describe(),
    )


def write_plan(study: Study, md: str | Path, csv: str | Path) -> None:
    """Write a study's forecasts as Markdown and as CSV, each whole or not at all."""
    rows = study_forecasts(study)
    write_text(Path(md), markdown(study.model.title, rows))
    write_text(Path(csv), as_csv(rows))


def markdown(title: str, rows: Sequence[Row]) -> str:
    """Title, a line a run, the total, and why each method was chosen where it was."""
    lines = [[run, *(_shown(getattr(f, name)) for name in HEADINGS)] for run, f in rows]
    seconds = sum(f.seconds for _, f in rows)
    largest = max(f.memory_mb for _, f in rows)
    totals = {"seconds": _shown(seconds), "memory_mb": str(largest)}
    lines.append(["**total**", *(totals.get(name, "") for name in HEADINGS)])
    alignment = ["left", "left", *["right"] * (len(HEADINGS) - 1)]
    table = github_table(["run", *HEADINGS.values()], lines, alignment)
    reasons = "\n".join(f"- {run}: {f.reason}" for run, f in rows if f.reason)
    legend = "Total seconds are of the runs one after the other, memory is the largest run's."
    return "\n\n".join(part for part in (f"# Plan: {title}", table, legend, reasons) if part) + "\n"


def as_csv(rows: Iterable[Row]) -> str:
    """A line a run, with reason and estimated error; empty cells where there is none."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    names = (*HEADINGS, *ONLY_CSV)
    writer.writerow(["run", *names])
    for run, f in rows:
        writer.writerow([run, *("" if (v := getattr(f, name)) is None else v for name in names)])
    return stream.getvalue()


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.2g}" if value < 100 else f"{value:.0f}"
    return str(value)
