"""When the rates of a run's moments are held against the exact ones."""

import numpy as np

BALANCES = 20
"""Balances in a run, about; each takes transforms on twice the box, with some schemes an evaluation of Q."""


def balance_times(times: np.ndarray) -> np.ndarray:
    """Times at which balances are due in a run with outputs at ``times``; there are about `BALANCES`.

    Errors may grow exponentially: where there are few outputs, they do not tell how their growth went.
    """
    every = max(1, (len(times) - 1) // BALANCES)
    parts = int(np.ceil(BALANCES / max(1, len(times) - 1)))
    inner = np.multiply.outer(np.diff(times), np.arange(1, parts) / parts) + times[:-1, None]
    return np.unique([*times[::every], times[-1], *inner.ravel()])
