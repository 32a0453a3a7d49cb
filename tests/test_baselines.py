"""Moments and work of small runs are those that are committed (`baselines` says how to change them)."""

import pytest
from baselines import CASES, MOMENT_TOLERANCE, MOMENTS, USUAL, WORK_TOLERANCE, committed, measured


@pytest.mark.parametrize("name", CASES)
def test_moments_and_work_are_those_that_are_committed(name):
    expected, found = committed()[name], measured(CASES[name])
    moments = MOMENT_TOLERANCE.get(name, USUAL)
    for quantity, value in expected.items():
        if quantity == "transforms":
            assert found[quantity] == value, f"{name}: {quantity}"
            continue
        if quantity in MOMENTS:
            allowed = {"rel": moments, "abs": moments}
        else:
            allowed = {"rel": WORK_TOLERANCE, "abs": 2}
        assert found[quantity] == pytest.approx(value, **allowed), f"{name}: {quantity}"
    assert set(found) == set(expected)


def test_every_case_has_a_baseline():
    assert set(committed()) == set(CASES)
