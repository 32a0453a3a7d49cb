"""The rule that says which labels of a map are wrong."""

import numpy as np
import pytest

from granstudy.analysis.tables.map import breaks_rule
from granstudy.trust.flags import Status, Trust


@pytest.mark.parametrize(
    ("trust", "T", "a2", "status", "wrong"),
    [
        (Trust.TRUSTED, 9e-3, 9e-3, Status.OK, False),
        (Trust.TRUSTED, 2e-2, 0.0, Status.OK, True),
        (Trust.TRUSTED, 0.0, 2e-2, Status.OK, True),
        (Trust.TRUSTED, np.nan, 0.0, Status.OK, True),
        (Trust.MARGINAL, 1.0, 1.0, Status.OK, False),
        (Trust.UNTRUSTED, 1e-7, 1e-7, Status.OK, True),
        (Trust.UNTRUSTED, 1e-7, 1e-5, Status.OK, False),
        (Trust.UNTRUSTED, 1e-7, 1e-7, Status.DIVERGED, False),
    ],
)
def test_the_rule_of_labels(trust, T, a2, status, wrong):
    assert breaks_rule(trust, T, a2, status) is wrong
