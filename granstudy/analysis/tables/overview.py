"""A study before it runs, an experiment a line: runs done and left, seconds, memory."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

from granstudy.analysis.tables.markdown import github_table
from granstudy.runs.estimates import Estimate, estimate_run
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
    lines = []
    for name, runs in layout.study.runs.items():
        timed = layout.study.is_timed(name)
        own = list(runs.values()) if timed else [m.run for m in first if m.experiment == name]
        estimates = [estimate_run(run.computation) for run in own]
        seconds = [
            _timed(run, one) if timed else one.cost.seconds
            for run, one in zip(own, estimates, strict=True)
        ]
        methods = dict.fromkeys(one.choice.solver.method for one in estimates)
        memory = max((one.cost.memory_mb for one in estimates), default=0)
        lines.append(Line(name, len(runs), len(own), sum(seconds), memory, ", ".join(methods)))
    return lines


def _timed(run: Run, estimate: Estimate) -> float:
    """Seconds of one run of a benchmark: its set-up and rounds, on one thread too, and its memory."""
    timing = run.timing
    evaluations = timing.rounds * (2 if timing.single_thread else 1)
    return estimate.cost.setup + evaluations * estimate.cost.each + MEASURED * timing.memory


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
