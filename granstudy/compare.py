"""Compare regenerated tables with committed ones: ok, minor, major or missing for each number.

``python -m granstudy.compare results/quick/tables tests/expected`` compares the CSV tables of two
folders, regenerated first, prints what differs, and exits with 1 where anything is major or
missing.
"""

import argparse
import csv
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from granstudy.study import SWEPT

PARAMETERS = (*SWEPT, "N_theta", "N_phi", "threads")
"""Columns that say which run a row is; all others are compared."""


class Grade(Enum):
    """How far a number is from the committed one."""

    OK = "ok"
    MINOR = "minor"
    MAJOR = "major"
    MISSING = "missing"


@dataclass(frozen=True)
class Tolerance:
    """What difference a quantity may show.

    Attributes
    ----------
    relative, absolute : float
        Differences up to relative·|committed| + absolute are ok.
    minor : float
        Differences up to so many times that are minor, beyond they are major.
    reason : str
        Why these numbers.
    """

    relative: float
    absolute: float
    minor: float
    reason: str

    def grade(self, new: float, committed: float) -> Grade:
        """Grade one number against the committed one."""
        allowed = self.relative * abs(committed) + self.absolute
        difference = abs(new - committed)
        if difference <= allowed:
            return Grade.OK
        return Grade.MINOR if difference <= self.minor * allowed else Grade.MAJOR


@dataclass(frozen=True)
class FactorTolerance:
    """As `Tolerance`, for a number whose ratio to the committed one counts, either way."""

    ok: float
    minor: float
    reason: str

    def grade(self, new: float, committed: float) -> Grade:
        """Grade one number against the committed one."""
        if new <= 0.0 or committed <= 0.0:
            return Grade.OK if new == committed else Grade.MAJOR
        factor = max(new / committed, committed / new)
        if factor <= self.ok:
            return Grade.OK
        return Grade.MINOR if factor <= self.minor else Grade.MAJOR


@dataclass(frozen=True)
class PresenceOnly:
    """The number must be there; its value is not compared."""

    reason: str

    def grade(self, new: float, committed: float) -> Grade:
        """Grade one number against the committed one: both are there."""
        return Grade.OK


AnyTolerance = Tolerance | FactorTolerance | PresenceOnly

_ROUND_OFF = (
    "deterministic up to round-off, which differs by machine (FFT plans, vector units): 1e-15 in "
    "the density at each of some 1000 evaluations"
)
_TIMING = "depends on the machine"

TOLERANCES: dict[str, AnyTolerance] = {
    "paper_temperature_error": Tolerance(1e-6, 1e-13, 100.0, _ROUND_OFF),
    "temperature_error": Tolerance(1e-6, 1e-13, 100.0, _ROUND_OFF),
    "temperature": Tolerance(1e-9, 0.0, 100.0, _ROUND_OFF),
    "density_drift": Tolerance(1e-6, 1e-12, 100.0, _ROUND_OFF),
    "collision_error": Tolerance(1e-6, 1e-13, 100.0, "as the errors; one evaluation"),
    "relative_error": Tolerance(1e-6, 1e-12, 100.0, "as collision_error"),
    "order": Tolerance(0.0, 1e-3, 100.0, "a slope of errors that carry round-off"),
    "C0": Tolerance(1e-6, 0.0, 100.0, "an optimiser stops at about 1e-8"),
    "C0_error": Tolerance(1e-3, 0.0, 100.0, "from the optimiser's finite differences"),
    "C0_theory": Tolerance(1e-8, 0.0, 10.0, "a formula"),
    "paper": Tolerance(1e-9, 0.0, 1.0, "printed: it cannot change"),
    "ratio": PresenceOnly("follows from the quantity and paper"),
    "seconds": PresenceOnly(_TIMING),
    "fft_seconds": PresenceOnly(_TIMING),
    "peak_memory_mb": PresenceOnly("depends on the allocator"),
    "transforms": Tolerance(0.0, 0.0, 1.0, "counted: exact"),
    "speedup": FactorTolerance(2.0, 4.0, "a ratio within one machine: a factor 2 between machines"),
    "overhead": FactorTolerance(
        2.0, 4.0, "a ratio within one machine: a factor 2 between machines"
    ),
}
"""What each column of a table may differ by; a column without one is major."""


