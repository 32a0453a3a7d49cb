"""The map of a study: every run beside a truth, its errors, and whether its label is right."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.analysis.columns import computed
from granstudy.analysis.groups import keys
from granstudy.analysis.labels import run_text, telling_apart
from granstudy.analysis.tables.markdown import github_table
from granstudy.analysis.tables.table import write_table
from granstudy.analysis.tables.truth import MEASURES
from granstudy.datasets.run_dataset import CONVENTIONS
from granstudy.trust.flags import Status, Trust, flag_word
from granstudy.trust.rules import EXACTLY, Judged
from granstudy.trust.truth import Errors

CONFIGURATION = ("method", "frame")
"""Parameters that are the map's columns."""

ALWAYS = ("N", "R")
"""Parameters that every row names, beside those that its case sweeps."""

ROW = ("case", "configuration", "variation")
"""Coordinates that say which run a row is."""

HEADER = (*ROW[:2], "", "error of T", "estimate", "error of a2", "estimate", "label")
ALIGNMENT = ("left",) * 3 + ("right",) * 4 + ("left",)
"""Headings of the Markdown table, and the side to which each column goes."""


def breaks_rule(trust: Trust, temperature_error: float, a2_error: float, status: Status) -> bool:
    """Whether a label is wrong, by the first two rules of `granstudy.trust.rules`."""
    run = Judged(trust, status is Status.OK, Errors(temperature_error, a2_error), EXACTLY)
    return bool({"trusted_wrong", "untrusted_right"}.intersection(run.broken))


def label_map(title: str, tables: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """One row for each run of the tables: its case, its configuration, errors, estimates, label.

    Parameters
    ----------
    title : str
    tables : dict of xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`, of experiments with a truth, by experiment.

    Returns
    -------
    xarray.Dataset
        Over ``run``: the coordinates `case`, `configuration` (method, frame) and `variation` (N, R,
        and what else is swept); the columns `granstudy.analysis.tables.truth.MEASURES`, `trust`, `status`,
        and `wrong`, whether the label breaks the rule. The attribute `titles` has a line for each case.
    """
    parts = [_rows(case, table) for case, table in tables.items()]
    joined = xr.concat(parts, "run", combine_attrs="drop")
    measured = ("trust", "largest_temperature_error", "largest_a2_error", "status")
    wrong = [
        breaks_rule(Trust(int(trust)), float(T), float(a2), Status(int(status)))
        for trust, T, a2, status in zip(*(joined[name].values for name in measured), strict=True)
    ]
    joined["wrong"] = computed("wrong", wrong)
    joined.attrs = {
        "title": title,
        "Conventions": CONVENTIONS,
        "swept": " ".join(ROW),
        "titles": "\n".join(table.attrs["title"] for table in tables.values()),
    }
    return joined


def _rows(case: str, table: xr.Dataset) -> xr.Dataset:
    """Rows of one case: its measures, and the parameters that tell its runs apart as text."""
    varying = [name for name in telling_apart(table) if name not in (*CONFIGURATION, *ALWAYS)]
    texts = {
        "configuration": _texts(table, CONFIGURATION),
        "variation": _texts(table, [*ALWAYS, *varying]),
    }
    coordinates = {name: ("run", np.array(values, dtype=object)) for name, values in texts.items()}
    rows = xr.Dataset(
        {
            name: ("run", table[name].values, table[name].attrs)
            for name in (*MEASURES, "trust", "status")
        }
    )
    cases = np.array([case] * table.sizes["run"], dtype=object)
    return rows.assign_coords({"case": ("run", cases)} | coordinates)


def _texts(table: xr.Dataset, names: Sequence[str]) -> list[str]:
    """Parameters of every run, swept or held fixed, as a text."""
    return [run_text(dict(zip(names, key, strict=True))) for key in keys(table, names)]


def rule_line(table: xr.Dataset) -> str:
    """Count the labels that break the rule, in one line."""
    wrong, runs = int(table["wrong"].sum()), table.sizes["run"]
    return (
        f"{wrong} of {runs} labels break the rule: no trusted run with more than 1% error in T or 0.01 in "
        "a2, no untrusted one under 1e-6 in both."
    )


def write_map(table: xr.Dataset, nc: str | Path, csv: str | Path, md: str | Path) -> None:
    """Write a map as NetCDF, CSV and Markdown, each whole or not at all."""
    write_table(table, nc, csv, md, markdown_map)


def markdown_map(table: xr.Dataset) -> str:
    """Title, the rule, and a line for each run."""
    lines = []
    for i in range(table.sizes["run"]):
        row = table.isel(run=i)
        numbers = [f"{float(row[name]):.1e}" for name in MEASURES]
        label = flag_word("trust", row["trust"]) + " (wrong)" * bool(row["wrong"])
        lines.append([*(str(row[name].item()) for name in ROW), *numbers, label])
    rows = github_table(HEADER, lines, ALIGNMENT)
    return "\n".join([f"# {table.attrs['title']}", "", rule_line(table), "", rows]) + "\n"
