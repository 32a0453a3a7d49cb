"""One value for each run, and what stands for it in runs that have none."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from granstudy.datasets.parameters import ABSENT
from granstudy.trust.flags import FLAGS, Status


def absent(name: str, dtype: np.dtype) -> Any:
    """The value that stands for a variable in an array over runs where it has none.

    ===================================  ============================================================
    a parameter                          its value in `granstudy.datasets.parameters.ABSENT`
    a flag (`status`, `trust`)           −1, missing
    real numbers                         NaN
    whole numbers                        −1
    text, truth values                   "", False
    ===================================  ============================================================
    """
    if name in ABSENT:
        return ABSENT[name]
    if name in FLAGS:
        return np.int8(Status.MISSING)
    if dtype.kind in "iu":
        return -1
    if dtype.kind == "b":
        return False
    return "" if dtype.kind in "OUT" else np.nan


def column(name: str, values: Sequence[Any]) -> np.ndarray:
    """The values of all runs, None where a run has none.

    Text beside numbers makes text of all. Whole numbers and truth values that are no parameter of granstudy's
    become real numbers where some are absent, so that NaN stands there.
    """
    known = np.array([value for value in values if value is not None])
    if known.size == len(values):
        return known
    if known.dtype.kind in "iub" and name not in ABSENT and name not in FLAGS:
        known = known.astype(np.float64)
    hole = absent(name, known.dtype)
    return np.array([hole if value is None else value for value in values])
