"""One evaluation of Q on a scene's initial density, as a labelled dataset."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.collision.fast.adaptive.retuning import Tuning
from granstudy.collision.operator import collision_operator, concrete
from granstudy.collision.protocol import wisdom_attributes
from granstudy.datasets.run_dataset import Ending, Header, stamped
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.machine import one_blas_thread
from granstudy.support.variables import labelled
from granstudy.trust.flags import Status
from granstudy.velocity.space import VelocitySpace


@one_blas_thread()
def evaluate(scene: Scene, solver: Solver) -> xr.Dataset:
    """Evaluate Q(f0,f0) on the initial density f0; what the solver leaves open is chosen for the scene.

    Returns
    -------
    xarray.Dataset
        `Q` over the velocities, `status`, every parameter as a coordinate, and a run's attributes.

    Raises
    ------
    ValueError
        As `granstudy.collision_operator`.
    """
    choice = concrete(scene, solver)
    operator = collision_operator(scene, choice.solver)
    Q = operator(scene.density(operator.grid))
    header = Header.of("collision", scene, choice)
    ds = collision_dataset(header, operator.grid, Q, Tuning(operator).plans)
    return ds.assign_attrs(wisdom_attributes(operator))


def collision_dataset(
    header: Header, grid: VelocitySpace, Q: np.ndarray, plans: Sequence[dict[str, Any]] = ()
) -> xr.Dataset:
    """Dataset of one evaluation Q(f0,f0) on the initial density, shape ``grid.shape``."""
    ds = xr.Dataset(
        {"Q": labelled(Q, "collision operator Q(f0,f0)", grid.axes)}, coords=grid.coordinates()
    )
    finite = bool(np.all(np.isfinite(Q)))
    ending = Ending() if finite else Ending(Status.DIVERGED, "Q is not finite")
    return stamped(ds, header, ending, plans)
