"""The front of speed against error: the runs that no other run beats in both."""

import numpy as np
import xarray as xr

TOLERANCE = "fast, rtol"
"""What a run is called whose quadrature a tolerance has chosen."""

ON_GPU = "{}, gpu"
"""What it is called then where a GPU made it."""


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


def families(table: xr.Dataset) -> list[str]:
    """What each run of a table counts as on the front: its method or `TOLERANCE`, and `ON_GPU`."""
    tolerance = table["rtol"].values > 0 if "rtol" in table.coords else np.array(False)
    gpu = table["device"].values == "gpu" if "device" in table.coords else np.array(False)
    columns = (np.broadcast_to(c, table.sizes["run"]) for c in (table["method"], tolerance, gpu))
    names = []
    for method, with_rtol, on_gpu in zip(*columns, strict=True):
        name = TOLERANCE if with_rtol else str(method)
        names.append(ON_GPU.format(name) if on_gpu else name)
    return names
