"""Labels and estimates of random runs against exact laws and finer runs.

``python tests/label_cases.py`` makes as many as one likes; here are few and cheap ones.
"""

import pytest
from label_cases import Outcome, outcome, random_case

from granstudy.trust.flags import Trust
from granstudy.trust.truth import Errors

BY_LAW = [seed for seed in range(60) if random_case(seed).fine is None][:22]
BY_FINER_RUN = [2, 3, 7, 11, 21, 29, 35, 57]


@pytest.mark.parametrize("seed", BY_LAW + BY_FINER_RUN)
def test_no_rule_is_broken(seed):
    found = outcome(random_case(seed))
    assert not found.broken, str(found)


def test_the_runs_are_good_and_bad():
    labels = {outcome(random_case(seed)).trust for seed in BY_LAW[:12]}
    assert labels == set(Trust)


def test_broken_rules_are_found():
    def broken(trust, true, estimated):
        case = random_case(0)
        made = Outcome(case, trust, True, Errors(*true), Errors(*estimated), Errors(0.0, 0.0))
        return made.broken

    assert broken(Trust.TRUSTED, (1e-3, 1e-3), (1e-3, 1e-3)) == []
    assert broken(Trust.TRUSTED, (2e-2, 1e-3), (1e-2, 1e-3)) == ["trusted and wrong"]
    assert broken(Trust.UNTRUSTED, (1e-7, 1e-7), (1e-1, 1e-1)) == ["untrusted and right"]
    assert broken(Trust.TRUSTED, (1e-3, 1e-5), (1e-4, 1e-2)) == [
        "temperature underestimated: 1.0e-04 for 1.0e-03",
        "a2 overestimated: 1.0e-02 for 1.0e-05",
    ]
