"""Exact temperature and kurtosis of Maxwell molecules at constant restitution (docs/theory.md §1)."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.model.scene import Scene
from granstudy.support.variables import labelled
from granstudy.velocity.sphere import sphere_area


def add_exact_law(ds: xr.Dataset, scene: Scene) -> None:
    """Add exact laws of T, and distances from them, to a run's dataset; nothing where no law is known.

    Each law starts from the discrete initial value. The law of `temperature` has the run's initial density,
    the law of `paper_temperature` unit density, as the paper has it.
    """
    if scene.kernel.exponent != 0.0 or callable(scene.restitution):
        return
    law: dict[str, Any] = {
        "t": ds["time"].values,
        "restitution": float(scene.restitution),
        "diffusion": scene.diffusion,
        "cross_section": sphere_area(scene.dim) * scene.kernel.strength,
    }
    density0 = float(ds["density"][0])
    for name, density in (("temperature", density0), ("paper_temperature", 1.0)):
        exact = theory.maxwell_temperature(T0=float(ds[name][0]), density=density, **law)
        long_name = f"exact law of {name} from its discrete initial value"
        ds[f"{name}_exact"] = labelled(exact, long_name, "time")
        error = np.abs(ds[name].values - exact)
        ds[f"{name}_error"] = labelled(error, f"|{name} − {name}_exact|", "time")


def check_maxwell_law(scene: Scene) -> None:
    """Raise ValueError unless T and a2 of the scene are known exactly.

    Exact laws hold for Maxwell molecules at constant restitution, and start from the moments that the
    initial density states.
    """
    if scene.kernel.exponent != 0.0:
        raise ValueError(
            f"truth.law='maxwell': holds at exponent 0, not at {scene.kernel.exponent!r}; give a solver"
        )
    if callable(scene.restitution):
        raise ValueError(
            f"truth.law='maxwell': holds at constant e, not with {scene.restitution!r}; give a solver"
        )
    if scene.moments is None:
        raise ValueError(
            f"truth.law='maxwell': initial={scene.initial!r} does not state its moments; give a solver"
        )
