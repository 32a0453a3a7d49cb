"""The dataset of a simulation by particles: means over batches, with standard errors."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.run_dataset import (
    Ending,
    Header,
    kept_densities,
    stamped,
    time_axes,
)
from granstudy.support.errors import unknown_name
from granstudy.support.variables import labelled
from granstudy.trust.exact_law import exact_laws
from granstudy.trust.health import health_variables
from granstudy.velocity.moments import MOMENTS, Quantity
from granstudy.velocity.space import VelocitySpace

BY_BATCH = ("temperature", "a2")
"""Moments whose values in every batch are kept."""

COUNTS = {"collisions": Quantity("collisions that a particle has had")}
"""Quantities of particles beside the moments."""


def particle_dataset(
    header: Header,
    grid: VelocitySpace,
    times: np.ndarray,
    by_batch: Mapping[str, np.ndarray],
    snapshots: Mapping[float, np.ndarray],
    health: Sequence[dict[str, float]],
    ending: Ending,
) -> xr.Dataset:
    """Dataset of a simulation by particles: the variables of a run on a grid, with standard errors.

    Parameters
    ----------
    header : Header
    grid : VelocitySpace
        Cells that the kept densities are counted in.
    times : ndarray, shape (times,)
    by_batch : mapping of ndarray, shape (batches, times, ...)
        Every moment in every batch. A moment becomes its mean over batches, and `<name>_standard_error`.
        Moments of `BY_BATCH` are also kept batch by batch, as `<name>_by_batch`.
    snapshots : mapping of ndarray
        Kept densities, by time.
    health : sequence of dict
        Signs of health at each time, by the names of `granstudy.trust.health.SIGNS`.
    ending : Ending

    See Also
    --------
    granstudy.evolution.dataset.evolution_dataset : explains the variables on exact laws.
    """
    quantities = {**MOMENTS, **COUNTS}
    data: dict[str, Any] = {}
    for name, values in by_batch.items():
        quantity = quantities[name]
        dims = ("time", *quantity.dimensions)
        data[name] = quantity.labelled(values.mean(axis=0), ("time",))
        data[f"{name}_standard_error"] = labelled(
            standard_error(values), f"standard error of {name} over batches", dims
        )
        if name in BY_BATCH:
            data[f"{name}_by_batch"] = labelled(
                values.T, f"{quantity.long_name}, of each batch", ("time", "batch")
            )
    batches = next(iter(by_batch.values())).shape[0]
    axes = time_axes(grid.dim, times) | {"batch": np.arange(batches)}
    ds = xr.Dataset(data, coords=axes)
    ds = ds.assign(exact_laws(header.scene, times, {name: data[name][1] for name in by_batch}))
    if snapshots:
        ds = ds.assign(kept_densities(grid, snapshots, rescaled=False))
    ds = ds.assign(health_variables(health, ending.reason))
    return stamped(ds, header, ending)


def standard_error(by_batch: np.ndarray) -> np.ndarray:
    """Standard error of the mean over the first axis, from independent batches."""
    return np.asarray(np.std(by_batch, axis=0, ddof=1) / np.sqrt(len(by_batch)))


def time_average(ds: xr.Dataset, name: str, start: float) -> tuple[float, float]:
    """Mean of a moment over the recorded times from ``start`` on, and its standard error.

    Each batch is averaged over time first. The error is then taken over batches, as values of one batch at
    several times are not independent.

    Parameters
    ----------
    ds : xarray.Dataset
        Dataset of `granstudy.particles.simulate_particles`, or of `granstudy.simulate` by method `dsmc`.
    name : str
        ``temperature`` or ``a2``.
    start : float
        Time from which on the moment is averaged.

    Raises
    ------
    ValueError
        If the dataset holds no values of ``name`` by batch, or no time from ``start`` on.
    """
    by_batch = {str(n).removesuffix("_by_batch") for n in ds if str(n).endswith("_by_batch")}
    if name not in by_batch:
        raise unknown_name("moment by batch", name, sorted(by_batch))
    late = ds[f"{name}_by_batch"].sel(time=slice(start, None))
    if late.sizes["time"] == 0:
        raise ValueError(f"start={start!r}: the dataset ends at t = {float(ds['time'][-1]):g}")
    means = late.mean("time").values
    return float(means.mean()), float(standard_error(means))
