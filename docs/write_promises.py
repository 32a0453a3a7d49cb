"""Write the page of promises: ``python docs/write_promises.py`` writes `promises.md`.

The figures are those of the tables in `results/checks` and `results/labels`, which other commands write, and
of `tests/faults.toml`. A test says when the page is due.
"""

import ast
import json
import tomllib
from pathlib import Path

import pandas as pd

from granstudy.support.files import write_text

HERE = Path(__file__).parent

PAGE = HERE / "promises.md"

CHECKS = HERE / "results" / "checks"

LABELS = HERE / "results" / "labels" / "tables" / "labels.csv"

TESTS = HERE.parent / "tests"

HEAD = """# Promises

What granstudy promises, how each promise is tested, and what came out when the tests were last made.
The page is written by `python docs/write_promises.py` from committed tables. Each section names the
command that makes its table.
"""

ATTACKS = {
    "kills": (
        "A run that was killed leaves no damaged file. The next command ends with the same bytes.",
        "a worker killed at its end: all its runs deleted; after Ctrl-C 16 of 28 studies stuck",
    ),
    "full disks": (
        "A full disk is an error. With room again the study ends with the same bytes.",
        "115 of 115",
    ),
    "damaged files": (
        "A damaged, exchanged or lost run is never taken for a result, and is computed anew.",
        "28 of 400 flipped bits: the job failed for ever; another run's file: taken",
    ),
    "concurrent writers": (
        "Processes at one study compute each run once, and all get the same bytes.",
        "not tried",
    ),
    "study files": (
        "A study file is planned whole, or refused by lines with field, value and what is allowed.",
        "45 of 58 planted mistakes were found after all runs only",
    ),
    "arguments": (
        "Arguments in Python are taken, or refused by one error that names one of them.",
        "about 0.8 % raised another error",
    ),
    "densities and laws": (
        "A density or law that fails, or gives nonsense, is one error that names it.",
        "about 0.8 % raised another error",
    ),
}
"""What each attack tries to break, and what came of such trials before granstudy withstood them."""

SYMBOLS = {"temperature": "T", "a2": "a2"}
"""Quantities with errors, by the start of their columns' names."""


def page() -> str:
    """The whole page."""
    return "\n".join([HEAD, _attacks(), _labels(), _coverage(), _mutants(), _faults()])


def _attacks() -> str:
    table = pd.read_csv(CHECKS / "promises.csv").set_index("attack")
    lines = [
        "## Attacks\n",
        "`python -m promises` in the folder `tests` makes all trials, in about half an hour. `pytest` makes",
        "a few of each.\n",
        "| attack | promise | tried | kept | what happened | before |",
        "| --- | --- | ---: | ---: | --- | --- |",
    ]
    for name, (promise, before) in ATTACKS.items():
        row = table.loc[name]
        told = json.loads(row["outcomes"]) | json.loads(row["broken"])
        happened = "; ".join(f"{text}: {count}" for text, count in told.items())
        lines.append(
            f"| {name} | {promise} | {row['tried']} | {row['kept']} | {happened} | {before} |"
        )
    return "\n".join([*lines, ""])


def _labels() -> str:
    runs = pd.read_csv(LABELS, keep_default_na=False, na_values=[""])
    broken = runs["broken"].notna() & (runs["broken"] != "")
    ended = runs["status"].value_counts()
    labels = runs.loc[runs["status"] == "ok", "trust"].value_counts()
    counts = [
        len(runs),
        *(labels.get(name, 0) for name in ("trusted", "marginal", "untrusted")),
        len(runs) - ended.get("ok", 0),
        broken.sum(),
    ]
    lines = [
        "## Labels\n",
        "No trusted run is off by more than 1 % in T or 0.01 in a2. No untrusted run is right to 1e-6. Where",
        "an error is above 1e-6, its estimate lies between a third of it and a hundred times it.",
        "`granstudy run studies/labels.yaml` draws gases, grids and methods at random, and holds each run",
        "against an exact law, a finer run or particles ([table](results/labels/tables/labels.md)).\n",
        "| runs | trusted | marginal | untrusted | failed | broken rules |",
        "| ---: | ---: | ---: | ---: | ---: | ---: |",
        f"| {' | '.join(map(str, counts))} |\n",
        "| estimate over error, where the error is above 1e-6 | runs | least | median | largest |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for name, symbol in SYMBOLS.items():
        known = runs[(runs[f"largest_{name}_error"] > 1e-6) & runs[f"{name}_ratio"].notna()]
        ratio = known[f"{name}_ratio"].astype(float)
        lines.append(
            f"| {symbol} | {len(ratio)} | {ratio.min():.2g} | {ratio.median():.2g} | {ratio.max():.2g} |"
        )
    return "\n".join([*lines, ""])


def _mutants() -> str:
    mutants = pd.read_csv(CHECKS / "mutants_totals.csv").set_index("room")
    every = mutants.loc["all"]
    open_ones = every["survived"] - every["explained"]
    but = f", but for {open_ones} that wait for a test" if open_ones else ""
    lines = [
        "## Mutants\n",
        f"`python benchmarks/mutants.py` put {every['mutants']} small mistakes into the mathematics, one at",
        "a time, and showed each mutant up to eight seconds of the tests that run its line. Survivors are",
        f"explained in [the table](results/checks/mutants.csv){but}.\n",
        "| room | mutants | killed | survived | explained |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for room, row in mutants.iterrows():
        lines.append(f"| {room} | {' | '.join(str(n) for n in row)} |")
    return "\n".join([*lines, ""])


def _coverage() -> str:
    rooms = pd.read_csv(CHECKS / "coverage.csv").set_index("room")
    total = rooms.loc["total"]
    lines = [
        "## Coverage\n",
        f"`python benchmarks/covered.py` runs the tests that are not slow. They run {total['percent']} % of",
        f"the {int(total['statements'])} statements of granstudy. Excluded are bodies that numba compiles,",
        "where no tracer sees them.\n",
        "| room | statements | missed | excluded | % |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for room, row in rooms.iterrows():
        counts = [int(row[name]) for name in ("statements", "missed", "excluded")]
        lines.append(f"| {room} | {' | '.join(map(str, counts))} | {row['percent']} |")
    return "\n".join([*lines, ""])


def _faults() -> str:
    tests = marked()
    lines = ["## Faults that were found once\n", "Each has tests that keep it from coming back.\n"]
    lines += ["| | what holds now | tests |", "| --- | --- | ---: |"]
    lines += [f"| {name} | {said} | {len(tests[name])} |" for name, said in faults().items()]
    return "\n".join([*lines, ""])


def faults() -> dict[str, str]:
    """Sentence of each fault by its name."""
    content = tomllib.loads((TESTS / "faults.toml").read_text(encoding="utf-8"))
    return {name: said for table in content.values() for name, said in table.items()}


def marked() -> dict[str, list[str]]:
    """Functions that are marked as tests of each fault, by its name."""
    found: dict[str, list[str]] = {}
    for path in sorted(TESTS.rglob("test_*.py")):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            for decorator in getattr(node, "decorator_list", ()):
                if ast.unparse(decorator).startswith("pytest.mark.fault("):
                    for name in map(ast.literal_eval, decorator.args):
                        found.setdefault(name, []).append(f"{path.relative_to(TESTS)}::{node.name}")
    return found


if __name__ == "__main__":
    write_text(PAGE, page())
