"""The dataset of a simulation on a grid."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.run_dataset import (
    Header,
    Record,
    kept_densities,
    stamped,
    time_axes,
)
from granstudy.trust.exact_law import exact_laws
from granstudy.trust.health import health_variables
from granstudy.velocity.moments import FRAME, MOMENTS, Quantity
from granstudy.velocity.space import VelocitySpace


def evolution_dataset(
    header: Header, grid: VelocitySpace, record: Record, rescaled: bool
) -> xr.Dataset:
    """Dataset of a simulation: moments over ``time``, densities over ``snapshot``, status, trust.

    A rescaled run also has θ, u and τ of its frame over ``time``, and keeps g over the scaled velocities in
    place of f.

    For Maxwell molecules at constant e, laws of T are known exactly, and each gives a variable `.._exact` and
    a variable `.._error` (`granstudy.trust.exact_law.exact_laws`):

    =======================  =================================  ============================
    error                    of                                 against the law of
    =======================  =================================  ============================
    temperature_error        T                                  the run's initial density
    paper_temperature_error  2E/d, as the paper measures        unit density
    =======================  =================================  ============================

    Parameters
    ----------
    header : Header
    grid : VelocitySpace
        Grid of the kept densities.
    record : Record
    rescaled : bool
        Whether the frame is rescaled.
    """
    quantities: dict[str, Quantity] = {**MOMENTS, **(FRAME if rescaled else {})}
    moments = {name: np.array([values[name] for values in record.moments]) for name in quantities}
    data: dict[str, Any] = {
        name: quantity.labelled(moments[name], ("time",)) for name, quantity in quantities.items()
    }
    ds = xr.Dataset(data, coords=time_axes(grid.dim, record.times))
    ds = ds.assign(exact_laws(header.scene, record.times, moments))
    if record.snapshots:
        ds = ds.assign(kept_densities(grid, record.snapshots, rescaled))
    ds = ds.assign(health_variables(record.health, record.reason))
    return stamped(ds, header, record.ending, record.plans)
