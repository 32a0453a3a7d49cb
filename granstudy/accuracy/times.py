"""Times of a run to an accuracy: it chooses its steps."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from granstudy.evolution.times import TimeSettings

STAND_IN = 1e-3
"""Tolerance of steps that stands for the run's own."""

CHOSEN = ("dt", "time_rtol", "frame", "scheme", "conserve")
"""Settings of time that the run chooses."""


def accurate_times(
    t_final: float,
    times: Sequence[float] | np.ndarray | None = None,
    save_every: int | None = None,
    **chosen: Any,
) -> TimeSettings:
    """The times of a run to an accuracy, checked.

    Raises
    ------
    ValueError
        For a setting that the run chooses itself, and for densities to be kept, whose grid would change.
    """
    for name, value in chosen.items():
        if name not in CHOSEN:
            raise TypeError(f"unexpected setting of time {name!r}")
        if value is not None and value != () and not (name == "frame" and value == "fixed"):
            raise ValueError(
                f"{name}={value!r}: not beside accuracy, which chooses it; leave one of them out"
            )
    if save_every is not None:
        raise ValueError(
            f"save_every={save_every!r}: not beside accuracy, as the grid changes on the way; give a solver"
        )
    return TimeSettings(t_final, time_rtol=STAND_IN, times=times)
