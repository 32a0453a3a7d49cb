"""Random mistakes: a study file is planned whole, or refused in lines of ours, whatever stands in it."""

import os

import pytest
from study_mutations import mutated, verdict

CASES = int(os.environ.get("GRANSTUDY_RANDOM_STUDIES", "300"))
"""Studies that are tried; CI tries the first 300, whose seeds are 0 to 299."""

FIRST = int(os.environ.get("GRANSTUDY_RANDOM_STUDIES_FROM", "0"))
"""Seed of the first."""

PARTS = 10
"""Tests that the studies are shared out to."""


@pytest.mark.fault("C2")
@pytest.mark.parametrize("part", range(PARTS))
def test_a_random_study_is_planned_or_refused(part, tmp_path):
    refused = 0
    for seed in range(FIRST + part, FIRST + CASES, PARTS):
        text = mutated(seed)
        try:
            said = verdict(text, tmp_path)
            lines = said.splitlines()
            assert all(line.startswith(str(tmp_path / "random.yaml")) for line in lines), said
            assert all(len(line) < 1000 for line in lines), said
        except BaseException as error:
            error.add_note(f"seed {seed}:\n{text}")
            raise
        refused += bool(said)
    tried = len(range(FIRST + part, FIRST + CASES, PARTS))
    assert 0 < refused and (refused < tried or tried < 20)
