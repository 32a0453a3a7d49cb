"""The tables of `gpu.py`: rows, how they are written, and what is known of the machine."""

import contextlib
import os
import platform
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
import pandas as pd

from granstudy.analysis.tables.markdown import github_table
from granstudy.support.files import write_whole

EQUAL = {"double": 1e-12, "single": 1e-5}
"""Largest difference from the CPU's Q in double precision, in parts of max|Q|, that counts as round-off."""

PACKAGES = ("granstudy", "numpy", "pyfftw", "cupy-cuda12x", "cupy-cuda13x", "torch")


@dataclass(frozen=True)
class Row:
    """One measurement; numbers are NaN where there is none, and ``note`` then says why."""

    N: int
    rule: str
    precision: str
    where: str
    batch_mb: float = np.nan
    transforms: int = 0
    evaluations: int = 0
    seconds: float = np.nan
    transform_seconds: float = np.nan
    difference: float = np.nan
    memory_mb: float = np.nan
    note: str = ""

    @property
    def wrong(self) -> bool:
        """Something failed, or the difference is no round-off."""
        return self.note.startswith("failed") or self.difference > EQUAL[self.precision]


LEGEND = (
    "Scene: three_gaussians3d, e = 0.5, hard spheres, R = 7, no symmetry. Seconds are medians of one call, "
    "which takes f from the CPU's memory and brings Q back there. Rules: N_rho x M_sph, 570 pairs of nodes; "
    "or the rule that rtol chooses, whose products lie on fewer points. The difference is from the CPU's Q "
    "in double precision, in parts of max|Q|. MB: most memory that a library held on the GPU; on the CPU "
    "that of planning and one evaluation. An empty cell was not measured."
)


class Report:
    """The rows so far and what is known of the machine, written whole after each size."""

    def __init__(self, folder: Path, facts: dict[str, str]) -> None:
        self.folder = folder
        self.facts = facts
        self.rows: list[Row] = []

    def add(self, row: Row) -> None:
        """Keep a row, and print it."""
        self.rows.append(row)
        print(
            f"N={row.N:<4} {row.rule:10} {row.precision:7} {row.where:16} {row.seconds:10.4g} s, transforms "
            f"{row.transform_seconds:.4g} s, difference {row.difference:.1e}, {row.memory_mb:.0f} MB, "
            f"batch {row.batch_mb:.0f} MB {row.note}",
            flush=True,
        )

    def write(self) -> None:
        """Write ``gpu.csv`` and ``gpu.md``."""
        frame = pd.DataFrame(self.rows)
        write_whole(self.folder / "gpu.csv", lambda path: frame.to_csv(path, index=False))
        write_whole(self.folder / "gpu.md", lambda path: path.write_text(self._markdown()))

    def _markdown(self) -> str:
        parts = ["# One evaluation of Q on a GPU and on the CPU beside it", ""]
        parts += [f"- {name}: {value}" for name, value in self.facts.items()]
        for each in tables_of_places([row for row in self.rows if np.isnan(row.batch_mb)]):
            parts += ["", each]
        parts += ["", LEGEND]
        tried = [row for row in self.rows if not np.isnan(row.batch_mb)]
        if tried:
            parts += [
                "",
                "## Seconds by the memory of a batch, 30 x 38 nodes, double precision",
                "",
            ]
            parts += [table_of_batches(tried)]
        if noted := [row for row in self.rows if row.note]:
            parts += ["", "## Not measured", ""]
            parts += dict.fromkeys(
                f"- {row.where}, N = {row.N}, {row.rule}, {row.precision}: {row.note}"
                for row in noted
            )
        return "\n".join(parts) + "\n"


def tables_of_places(rows: Sequence[Row]) -> list[str]:
    """Two tables, a line for each grid, rule and precision, CPU and GPUs side by side: seconds; the rest."""
    places = list(dict.fromkeys(row.where for row in rows))
    gpus = [where for where in places if not where.startswith("CPU")]
    key = ["N", "rule", "precision"]
    speeds = key + [f"{where}: s" for where in places]
    speeds += [f"{where}: times as fast as the CPU's best" for where in gpus]
    others = [*key, "transforms", *(f"{where}: transforms alone, s" for where in gpus)]
    others += [f"{where}: difference" for where in gpus] + [f"{where}: MB" for where in places]
    lines: tuple[list[list[str]], list[list[str]]] = ([], [])
    for case in dict.fromkeys((row.N, row.rule, row.precision) for row in rows):
        at = {row.where: row for row in rows if (row.N, row.rule, row.precision) == case}
        on_cpu = [row.seconds for row in at.values() if row.where.startswith("CPU")]
        best = min((seconds for seconds in on_cpu if np.isfinite(seconds)), default=np.nan)
        made = max(row.transforms for row in at.values())
        everywhere, there = ([at[where] for where in w if where in at] for w in (places, gpus))
        for line, cells in zip(
            lines,
            (
                [
                    *(row.seconds for row in everywhere),
                    *(best / row.seconds for row in there),
                ],
                [
                    made or np.nan,
                    *(row.transform_seconds for row in there),
                    *(row.difference for row in there),
                    *(row.memory_mb for row in everywhere),
                ],
            ),
            strict=True,
        ):
            line.append([*map(str, case), *map(text, cells)])
    return [table(header, each) for header, each in zip((speeds, others), lines, strict=True)]


def table_of_batches(rows: Sequence[Row]) -> str:
    """A line for each library and grid; batches side by side."""
    sizes = list(dict.fromkeys(row.batch_mb for row in rows))
    lines = []
    for where, N in dict.fromkeys((row.where, row.N) for row in rows):
        of = {row.batch_mb: row for row in rows if (row.where, row.N) == (where, N)}
        lines.append([where, str(N), *(number(of.get(size), "seconds") for size in sizes)])
    return table(["library", "N", *(f"{size:.0f} MB" for size in sizes)], lines)


def table(header: list[str], lines: list[list[str]]) -> str:
    """A GitHub table, all columns to the right."""
    return github_table(header, lines, ["right"] * len(header))


def number(row: Row | None, name: str) -> str:
    """A number of a row as a cell, empty where there is none."""
    return "" if row is None else text(float(getattr(row, name)))


def text(value: float) -> str:
    """A number to three digits, empty where it is NaN."""
    return "" if np.isnan(value) else f"{value:.3g}" if value < 1e3 else f"{value:.0f}"


def facts_of_machine(commit: str) -> dict[str, str]:
    """Date, commit, card, driver, CPU and versions of libraries."""
    card = output(
        "nvidia-smi", "--query-gpu=name,driver_version,memory.total", "--format=csv,noheader"
    )
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    cpu = next((line.partition(":")[2].strip() for line in lines if "model name" in line), "CPU")
    versions = {}
    for package in PACKAGES:
        with contextlib.suppress(PackageNotFoundError):
            versions[package] = version(package)
    return {
        "date": datetime.now(UTC).date().isoformat(),
        "commit": commit
        or output("git", "-C", str(Path(__file__).parent), "rev-parse", "--short", "HEAD"),
        "GPU, driver, memory": card,
        "CPU": f"{cpu}, {len(os.sched_getaffinity(0))} cores",
        "Python": platform.python_version(),
        "packages": ", ".join(f"{name} {number}" for name, number in versions.items()),
    }


def output(*command: str) -> str:
    """What a command prints, or that it is not known."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()
