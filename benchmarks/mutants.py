"""Mutation tests: which small mistakes in the mathematics do the tests not see.

`python benchmarks/mutants.py` changes one thing at a time in a copy of the repository, in plain lines and in
compiled loops alike, and runs the tests that run the changed line. A mutant is killed where a test fails,
where the interpreter dies, or where it takes several times as long as it should. The table has a line for
each mutant; what was written there of survivors is kept.
"""

import csv
import tempfile
from dataclasses import astuple, dataclass
from pathlib import Path

import click
from mutations import Mutation, sample
from shown_tests import REPOSITORY, chosen_tests, copy_repository, importers, look, outcome, preload

TABLE = REPOSITORY / "docs/results/checks/mutants.csv"

ROOMS = ("collision", "quadrature", "velocity", "trust")

BESIDE = ("theory", "states", "evolution/test_conservation.py", "evolution/frames")
"""Tests of other rooms that check these against exact laws."""

TESTS = tuple(f"tests/{name}" for name in (*ROOMS, *BESIDE))


@dataclass(frozen=True)
class Row:
    """A line of the table, in the order of its columns."""

    room: str
    module: str
    line: int
    function: str
    mutation: str
    outcome: str
    explanation: str

    @classmethod
    def of(cls, mutation: Mutation, outcome: str, explanation: str) -> "Row":
        """The line of a mutation."""
        module, function, change = mutation.key
        return cls(
            Path(module).parts[1], module, mutation.line, function, change, outcome, explanation
        )

    @property
    def key(self) -> tuple[str, str, str]:
        """As `Mutation.key`."""
        return self.module, self.function, self.mutation


def read(table: Path) -> list[Row]:
    """Lines of an earlier table, which hold what was written there of survivors."""
    if not table.exists():
        return []
    with table.open(newline="", encoding="utf-8") as file:
        return [
            Row(line.pop("room"), line.pop("module"), int(line.pop("line")), **line)
            for line in csv.DictReader(file)
        ]


def write(rows: list[Row], table: Path) -> None:
    """Write the table, and beside it the totals of each room."""
    table.parent.mkdir(parents=True, exist_ok=True)
    with table.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([Row.__match_args__, *map(astuple, rows)])
    with table.with_name("mutants_totals.csv").open("w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(("room", "mutants", "killed", "survived", "explained"))
        for room in (*sorted({row.room for row in rows}), "all"):
            own = [row for row in rows if room in (row.room, "all")]
            survived = [row for row in own if row.outcome == "survived"]
            told = sum(bool(row.explanation) for row in survived)
            out.writerow((room, len(own), len(own) - len(survived), len(survived), told))


def _is_judged_again(row: Row, again: str) -> bool:
    """Whether a mutant of the table is among those that are asked for."""
    if again == "all":
        return True
    return row.outcome == "survived" and (again == "survivors" or not row.explanation)


@click.command()
@click.option("--count", default=85, show_default=True, help="Mutants a room.")
@click.option("--seed", default=1, show_default=True, help="Another seed chooses other mutants.")
@click.option(
    "--seconds", default=8.0, show_default=True, help="Seconds of tests a mutant is shown."
)
@click.option(
    "--only", default="", help="Mutants with this text in module or line; writes no table."
)
@click.option(
    "--seen", type=click.Path(path_type=Path), help="File that keeps which test runs which line."
)
@click.option(
    "--again",
    type=click.Choice(["all", "survivors", "waiting"]),
    default="all",
    show_default=True,
    help="Mutants of the table to judge again; waiting are survivors without an explanation.",
)
def main(count: int, seed: int, seconds: float, only: str, seen: Path | None, again: str) -> None:
    """Mutate the rooms and say which mutants no test sees."""
    earlier = {row.key: row for row in read(TABLE)}
    chosen = [
        mutation
        for room in ROOMS
        for mutation in sample(
            sorted((REPOSITORY / "granstudy" / room).rglob("*.py")), REPOSITORY, count, seed
        )
        if only in f"{mutation.module} {mutation.change}"
    ]
    preload()
    rows = {one.key: earlier[one.key] for one in chosen if one.key in earlier}
    with tempfile.TemporaryDirectory() as scratch:
        original = copy_repository(Path(scratch) / "original")
        above = importers(original)
        shown = look(original, TESTS, seen and seen.absolute())
        for number, mutation in enumerate(chosen, 1):
            before = earlier.get(mutation.key)
            if before is not None and not _is_judged_again(before, again):
                how = before.outcome
            else:
                tests = chosen_tests(mutation, shown, above, seconds)
                allowed = sum(shown.seconds[test] for test in tests)
                how = outcome(mutation, original, Path(scratch), tests, allowed)
            told = before.explanation if before is not None and how == "survived" else ""
            rows[mutation.key] = Row.of(mutation, how, told)
            print(
                f"{number}/{len(chosen)} {mutation.module}:{mutation.line} {mutation.change}: {how}",
                flush=True,
            )
            if not only:  # at once, so that what a stopped run has judged is kept
                write([rows[one.key] for one in chosen if one.key in rows], TABLE)


if __name__ == "__main__":
    main()
