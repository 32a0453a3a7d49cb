"""A study before it runs, an experiment a line: runs done and left, seconds, memory."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

from granstudy.analysis.tables.markdown import github_table
from granstudy.collision.choice.cost import one_after_the_other
from granstudy.runs.estimates import Estimate, estimate_run
from granstudy.study.benchmark.timing import LEAST_SECONDS
from granstudy.study.jobs import jobs
from granstudy.study.layout import Layout
from granstudy.study.run import Run
from granstudy.study.state import State
from granstudy.support.reporter import duration

START, JOB, TABLE, FIGURE, MEASURED = 5.0, 1.5, 2.5, 4.0, 3.0
"""Seconds on a quiet machine: Snakemake's start, a job's, a table, a figure, and the process that
measures the memory of one run of a benchmark."""


@dataclass(frozen=True)
class Line:
    """One experiment before it runs.

    Attributes
    ----------
    experiment : str
    runs, left : int
        All its runs, references and truths among them; those that are not in the store. A run that several
        experiments have is left in the first of them alone.
    seconds : float
        Estimated seconds of those that are left, on one core.
    memory_mb : int
        Estimated memory of the largest of them.
    methods : str
        Methods of those that are left.
    """

    experiment: str
    runs: int
    left: int
    seconds: float
    memory_mb: int
    methods: str


def study_lines(layout: Layout) -> list[Line]:
    """A line for each experiment of a study."""
    state = State(layout)
    first = [same[0] for same in state.missing]
    own = {
        name: list(runs.values())
        if layout.study.is_timed(name)
        else [m.run for m in first if m.experiment == name]
        for name, runs in layout.study.runs.items()
    }
    estimates = {
        name: [estimate_run(run.computation) for run in runs] for name, runs in own.items()
    }
    # what one run keeps in the cache no other run computes, of whichever experiment
    shared = iter(one_after_the_other(e.cost for some in estimates.values() for e in some))
    lines = []
    for name, runs in own.items():
        some = estimates[name]
        seconds = sum(itertools.islice(shared, len(some)))
        if layout.study.is_timed(name):
            seconds = _timed(runs, some)
        methods = dict.fromkeys(one.choice.solver.method for one in some)
        memory = max((one.cost.memory_mb for one in some), default=0)
        whole = len(layout.study.runs[name])
        lines.append(Line(name, whole, len(runs), seconds, memory, ", ".join(methods)))
    return lines


def _timed(runs: Sequence[Run], estimates: Sequence[Estimate]) -> float:
    """Seconds of a benchmark: set-ups, rounds of each series, on one thread too, and memory."""
    timing, own = (
        runs[0].timing,
        [e for run, e in zip(runs, estimates, strict=True) if not run.is_reference],
    )
    series: dict[int | None, float] = {}
    for one in own:
        grid = None if runs[0].has_reference else one.choice.solver.N
        series[grid] = series.get(grid, 0.0) + timing.rounds * one.cost.each
    rounds = sum(max(seconds, LEAST_SECONDS) for seconds in series.values())
    alone = sum(e.cost.seconds for run, e in zip(runs, estimates, strict=True) if run.is_reference)
    setups = sum(one_after_the_other(e.cost for e in own)) - sum(
        e.evaluations * e.cost.each for e in own
    )
    return (
        alone + (setups + rounds) * (1 + timing.single_thread) + len(own) * MEASURED * timing.memory
    )


def overview(layout: Layout, cores: int) -> str:
    """A study's plan as text: a line an experiment, and the whole with what comes on top."""
    lines = study_lines(layout)
    rows = [
        [
            line.experiment,
            f"{line.runs - line.left} of {line.runs}",
            duration(line.seconds) if line.left else "–",
            f"{line.memory_mb} MB" if line.left else "–",
            line.methods,
        ]
        for line in lines
    ]
    heads = ["experiment", "runs done", "left, on one core", "memory", "methods"]
    table = github_table(heads, rows, ["left", "right", "right", "right", "left"])
    return f"{table}\n\n{_whole(layout, lines, cores)}"


def _whole(layout: Layout, lines: Sequence[Line], cores: int) -> str:
    """What all takes together: the runs on all cores, starts, tables and figures."""
    alone = sum(line.seconds for line in lines if layout.study.is_timed(line.experiment))
    shared = sum(line.seconds for line in lines) - alone
    missing = State(layout).missing
    count = len(jobs(missing, cores)) if missing else 0
    experiments = layout.study.model.experiments.values()
    tables = sum(one.table is not None for one in experiments)
    figures = sum(one.figure is not None for one in experiments)
    on_top = START + ceil(count / cores) * JOB + (tables * TABLE + figures * FIGURE) / cores
    total = shared / cores + alone + on_top
    parts = [f"runs {duration(shared / cores)}"] if missing else []
    parts += [f"benchmarks {duration(alone)}"] if alone else []
    parts += [f"starts, {tables} tables and {figures} figures {duration(on_top)}"]
    left = len(missing)
    return (
        f"{left} runs are left. About {duration(total)} on {cores} cores: {', '.join(parts)}."
        if left or alone
        else f"All runs are done. Starts, {tables} tables and {figures} figures: {duration(on_top)}."
    )
