"""The front of speed against error: the runs that no other run beats in both."""

import numpy as np


def on_front(seconds: np.ndarray, error: np.ndarray) -> np.ndarray:
    """Mark the runs that none is as good as in both measures and better in one.

    Parameters
    ----------
    seconds, error : array_like
        Two measures of each run, the smaller the better; a run without a number is not on the front.

    Returns
    -------
    ndarray of bool
    """
    seconds, error = np.asarray(seconds, dtype=float), np.asarray(error, dtype=float)
    as_good = (seconds[:, None] <= seconds) & (error[:, None] <= error)
    better = (seconds[:, None] < seconds) | (error[:, None] < error)
    known = np.isfinite(seconds) & np.isfinite(error)
    return known & ~np.any(as_good & better, axis=0)


def fastest_within(seconds: np.ndarray, error: np.ndarray, largest: float) -> int | None:
    """Index of the fastest run with at most that error, None where there is no such run."""
    seconds = np.where(np.asarray(error, dtype=float) <= largest, seconds, np.nan)
    return None if np.all(np.isnan(seconds)) else int(np.nanargmin(seconds))
