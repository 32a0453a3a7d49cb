"""Compare regenerated tables with committed ones: ok, minor, major or missing.

``python -m granstudy.analysis.compare NEW COMMITTED`` (folders of CSV tables) prints a report and exits with
1 if anything is major or missing.
"""

import sys
from enum import IntEnum
from pathlib import Path

import numpy as np
import pandas as pd
from pandas.api.types import is_bool_dtype, is_numeric_dtype

from granstudy.analysis.columns import Tolerance, tolerance
from granstudy.datasets.parameters import PARAMETERS

KEYS = (*PARAMETERS, "state", "dim", "threads", "case", "configuration", "variation")
"""Columns that say which run a row is."""


class Grade(IntEnum):
    """How far a number is from the committed one."""

    OK = 0
    MINOR = 1
    MAJOR = 2
    MISSING = 3


MAJOR_FACTOR = 100.0
"""A difference of more than so many tolerances is major."""


def grade(new: float, committed: float, allowed: Tolerance) -> Grade:
    """Grade one number."""
    if allowed.relative is None:
        return Grade.OK
    if np.isnan(new) or np.isnan(committed):
        return Grade.OK if np.isnan(new) and np.isnan(committed) else Grade.MAJOR
    largest = allowed.relative * abs(committed) + allowed.absolute
    difference = abs(new - committed)
    if difference <= largest:
        return Grade.OK
    return Grade.MINOR if difference <= MAJOR_FACTOR * largest else Grade.MAJOR


def compare_tables(new: pd.DataFrame, committed: pd.DataFrame) -> dict[str, tuple[Grade, str]]:
    """Worst grade of every column, and the finding in words."""
    keys = [key for key in KEYS if key in committed.columns]
    absent = [column for column in committed.columns if column not in new.columns]
    if absent:
        return dict.fromkeys(absent, (Grade.MISSING, "no such column"))
    both = committed.astype(dict.fromkeys(keys, str)).merge(
        new.astype(dict.fromkeys(keys, str)),
        on=keys,
        how="outer",
        suffixes=("_committed", "_new"),
        indicator=True,
    )
    found: dict[str, tuple[Grade, str]] = {}
    lost = both[both["_merge"] != "both"]
    if len(lost):
        rows = lost[keys].to_dict("records")
        found["rows"] = (Grade.MISSING, f"in one table only: {rows}")
    both = both[both["_merge"] == "both"]
    for column in committed.columns:
        if column not in keys:
            found[column] = _grade_column(both, column)
    return found


def _grade_column(both: pd.DataFrame, column: str) -> tuple[Grade, str]:
    old, new = both[f"{column}_committed"], both[f"{column}_new"]
    # Beside seconds, the ratio to the printed number is one of seconds.
    timed = column == "ratio" and "seconds_new" in both.columns
    allowed = tolerance("seconds" if timed else column)
    if allowed.relative is None:
        measured = pd.to_numeric(new, errors="coerce")
        lost = int((measured.isna() & ~pd.to_numeric(old, errors="coerce").isna()).sum())
        if lost:
            return Grade.MISSING, f"{lost} numbers are not there"
        return Grade.OK, f"present; not compared: {allowed.reason}"
    if not all(is_numeric_dtype(c) and not is_bool_dtype(c) for c in (old, new)):
        differ = int((old.fillna("").astype(str) != new.fillna("").astype(str)).sum())
        return (Grade.MAJOR, f"{differ} texts differ") if differ else (Grade.OK, "same text")
    grades = [grade(float(a), float(b), allowed) for a, b in zip(new, old, strict=True)]
    difference = float(np.nanmax(np.abs(new - old).to_numpy(), initial=0.0))
    return max(grades, default=Grade.OK), (
        f"largest difference {difference:.2g}; allowed {allowed.relative:g} relative + "
        f"{allowed.absolute:g}: {allowed.reason}"
    )


def compare_folders(new: Path, committed: Path) -> list[tuple[str, str, Grade, str]]:
    """Compare every committed CSV with the regenerated one; rows of table, column, grade, finding."""
    report = []
    names = sorted({path.name for folder in (new, committed) for path in folder.glob("*.csv")})
    if not names:
        return [(str(committed), "", Grade.MISSING, "no tables there")]
    for name in names:
        files = [folder / name for folder in (new, committed)]
        if not all(file.is_file() for file in files):
            where = next(file for file in files if not file.is_file())
            report.append((name, "", Grade.MISSING, f"{where} is not there"))
            continue
        tables = [pd.read_csv(file) for file in files]
        for column, (worst, text) in compare_tables(*tables).items():
            report.append((name, column, worst, text))
    return report


def main(arguments: list[str]) -> int:
    """Print the report; 1 if anything is major or missing."""
    if len(arguments) != 2:
        print("usage: python -m granstudy.analysis.compare NEW COMMITTED (folders of CSV tables)")
        return 2
    report = compare_folders(Path(arguments[0]), Path(arguments[1]))
    for table, column, worst, text in report:
        print(f"{worst.name.lower():8}{table:16}{column:26}{text}")
    return int(any(worst >= Grade.MAJOR for *_, worst, _ in report))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
