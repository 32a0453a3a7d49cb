"""The dataset of a simulation on a grid."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.run_dataset import kept_densities, stamped
from granstudy.evolution.times import TimeSettings
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.trust.exact_law import add_exact_law
from granstudy.trust.flags import Status
from granstudy.trust.health import health_variables
from granstudy.velocity.moments import COMPONENTS, DIMENSIONS, FRAME_LONG_NAMES, LONG_NAMES
from granstudy.velocity.space import VelocitySpace


def evolution_dataset(
    scene: Scene,
    solver: Solver,
    settings: TimeSettings,
    grid: VelocitySpace,
    times: list[float],
    history: list[dict[str, Any]],
    snapshots: dict[float, np.ndarray],
    status: Status,
    reason: str,
    warnings: list[str],
    plans: Sequence[dict[str, Any]] = (),
    health_outputs: Sequence[dict[str, float]] = (),
) -> xr.Dataset:
    """Dataset of a simulation: moments over ``time``, densities over ``snapshot``, status.

    ``times`` are those of ``history``. A rescaled run has the frame's θ, u and τ over ``time``, too, and
    keeps g over the scaled velocities in place of f.

    Where an exact temperature law is known (Maxwell molecules, constant e) it holds two references and
    two errors: `temperature_error`, of the temperature divided by the density, against the law with that
    density; and `paper_temperature_error`, the paper's measure, of 2E/d against the law of unit density.
    Both laws start from the discrete initial value. ``plans`` are the quadratures that a tolerance came to,
    each with the time it was in use from; they become the attribute `quadrature`. ``health_outputs``, those
    of the run's `granstudy.trust.error_estimate.Examination`, become variables over ``time`` and the label
    `trust`.
    """
    rescaled = settings.frame == "rescaled"
    time = np.array(times)
    components = list(COMPONENTS[: grid.dim])
    data: dict[str, Any] = {
        name: (
            ("time", *DIMENSIONS.get(name, ())),
            np.array([values[name] for values in history]),
            {"long_name": long_name, "units": "1"},
        )
        for name, long_name in (LONG_NAMES | (FRAME_LONG_NAMES if rescaled else {})).items()
    }
    ds = xr.Dataset(
        data,
        coords={
            "time": ("time", time, {"long_name": "time t", "units": "1"}),
            "component": components,
            "component_": components,
        },
    )
    add_exact_law(ds, scene)
    if snapshots:
        ds = ds.assign(kept_densities(grid, snapshots, rescaled))
    ds = ds.assign(health_variables(health_outputs, reason))
    return stamped(ds, scene, solver, settings, status, reason, warnings, "evolution", plans)
