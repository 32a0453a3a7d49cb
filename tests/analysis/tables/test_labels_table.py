"""The table of random runs: kinds, counts, quantiles, and runs that break a rule."""

import numpy as np
import pytest

from granstudy.analysis.requests import table_source
from granstudy.analysis.tables.labels import markdown_labels
from granstudy.analysis.tables.planned import planned_table
from granstudy.analysis.tables.table import csv_table
from granstudy.trust.flags import Status, Trust

STUDY = """
title: labels
experiments:
  labels:
    title: random runs
    run: labels
    sweep:
      - {seed: [2, 6, 89]}
    table: {quantity: largest_temperature_error}
"""


def test_every_run_is_a_row_with_its_kind_and_label(made):
    table = made.tables["labels"]
    assert table["seed"].values.tolist() == [2, 6, 89]
    assert (table["status"] == Status.OK).all()
    assert set(table["trust"].values) <= {int(trust) for trust in Trust}
    assert (table["broken"] == "").all()
    runs = list(made.study.runs["labels"].values())
    for i, run in enumerate(runs):
        assert table["method"][i] == run.solver.method
        assert str(table["gas"][i].item()).startswith(f"{run.scene.dim}D")
    estimate, error = table["temperature_error_estimate"], table["largest_temperature_error"]
    known = np.isfinite(table["temperature_ratio"])
    assert (table["temperature_ratio"] == estimate / error.clip(max=0.1))[known].all()


def test_a_run_that_stopped_is_counted_apart_and_its_estimates_are_not_judged(made):
    table = made.tables["labels"]
    assert table["ended"].values.tolist() == [True, True, False]
    assert np.isnan(table["temperature_ratio"][2]) and table["largest_temperature_error"][2] > 1.0
    [line] = [line for line in markdown_labels(table).splitlines() if "**all**" in line]
    # runs; trusted, marginal, untrusted; stopped, failed
    counts = [int(cell) for cell in line.split("|")[4:10]]
    assert counts[0] == sum(counts[1:]) == 3
    assert counts[4:] == [1, 0]


def test_its_plan_has_the_same_columns(made):
    planned = planned_table(table_source(made.study, "labels", []))
    table = made.tables["labels"]
    assert set(planned.data_vars) == set(table.data_vars)
    assert planned.attrs["swept"] == table.attrs["swept"]


def test_runs_that_break_a_rule_are_counted_and_listed(made):
    table = made.tables["labels"].copy(deep=True)
    assert "0 of 3 random runs break a rule." in markdown_labels(table)
    table["broken"][1] = "trusted_wrong underestimated"
    text = markdown_labels(table)
    assert "1 of 3 random runs break a rule." in text
    assert "|      6 | trusted_wrong underestimated |" in text


def test_truths_are_counted_with_those_that_are_known_well(made):
    table = made.tables["labels"].copy(deep=True)
    table["truth"][:] = ["exact law", "radial, N = 48, R = 12, trusted", "dsmc, 10 particles"]
    table["a2_known_to"][2] = 0.3 * table["largest_a2_error"][2] + 1e-5
    lines = [
        [cell.strip() for cell in line.split("|")] for line in markdown_labels(table).splitlines()
    ]
    assert ["", "exact law", "1", "1", ""] in lines
    assert ["", "a finer run", "1", "1", ""] in lines
    assert ["", "particles", "1", "0", ""] in lines


def test_a_run_that_failed_is_counted_apart(made):
    table = made.tables["labels"].copy(deep=True)
    table["status"][2] = Status.FAILED
    text = markdown_labels(table)
    assert "Seeds of runs that failed, a tolerance that their grid cannot hold: 89." in text


def test_the_csv_has_a_line_a_run(made):
    lines = csv_table(made.tables["labels"]).splitlines()
    assert len(lines) == 4
    assert lines[0].startswith("seed,gas,frame,method,")


def test_random_runs_sweep_their_seed_alone(load):
    with pytest.raises(ValueError, match="random runs sweep seed alone"):
        load("seed: [2, 6, 89]", "N: [8]")
    with pytest.raises(ValueError, match="seed=-1: must be an integer of at least 0"):
        load("[2, 6, 89]", "[-1]")


@pytest.mark.parametrize("asked", ["fit: {law: order, x: seed}", "figure: {kind: gallery}"])
def test_random_runs_have_no_fit_and_no_figure(load, asked):
    with pytest.raises(ValueError, match="random runs have a table alone"):
        load("    table:", f"    {asked}\n    table:")
