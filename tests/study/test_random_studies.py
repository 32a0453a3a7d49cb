"""Random mistakes: a study file is planned whole, or refused in lines of ours, whatever stands in it."""

import os
import warnings

import pytest
from bounded import bounded
from study_mutations import OWN_CODE, mutated

from granstudy.analysis.requests import check_requests
from granstudy.study.jobs import jobs
from granstudy.study.study import load_study

CASES = int(os.environ.get("GRANSTUDY_RANDOM_STUDIES", "300"))
"""Studies that are tried; CI tries the first 300, whose seeds are 0 to 299."""

FIRST = int(os.environ.get("GRANSTUDY_RANDOM_STUDIES_FROM", "0"))
"""Seed of the first."""

PARTS = 10
"""Tests that the studies are shared out to."""


def verdict(text, folder):
    """ "" for a study that is planned whole, else what it is told."""
    path = folder / "random.yaml"
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    with bounded(), warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", "epsilon: is called", FutureWarning)
        try:
            study = load_study(path)
            check_requests(study, path)
        except ValueError as error:
            assert type(error) is ValueError, f"{type(error)} is none of ours"
            return str(error)
        jobs([[member] for member in study.members], 2)
    return ""


@pytest.mark.fault("C2")
@pytest.mark.parametrize("part", range(PARTS))
def test_a_random_study_is_planned_or_refused(part, tmp_path):
    (tmp_path / "my_gas.py").write_text(OWN_CODE)
    (tmp_path / "nodes.txt").write_text("1 0 0\n-1 0 0\n")
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
