"""Make all trials: ``python -m promises`` in the folder ``tests``; about half an hour on two cores."""

import json
import tempfile
import time
from collections import Counter
from pathlib import Path

import click
import pandas as pd

from promises import damage, full_disks, kills, study_files, writers
from promises.trial import finished

TABLE = Path(__file__).parents[2] / "docs/results/checks/promises.csv"

ATTACKS = {
    "kills": (kills, 200),
    "full disks": (full_disks, 100),
    "damaged files": (damage, 300),
    "concurrent writers": (writers, 60),
    "study files": (study_files, 2000),
}
"""Attacks by name, each with the number of its trials."""


def attacked(attack, count, reference, first=0):
    """Outcomes of so many trials with their numbers; each trial has a folder of its own."""
    outcomes = Counter()
    for seed in range(first, first + count):
        with tempfile.TemporaryDirectory() as folder:
            trial = attack.trial(seed, Path(folder), reference)
        outcomes[trial.kept, trial.outcome] += 1
        if not trial.kept:
            click.echo(f"  seed {seed}: {trial.outcome}")
    return outcomes


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
            attack, count = ATTACKS[name]
            began = time.perf_counter()
            outcomes = attacked(attack, max(1, round(part * count)), reference)
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