@dataclass(frozen=True)
class Finding:
    """One compared cell, or what is missing."""

    grade: Grade
    table: str
    row: str
    column: str
    new: str
    committed: str


def compare_folders(new: Path, committed: Path) -> list[Finding]:
    """Compare all CSV tables of two folders; a table in only one of them is missing."""
    names = sorted({path.name for folder in (new, committed) for path in folder.glob("*.csv")})
    if not names:
        return [Finding(Grade.MISSING, "*.csv", "", "", "", "")]
    findings: list[Finding] = []
    for name in names:
        there = [(folder / name).is_file() for folder in (new, committed)]
        if all(there):
            findings += compare_tables(new / name, committed / name)
        else:
            words = ["there" if is_there else "no file" for is_there in there]
            findings.append(Finding(Grade.MISSING, name, "", "", *words))
    return findings


def compare_tables(new: Path, committed: Path) -> list[Finding]:
    """Compare two CSV tables, row by row as their parameters say."""
    rows, expected = _read(new), _read(committed)
    findings: list[Finding] = []
    for key in dict.fromkeys((*expected, *rows)):
        if key not in rows or key not in expected:
            words = ["there" if key in table else "no row" for table in (rows, expected)]
            findings.append(Finding(Grade.MISSING, new.name, key, "", *words))
        else:
            findings += _compare_rows(new.name, key, rows[key], expected[key])
    return findings


def _compare_rows(
    table: str, key: str, row: dict[str, str], expected: dict[str, str]
) -> Iterator[Finding]:
    for column in dict.fromkeys((*expected, *row)):
        if column not in row or column not in expected:
            grade, pair = Grade.MISSING, (row.get(column, ""), expected.get(column, ""))
        else:
            pair = (row[column], expected[column])
            grade = grade_cell(column, *pair)
        yield Finding(grade, table, key, column, *pair)


def grade_cell(column: str, new: str, committed: str) -> Grade:
    """Grade one cell: empty cells and words must be equal, numbers within the tolerance."""
    if column == "status":
        return Grade.OK if new == committed else Grade.MAJOR
    if not new or not committed:
        return Grade.OK if new == committed else Grade.MISSING
    if column not in TOLERANCES:
        return Grade.MAJOR
    return TOLERANCES[column].grade(float(new), float(committed))


def _read(path: Path) -> dict[str, dict[str, str]]:
    """Rows of a table by their parameters."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    found: dict[str, dict[str, str]] = {}
    for row in rows:
        if row.get("threads", "1") != "1":
            row["threads"] = "all"  # of the machine; the committed table's may have had more
        key = ", ".join(f"{name}={row[name]}" for name in PARAMETERS if name in row)
        if key in found:
            raise ValueError(f"{path}: two rows for {key}")
        found[key] = {name: value for name, value in row.items() if name not in PARAMETERS}
    return found


def report(findings: list[Finding]) -> str:
    """Markdown table of all that is not ok, and how many cells have which grade."""
    counts = {grade: sum(f.grade is grade for f in findings) for grade in Grade}
    summary = ", ".join(f"{count} {grade.value}" for grade, count in counts.items())
    shown = [finding for finding in findings if finding.grade is not Grade.OK]
    if not shown:
        return summary
    lines = ["| grade | table | row | column | new | committed | why this tolerance |"]
    lines.append("| --- | --- | --- | --- | --- | --- | --- |")
    for f in shown:
        tolerance = TOLERANCES.get(f.column)
        why = tolerance.reason if tolerance else ""
        cells = (f.grade.value, f.table, f.row, f.column, f.new, f.committed, why)
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join([*lines, "", summary])


def main(arguments: list[str] | None = None) -> int:
    """Compare two folders of tables; return 1 where anything is major or missing."""
    parser = argparse.ArgumentParser(prog="python -m granstudy.compare", description=__doc__)
    parser.add_argument("new", type=Path, help="folder of regenerated tables")
    parser.add_argument("committed", type=Path, help="folder of committed tables")
    folders = parser.parse_args(arguments)
    findings = compare_folders(folders.new, folders.committed)
    print(report(findings))
    return int(any(f.grade in (Grade.MAJOR, Grade.MISSING) for f in findings))


if __name__ == "__main__":
    sys.exit(main())
