"""Flag variables: how a run ended (status), and how far its numbers can be trusted (trust)."""

from enum import IntEnum
from typing import Any


class Trust(IntEnum):
    """How far a run's temperature and kurtosis can be trusted; see `SIGNS`."""

    UNTRUSTED = 0
    MARGINAL = 1
    TRUSTED = 2


class Status(IntEnum):
    """How a run ended; MISSING stands in arrays over parameters where there is no run."""

    MISSING = -1
    OK = 0
    FAILED = 1
    DIVERGED = 2


FLAGS: dict[str, type[IntEnum]] = {"status": Status, "trust": Trust}
"""What the numbers of a flag variable mean."""


def flag_word(name: str, value: Any) -> str:
    """What a flag says, ``ok`` or ``trusted``."""
    return FLAGS[name](int(value)).name.lower()
