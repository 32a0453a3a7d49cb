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
from granstudy.support.variables import labelled
from granstudy.trust.exact_law import add_exact_law
from granstudy.trust.health import health_variables
from granstudy.velocity.moments import DIMENSIONS, FRAME_LONG_NAMES, LONG_NAMES
from granstudy.velocity.space import VelocitySpace


def evolution_dataset(
    header: Header, grid: VelocitySpace, record: Record, rescaled: bool
) -> xr.Dataset:
    """Dataset of a simulation: moments over ``time``, densities over ``snapshot``, status, trust.

    A rescaled run has the frame's θ, u and τ over ``time``, too, and keeps g over the scaled velocities in
    place of f.

    Where an exact temperature law is known (Maxwell molecules, constant e) it holds two references and
    two errors: `temperature_error`, of the temperature divided by the density, against the law with that
    density; and `paper_temperature_error`, the paper's measure, of 2E/d against the law of unit density.
    Both laws start from the discrete initial value.
    """
    names = LONG_NAMES | (FRAME_LONG_NAMES if rescaled else {})
    data: dict[str, Any] = {
        name: labelled(
            np.array([values[name] for values in record.moments]),
            long_name,
            ("time", *DIMENSIONS.get(name, ())),
        )
        for name, long_name in names.items()
    }
    ds = xr.Dataset(data, coords=time_axes(grid.dim, record.times))
    add_exact_law(ds, header.scene)
    if record.snapshots:
        ds = ds.assign(kept_densities(grid, record.snapshots, rescaled))
    ds = ds.assign(health_variables(record.health, record.reason))
    return stamped(ds, header, record.ending, record.plans)
