"""The front of speed against error."""

import numpy as np

from granstudy.study.benchmark.front import fastest_within, on_front

SECONDS = np.array([1.0, 2.0, 0.5, 4.0, np.nan, 0.5])
ERROR = np.array([1e-2, 1e-3, 1e-1, 1e-3, 1e-9, 1e-1])


def test_a_run_is_on_the_front_unless_another_is_as_good_in_both_and_better_in_one():
    # the fourth is as exact as the second and slower; two equal runs do not beat each other
    assert on_front(SECONDS, ERROR).tolist() == [True, True, True, False, False, True]


def test_the_fastest_run_within_an_error():
    assert fastest_within(SECONDS, ERROR, 1e-2) == 0
    assert fastest_within(SECONDS, ERROR, 1e-3) == 1
    assert fastest_within(SECONDS, ERROR, 1e-4) is None
