"""The dataset of a simulation by particles: means over batches with their standard errors."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.run_dataset import kept_densities, stamped
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.errors import unknown_name
from granstudy.trust.exact_law import add_exact_law
from granstudy.trust.flags import Status
from granstudy.trust.health import health_variables
from granstudy.velocity.moments import COMPONENTS, DIMENSIONS, LONG_NAMES
from granstudy.velocity.space import VelocitySpace

BY_BATCH = ("temperature", "a2")
"""Moments of which a simulation by particles keeps every batch's value."""


def particle_dataset(
    scene: Scene,
    solver: Solver,
    grid: VelocitySpace,
    times: np.ndarray,
    by_batch: dict[str, np.ndarray],
    snapshots: dict[float, np.ndarray],
    status: Status,
    reason: str,
    warnings: list[str],
    health_outputs: list[dict[str, float]],
) -> xr.Dataset:
    """Dataset of a simulation by particles: as `evolution_dataset`, with standard errors.

    ``by_batch`` holds every moment of every batch, shape (batches, times, ...). Each becomes its mean over
    batches and a `<name>_standard_error`; of `BY_BATCH` the batches' own values are kept, too, as
    `<name>_by_batch`. The exact temperature law and `temperature_error`, the distance from it, are those of
    `evolution_dataset`.
    """
    components = list(COMPONENTS[: grid.dim])
    long_names = LONG_NAMES | {"collisions": "collisions that a particle has had"}
    data: dict[str, Any] = {}
    for name, values in by_batch.items():
        dims = ("time", *DIMENSIONS.get(name, ()))
        attributes = {"long_name": long_names[name], "units": "1"}
        data[name] = (dims, values.mean(axis=0), attributes)
        attributes = {"long_name": f"standard error of {name} over batches", "units": "1"}
        data[f"{name}_standard_error"] = (dims, standard_error(values), attributes)
        if name in BY_BATCH:
            attributes = {"long_name": f"{long_names[name]}, of each batch", "units": "1"}
            data[f"{name}_by_batch"] = (("time", "batch"), values.T, attributes)
    ds = xr.Dataset(
        data,
        coords={
            "time": ("time", times, {"long_name": "time t", "units": "1"}),
            "component": components,
            "component_": components,
            "batch": np.arange(solver.batches),
        },
    )
    add_exact_law(ds, scene)
    if snapshots:
        ds = ds.assign(kept_densities(grid, snapshots, rescaled=False))
    ds = ds.assign(health_variables(health_outputs, reason))
    return stamped(ds, scene, solver, None, status, reason, warnings, "particles", ())


def standard_error(by_batch: np.ndarray) -> np.ndarray:
    """Standard error of the mean over the first axis, from independent batches."""
    return np.asarray(np.std(by_batch, axis=0, ddof=1) / np.sqrt(len(by_batch)))


def time_average(ds: xr.Dataset, name: str, start: float) -> tuple[float, float]:
    """Mean of a moment over the recorded times from ``start`` on, and its standard error.

    Each batch is averaged first and the error taken over batches, as one batch's values at several times
    are not independent.

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
