"""What breaks the rules of labels and estimates, and what does not."""

import numpy as np
import pytest

from granstudy.trust.flags import Trust
from granstudy.trust.rules import Judged
from granstudy.trust.truth import Errors


def broken(trust, errors, estimates, known=(0.0, 0.0), ended=True, by_particles=False):
    pairs = (Errors(*each) for each in (errors, estimates, known))
    return Judged(trust, ended, *pairs, by_particles).broken


@pytest.mark.parametrize(
    ("trust", "errors", "estimates", "found"),
    [
        (Trust.TRUSTED, (1e-3, 1e-3), (1e-3, 1e-3), []),
        (Trust.TRUSTED, (2e-2, 1e-3), (1e-2, 1e-3), ["trusted_wrong"]),
        (Trust.MARGINAL, (2e-2, 1e-3), (1e-2, 1e-3), []),
        (Trust.TRUSTED, (np.nan, 1e-3), (1e-3, 1e-3), ["trusted_wrong"]),
        (Trust.UNTRUSTED, (1e-7, 1e-7), (1e-1, 1e-1), ["untrusted_right"]),
        (Trust.UNTRUSTED, (1e-7, 2e-6), (1e-1, 1e-5), []),
        (Trust.TRUSTED, (1e-3, 1e-5), (1e-4, 1e-5), ["underestimated"]),
        (Trust.TRUSTED, (1e-3, 1e-5), (1e-3, 1e-2), ["overestimated"]),
        (Trust.TRUSTED, (1e-7, 1e-7), (1e-9, 1e-3), []),
        # an error above 0.1 counts as 0.1
        (Trust.UNTRUSTED, (5.0, 90.0), (0.04, 1.0), []),
        (Trust.UNTRUSTED, (5.0, 90.0), (0.03, 1.0), ["underestimated"]),
    ],
)
def test_rules_of_runs_on_grids(trust, errors, estimates, found):
    assert broken(trust, errors, estimates) == found


def test_an_error_is_known_no_better_than_its_truth():
    errors, small = (1.01e-2, 1.01e-2), (1e-3, 1e-3)
    assert broken(Trust.TRUSTED, errors, small) == ["trusted_wrong", "underestimated"]
    assert broken(Trust.TRUSTED, errors, small, known=(8e-3, 8e-3)) == []
    assert broken(Trust.UNTRUSTED, (5e-7, 5e-7), small, known=(6e-7, 0.0)) == []
    # by so much that the truth cannot be the cause
    assert broken(Trust.TRUSTED, (2e-6, 0.0), (1e-3, 0.0), known=(5e-7, 0.0)) == ["overestimated"]
    assert broken(Trust.TRUSTED, (2e-6, 0.0), (2e-4, 0.0), known=(5e-7, 0.0)) == []


def test_a_run_that_stopped_must_not_be_trusted_and_is_not_judged_further():
    assert broken(Trust.UNTRUSTED, (1e-9, 1e-9), (1.0, 1.0), ended=False) == []
    assert broken(Trust.TRUSTED, (2e-2, 1e-9), (1.0, 1.0), ended=False) == ["trusted_wrong"]


def test_particles_may_be_off_by_five_standard_errors():
    two = (2e-3, 2e-3)
    assert broken(Trust.TRUSTED, (4.9e-3, 0.0), two, by_particles=True) == []
    assert broken(Trust.TRUSTED, (5.1e-3, 0.0), two, by_particles=True) == ["underestimated"]
    # chance brings errors far below any estimate
    assert broken(Trust.TRUSTED, (2e-6, 2e-6), two, by_particles=True) == []


def test_ratios_are_of_errors_that_are_known():
    found = Judged(Trust.TRUSTED, True, Errors(1e-3, 1e-3), Errors(2e-3, 3e-3), Errors(0.0, 9e-4))
    assert found.ratios.temperature == pytest.approx(2.0)
    assert np.isnan(found.ratios.a2)
    # 1.1e-6 by a truth known to 2e-7 may be an error of 9e-7
    small = Judged(
        Trust.TRUSTED, True, Errors(1.1e-6, 1.3e-6), Errors(2e-6, 2.6e-6), Errors(2e-7, 2e-7)
    )
    assert np.isnan(small.ratios.temperature)
    assert small.ratios.a2 == pytest.approx(2.0)
