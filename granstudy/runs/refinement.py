"""Going up a ladder of grids until the answer no longer changes."""

import json
from collections.abc import Callable

import numpy as np
import xarray as xr

from granstudy.runs.computation import Computation, ladder
from granstudy.support.variables import labelled
from granstudy.trust.flags import Status


def refined(computation: Computation, compute: Callable[[Computation], xr.Dataset]) -> xr.Dataset:
    """The first run of a ladder whose T and a2 differ from the run below by less than is asked for.

    Parameters
    ----------
    computation : Computation
        A run with a refinement.
    compute : callable
        Computation without a refinement ↦ its dataset, computed or out of a store.

    Returns
    -------
    xarray.Dataset
        The run that the ladder stopped at, its parameters those of that run, with

        ======================  ================================================================
        `temperature_change`    largest relative change of T from the run below, all output times
        `a2_change`             largest change of a2, likewise
        attribute `refinement`  every run of the ladder that was made, with its changes, as JSON
        ======================  ================================================================

        Where the ladder ends before the answer settles, the status is failed, with the reason.
    """
    refinement = computation.refinement
    assert refinement is not None
    made: list[dict[str, float]] = []
    before: xr.Dataset | None = None
    for rung, value in zip(ladder(computation), refinement.values, strict=True):
        ds = compute(rung)
        change = (np.nan, np.nan) if before is None else changes(before, ds)
        made.append({refinement.over: value, "temperature": change[0], "a2": change[1]})
        if change[0] <= refinement.temperature and change[1] <= refinement.a2:
            return _settled(ds, refinement.describe(), made)
        before = ds
    reason = (
        f"{refinement.over} = {refinement.values[-1]:g}, the last of the ladder: T still changes by "
        f"{change[0]:.1e} and a2 by {change[1]:.1e}; add finer values to refine.{refinement.over}"
    )
    ds = _settled(ds, refinement.describe(), made)
    if ds["status"] == Status.OK:
        ds["status"] = ds["status"].copy(data=np.int8(Status.FAILED))
        ds["status"].attrs["reason"] = reason
    return ds


def changes(coarse: xr.Dataset, fine: xr.Dataset) -> tuple[float, float]:
    """Largest relative change of T and largest change of a2 over all output times."""
    if "time" not in fine["temperature"].dims:
        a, b = coarse, fine
    else:
        a, b = xr.align(coarse[["temperature", "a2"]], fine[["temperature", "a2"]], join="inner")
        if a.sizes["time"] < fine.sizes["time"]:
            return np.inf, np.inf
    T = float(np.max(np.abs(a["temperature"] / b["temperature"] - 1.0)))
    return T, float(np.max(np.abs(a["a2"] - b["a2"])))


def _settled(ds: xr.Dataset, asked: dict[str, object], made: list[dict[str, float]]) -> xr.Dataset:
    """The run with the changes from the run below, and the whole ladder as an attribute."""
    ds = ds.copy()
    for name, long_name in (
        ("temperature", "largest relative change of T from the coarser run"),
        ("a2", "largest change of a2 from the coarser run"),
    ):
        ds[f"{name}_change"] = labelled(np.float64(made[-1][name]), long_name, ())
    rungs = [{k: None if np.isnan(v) else v for k, v in rung.items()} for rung in made]
    ds.attrs["refinement"] = json.dumps({"asked": asked, "made": rungs}, sort_keys=True)
    return ds
