"""The committed map of hard cases: every label is right, and every case is there."""

from pathlib import Path

import pandas as pd
import pytest

from granstudy.analysis.tables.map import breaks_rule
from granstudy.study.study import load_study
from granstudy.trust.flags import Status, Trust

REPOSITORY = Path(__file__).parents[3]
MAP = pd.read_csv(REPOSITORY / "docs/results/hard/tables/map.csv")


@pytest.mark.parametrize("row", MAP.to_dict("records"), ids=lambda row: row["case"])
def test_no_label_breaks_the_rule(row):
    trust, status = Trust[row["trust"].upper()], Status[row["status"].upper()]
    errors = row["largest_temperature_error"], row["largest_a2_error"]
    assert not breaks_rule(trust, *errors, status)
    assert not row["wrong"]


def test_every_case_has_its_runs_and_one_to_trust_beside_the_fixed_grid():
    study = load_study(REPOSITORY / "studies/hard.yaml")
    for name, runs in study.runs.items():
        rows = MAP[MAP["case"] == name]
        assert len(rows) == sum(not run.is_reference for run in runs.values())
        assert rows["configuration"].iloc[0] == "fast, fixed"
    assert set(MAP["case"]) == set(study.runs)
    # somewhere each label is given
    assert set(MAP["trust"]) == {trust.name.lower() for trust in Trust}


def test_estimates_are_not_far_under_the_errors():
    ended = MAP[MAP["status"] == "ok"]
    known = ended[ended["case"] != "viscoelastic"]  # whose truth has standard errors of 1e-3
    for error, estimate, floor in (
        ("largest_temperature_error", "temperature_error_estimate", 1e-6),
        ("largest_a2_error", "a2_error_estimate", 1e-5),
    ):
        trusted = known[known["trust"] != "untrusted"]
        assert (trusted[error] < 3 * trusted[estimate] + floor).all()
