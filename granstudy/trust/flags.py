"""Flag variables: how a run ended (`status`), and how far its numbers can be trusted (`trust`)."""

from enum import IntEnum
from typing import Any

import numpy as np

from granstudy.support.variables import Variable


class Trust(IntEnum):
    """How far a run's temperature and kurtosis can be trusted (`granstudy.trust.health.SIGNS`)."""

    UNTRUSTED = 0
    MARGINAL = 1
    TRUSTED = 2


class Status(IntEnum):
    """How a run ended. MISSING stands in arrays over parameters, where there is no run.

    STOPPED is a run that its user allowed too little time for the accuracy asked.
    """

    MISSING = -1
    OK = 0
    FAILED = 1
    DIVERGED = 2
    STOPPED = 3


FLAGS: dict[str, type[IntEnum]] = {"status": Status, "trust": Trust}
"""Flag variables of a dataset, and the meaning of their numbers."""


def flag_word(name: str, value: Any) -> str:
    """The word for the value of the flag variable ``name``: ``ok``, ``trusted``."""
    return FLAGS[name](int(value)).name.lower()


def flag_variable(flag: IntEnum, long_name: str, **attributes: str) -> Variable:
    """A flag as a variable with all numbers that it can have and their words (CF conventions)."""
    meanings = type(flag)
    described = {
        "long_name": long_name,
        "flag_values": np.array([one.value for one in meanings], dtype=np.int8),
        "flag_meanings": " ".join(one.name.lower() for one in meanings),
    }
    return (), np.int8(flag), described | attributes
