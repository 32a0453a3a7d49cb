"""`granstudy status`: how far a study is, once or until it is done."""

import sys
import time
from collections import Counter

import click

from granstudy.commands.options import RESULTS, STUDY
from granstudy.study.layout import Layout
from granstudy.study.state import State, labels
from granstudy.study.study import load_study
from granstudy.support.reporter import JobProgress, duration, read_progress

EVERY = 2.0
"""Seconds between two looks."""


@click.command()
@STUDY
@RESULTS
@click.option(
    "--watch", is_flag=True, help="Look again every two seconds, until all runs are done."
)
def status(study: str, results: str, watch: bool) -> None:
    """Say how far a study is: runs done, what each job computes, the time left, labels so far."""
    layout = Layout(load_study(study), results)
    lines = 0
    while True:
        text = standing(layout, time.time())
        if lines and sys.stdout.isatty():
            click.echo(f"\033[{lines}F\033[J", nl=False)
        click.echo(text)
        lines = text.count("\n") + 1
        if not watch or not State(layout).missing:
            return
        time.sleep(EVERY)


def standing(layout: Layout, now: float) -> str:
    """How far a study is, as text.

    Parameters
    ----------
    layout : Layout
    now : float
        Seconds since 1970.
    """
    state = State(layout)
    all_runs = len({member.key for member in layout.study.members})
    left = len(state.missing)
    head = f"{layout.study.name}: {all_runs - left} of {all_runs} runs are done"
    words = Counter(state.words().values())
    if words["stale"]:
        head += f", {words['stale']} of the others are stale (parameters or code changed)"
    running = [
        job
        for job in read_progress(layout.jobs)
        if job.state == "running" and not job.is_stale(now)
    ]
    lines = [head, *map(_job, running)]
    if left:
        cores = max(1, sum(job.threads for job in running))
        seconds = max([state.seconds / cores, *(job.left for job in running)])
        what = "about" if running else "nothing runs now; on one core about"
        lines.append(f"  {what} {duration(seconds)} left")
    counts = labels(state)
    if counts:
        lines.append("  " + ", ".join(f"{counts[word]} {word}" for word in counts))
    return "\n".join(lines)


def _job(job: JobProgress) -> str:
    """What a job computes now."""
    parts = [f"  run {min(job.done + 1, job.runs)} of {job.runs}", job.run or job.title]
    parts += [f"step {job.step} of {job.steps}"] if job.steps else []
    return "  ".join([*parts, f"about {duration(job.left)} left"])
