"""Coverage: which lines of granstudy the tests run, room by room.

`python benchmarks/covered.py` runs the tests that are not slow under coverage.py, with the processes that
they start, prints the lines that none of them runs, and writes the table of rooms. Arguments go to pytest.
"""

import csv
import json
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path
from typing import Any

import click

REPOSITORY = Path(__file__).parents[1]

TABLE = REPOSITORY / "docs/results/checks/coverage.csv"


def measured(arguments: tuple[str, ...], folder: Path) -> dict[str, dict[str, Any]]:
    """Run the tests; for each file of the package coverage's summary, lines missing and lines excluded."""
    environment = os.environ | {"COVERAGE_FILE": str(folder / "data")}

    def run(*command: str) -> int:
        return subprocess.run(
            [sys.executable, "-m", "coverage", *command],
            cwd=REPOSITORY,
            env=environment,
            check=False,
        ).returncode

    failed = run("run", "-m", "pytest", "-n", "2", *arguments)
    run("combine", "--quiet")
    run("json", "--quiet", "-o", str(folder / "report.json"))
    if failed:
        print("tests failed: what follows counts the lines that they ran all the same")
    return json.loads((folder / "report.json").read_text())["files"]


def spans(lines: list[int]) -> str:
    """Numbers with runs of them joined, e.g. ``3-5 9``."""
    found = list[list[int]]()
    for line in lines:
        if found and line == found[-1][1] + 1:
            found[-1][1] = line
        else:
            found.append([line, line])
    return " ".join(str(a) if a == b else f"{a}-{b}" for a, b in found)


@click.command(context_settings={"ignore_unknown_options": True})
@click.argument("arguments", nargs=-1)
def main(arguments: tuple[str, ...]) -> None:
    """Measure, print what no test runs, and write the table where all tests were asked for."""
    with tempfile.TemporaryDirectory() as folder:
        files = measured(arguments, Path(folder))
    rooms = defaultdict[str, list[int]](lambda: [0, 0, 0])
    for name, file in files.items():
        room = Path(name).parts[1].removesuffix(".py")
        counts = file["summary"]
        numbers = counts["num_statements"], counts["missing_lines"], counts["excluded_lines"]
        for place in (room, "total"):
            rooms[place] = [a + b for a, b in zip(rooms[place], numbers, strict=True)]
        if file["missing_lines"]:
            print(f"{name}: {spans(file['missing_lines'])}")
    rows: list[tuple[object, ...]] = [("room", "statements", "missed", "excluded", "percent")]
    for room, (statements, missed, excluded) in sorted(
        rooms.items(), key=lambda one: (one[0] == "total", one[0])
    ):
        percent = 100.0 * (statements - missed) / max(statements, 1)
        rows.append((room, statements, missed, excluded, f"{percent:.1f}"))
    print(*("  ".join(f"{value!s:>10}" for value in row) for row in rows), sep="\n")
    if not arguments:
        TABLE.parent.mkdir(parents=True, exist_ok=True)
        with TABLE.open("w", newline="", encoding="utf-8") as table:
            csv.writer(table, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main()
