"""Random arguments are taken, or refused in one error that names one of them, before any work."""

import os

import pytest
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from random_arguments import CALLS

CASES = int(os.environ.get("GRANSTUDY_RANDOM_ARGUMENTS", "25"))
"""Calls of each kind that are tried; CI tries the first 25."""

SEED = int(os.environ.get("GRANSTUDY_RANDOM_ARGUMENTS_SEED", "1"))
"""Seed of the calls."""


@pytest.mark.fault("B1", "C3", "C7")
@pytest.mark.parametrize("name", CALLS)
def test_a_random_call_is_taken_or_refused(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = []

    @seed(SEED)
    @settings(
        max_examples=CASES,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(st.data())
    def tried(data):
        words = CALLS[name].drawn(data.draw)
        try:
            said.append(CALLS[name].verdict(words))
        except BaseException as error:
            error.add_note(f"{name}: {words}")
            raise

    tried()
    assert any(said), "nothing was refused"
    assert not all(said), "nothing was taken"
