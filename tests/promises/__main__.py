"""Make all trials: ``python -m promises`` in the folder ``tests``; about half an hour on two cores."""

import json
import tempfile
import time
from collections import Counter
from pathlib import Path

import click
import pandas as pd

from promises import arguments, damage, full_disks, kills, study_files, writers
from promises.trial import finished

TABLE = Path(__file__).parents[2] / "docs/results/checks/promises.csv"


def by_seed(trial):
    """Trials that differ in their seed alone, each in a folder of its own."""

    def trials(count, reference):
        for seed in range(count):
            with tempfile.TemporaryDirectory() as folder:
                yield trial(seed, Path(folder), reference)

    return trials


def calls(names):
    """Random calls of granstudy."""
    return lambda count, reference: arguments.trials(names, count)


ATTACKS = {
    "kills": (by_seed(kills.trial), 200),
    "full disks": (by_seed(full_disks.trial), 100),
    "damaged files": (by_seed(damage.trial), 300),
    "concurrent writers": (by_seed(writers.trial), 60),
    "study files": (by_seed(study_files.trial), 2000),
    "arguments": (calls(arguments.ARGUMENTS), 2000),
    "densities and laws": (calls(arguments.OWN_FUNCTIONS), 500),
}
"""Attacks by name: their trials, given how many and the folder of an undisturbed study; and how many."""


@click.command()
@click.argument("names", nargs=-1)
@click.option("--part", default=1.0, show_default=True, help="Part of the trials that are made.")
def main(names, part):
    """Make the trials of the attacks NAMES, of all by default, and write their table."""
    unknown = set(names) - set(ATTACKS)
    if unknown:
        raise click.ClickException(f"{unknown}: must be out of {list(ATTACKS)}")
    known = pd.read_csv(TABLE).set_index("attack") if TABLE.is_file() else pd.DataFrame()
    rows = known.to_dict("index")
    with tempfile.TemporaryDirectory() as folder:
        reference = finished(Path(folder))
        for name in names or ATTACKS:
            trials, count = ATTACKS[name]
            began, outcomes = time.perf_counter(), Counter()
            for number, trial in enumerate(trials(max(1, round(part * count)), reference)):
                outcomes[trial.kept, trial.outcome] += 1
                if not trial.kept:
                    click.echo(f"  trial {number}: {trial.outcome}")
            kept = {text: n for (good, text), n in sorted(outcomes.items()) if good}
            broken = {text: n for (good, text), n in sorted(outcomes.items()) if not good}
            rows[name] = {
                "tried": sum(outcomes.values()),
                "kept": sum(kept.values()),
                "outcomes": json.dumps(kept),
                "broken": json.dumps(broken),
                "seconds": round(time.perf_counter() - began),
            }
            click.echo(f"{name}: {rows[name]}")
    TABLE.parent.mkdir(parents=True, exist_ok=True)
    pd.DataFrame.from_dict(rows, orient="index").rename_axis("attack").to_csv(TABLE)


if __name__ == "__main__":
    main()
