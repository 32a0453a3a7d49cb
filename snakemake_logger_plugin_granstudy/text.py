"""What the screen says, as text; functions without a terminal."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from snakemake_logger_plugin_granstudy.overview import LABELS, Now

MOST_JOBS = 6
"""Running jobs that get a line each; more are counted."""

LOG_LINES = 15
"""Last lines of the log of a failed job that are shown."""


def duration(seconds: float) -> str:
    """A duration as granstudy writes it; imported late, as Snakemake has imported granstudy by then."""
    from granstudy.support.reporter import duration as words

    return words(seconds)


def block(now: Now, starting: int, making: Sequence[str], width: int) -> list[str]:
    """The live lines: the study, its running jobs, other steps that run; each at most ``width`` wide.

    Parameters
    ----------
    starting : int
        Jobs of runs that have not yet told where they are.
    making : sequence of str
        Steps that are made, such as tables.
    """
    lines = [f"granstudy {head(now)}"]
    lines += [f"  {job_line(job)}" for job in now.running[:MOST_JOBS]]
    if len(now.running) > MOST_JOBS:
        lines.append(f"  and {len(now.running) - MOST_JOBS} more jobs")
    if starting:
        lines.append("  a job starts" if starting == 1 else f"  {starting} jobs start")
    if making:
        lines.append(f"  making {', '.join(making)}")
    return [line if len(line) <= width else line[: width - 3] + "..." for line in lines]


def head(now: Now) -> str:
    """The study in a line: runs done of all, labels, time left."""
    parts = [now.overview.study, f"runs {now.done} of {now.overview.runs}"]
    if now.labels:
        parts.append(label_counts(now.labels))
    if now.done < now.overview.runs:
        parts.append(f"about {duration(now.left)} left")
    return "  ".join(parts)


def label_counts(labels: Counter[str]) -> str:
    """Counts of runs by label: the four known ones, and others that occur."""
    names = [*LABELS, *sorted(set(labels) - set(LABELS))]
    return " ".join(f"{name} {labels[name]}" for name in names)


def job_line(job: Any) -> str:
    """A running job: its experiment, run and step."""
    parts = [job.title, f"run {min(job.done + 1, job.runs)} of {job.runs}"]
    parts += [job.run] if job.run else []
    parts += [f"step {job.step} of {job.steps}"] if job.steps else []
    parts += [f"t = {job.time:.4g}"] if job.time is not None else []
    return "  ".join(parts)


def beginning(now: Now) -> str:
    """What is to be done, in a line."""
    left = now.overview.runs - now.done
    if not left:
        return f"{now.overview.study}: all {now.overview.runs} runs are done, tables and figures are left"
    cores = now.overview.cores
    on = f"{cores} cores" if cores > 1 else "one core"
    return (
        f"{now.overview.study}: {left} of {now.overview.runs} runs to compute, "
        f"about {duration(now.left)} on {on}"
    )


def error(what: str, logs: Sequence[str], whole: bool, remarks: Sequence[str] = ()) -> list[str]:
    """A failed job: what it is, where its log is, and how the log ends."""
    lines = [f"FAILED  {what}", *(f"  {remark}" for remark in remarks)]
    for log in logs:
        text = _read(log)
        if text is None:
            lines.append(f"  log {log}: no such file")
            continue
        said = [line for line in text.splitlines() if line.strip()]
        lines.append(f"  log {log}:" if said else f"  log {log}: empty")
        lines += [f"    {line}" for line in (said if whole else said[-LOG_LINES:])]
    return lines


def ending(
    now: Now,
    made: Sequence[str],
    failed: Sequence[str],
    stopped: bool,
    goes_on: str,
    page: str = "",
) -> list[str]:
    """The last lines: where results are, how many runs of which label, what was made, what failed.

    Parameters
    ----------
    page : str
        The study on one page; "" where there is none.
    """
    done = f"{now.done} of {now.overview.runs} runs are done"
    lines = [f"stopped: {done}; {goes_on}"] if stopped else []
    counts = f": {label_counts(now.labels)}" if now.labels else ""
    lines.append(f"{now.overview.results}: {done}{counts}")
    lines += [f"  made    {line}" for line in _by_kind(made)]
    lines += [f"  failed  {line}" for line in _by_kind(failed)]
    lines += [f"  read    {page}"] if page else []
    return lines


def _by_kind(steps: Sequence[str]) -> list[str]:
    """Steps as ``table cooling, map``, a line a kind."""
    kinds: dict[str, list[str]] = {}
    for step in steps:
        kind, _, name = step.partition(" ")
        kinds.setdefault(kind, []).append(name)
    return [f"{kind} {', '.join(names)}".strip() for kind, names in kinds.items()]


def _read(path: str) -> str | None:
    try:
        return Path(path).read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
