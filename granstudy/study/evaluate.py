"""One evaluation of Q on a scene's initial density, as a labelled dataset."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.collision.fast.adaptive.retuning import Tuning
from granstudy.collision.operator import collision_operator, concrete
from granstudy.datasets.run_dataset import stamped
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.trust.flags import Status
from granstudy.velocity.space import VelocitySpace


def evaluate(scene: Scene, solver: Solver) -> xr.Dataset:
    """Evaluate Q(f0,f0); what the solver leaves open is chosen for the scene.

    Returns
    -------
    xarray.Dataset
        `Q` over the velocities, `status`, every parameter as a coordinate, and attributes as a run's.

    Raises
    ------
    ValueError
        As `granstudy.collision_operator`.
    """
    choice = concrete(scene, solver)
    operator = collision_operator(scene, choice.solver)
    Q = operator(scene.density(operator.grid))
    ds = collision_dataset(scene, choice.solver, operator.grid, Q, Tuning(operator).plans)
    return ds.assign_attrs(choice.attributes())


def collision_dataset(
    scene: Scene,
    solver: Solver,
    grid: VelocitySpace,
    Q: np.ndarray,
    plans: Sequence[dict[str, Any]] = (),
) -> xr.Dataset:
    """Dataset of one evaluation Q(f0,f0) on the initial density, shape ``grid.shape``."""
    attributes = {"long_name": "collision operator Q(f0,f0)", "units": "1"}
    ds = xr.Dataset({"Q": (grid.axes, Q, attributes)}, coords=grid.coordinates())
    finite = bool(np.all(np.isfinite(Q)))
    status, reason = (Status.OK, "") if finite else (Status.DIVERGED, "Q is not finite")
    return stamped(ds, scene, solver, None, status, reason, [], "collision", plans)
