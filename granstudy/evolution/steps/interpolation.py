"""States inside steps, between their ends (docs/method.md §3)."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np


class End(NamedTuple):
    """The end of a step, which is the start of the next: a state and its rate of change."""

    time: float
    state: np.ndarray
    rate: np.ndarray


def hermite(ends: Sequence[End], time: float) -> np.ndarray:
    """The polynomial of least degree with the states and rates of all ends, at a time.

    Three ends give degree 5 and an error O(h⁶), as a step of a scheme of order 5 has (`hermite_error`).
    """
    times = np.array([end.time for end in ends])
    found = np.zeros_like(ends[-1].state)
    for i, end in enumerate(ends):
        others = np.delete(times, i)
        apart = end.time - others
        basis = np.prod((time - others) / apart) ** 2
        slope = 2.0 * np.sum(1.0 / apart)
        from_end = time - end.time
        found += basis * (1.0 - slope * from_end) * end.state + basis * from_end * end.rate
    return found


def hermite_error(ends: Sequence[End], time: float) -> float:
    """Error of `hermite` by three ends for y' = (z/h) y, over z⁶: Π_i ((t − t_i)/h)²/720, h the last step."""
    h = ends[-1].time - ends[-2].time
    return float(np.prod([((time - end.time) / h) ** 2 for end in ends]) / 720)
