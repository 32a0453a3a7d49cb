"""Moments and densities over velocities v, of runs on rescaled velocities c = (v − u)/θ."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy.support.variables import attributes
from granstudy.velocity.moments import MOMENTS


def physical_moments(values: dict[str, Any], scale: float, velocity: np.ndarray) -> dict[str, Any]:
    """Moments of f(v) = θ^{−d} g((v − u)/θ) from moments of g.

    Each moment scales with θ as its row of `granstudy.velocity.moments.MOMENTS` says. The bulk velocity is
    given, and E = ½ρ(|u_f|² + dT).

    Parameters
    ----------
    values : dict
        Moments of g (`granstudy.velocity.moments.moment_values`).
    scale : float
        θ.
    velocity : ndarray, shape (d,)
        Bulk velocity u_f of f.
    """
    d = len(velocity)
    found = {
        name: moment.scaled(values[name], scale, d)
        for name, moment in MOMENTS.items()
        if moment.scaled is not None
    }
    energy = 0.5 * found["density"] * (np.sum(velocity**2) + d * found["temperature"])
    return found | {
        "velocity": velocity,
        "energy": energy,
        "paper_temperature": 2.0 * energy / d,
    }


def physical_density(ds: xr.Dataset) -> xr.DataArray:
    """Densities f(t, v) that a run kept, in either frame, or the density f(v) of a state.

    Parameters
    ----------
    ds : xarray.Dataset
        Dataset of `granstudy.simulate`, `granstudy.cooling_state` or `granstudy.heated_state`.

    Returns
    -------
    xarray.DataArray
        f. For a run in the fixed frame, `f` as it was kept. For a rescaled run f = θ^{−d} g, over the
        scaled axes; each snapshot has velocities v = u + θc of its own; so the coordinates ``vx``, ``vy``
        (``vz``), or ``r``, run over ``snapshot`` and the scaled axis. For a state they run over the scaled
        axis alone.

    Raises
    ------
    ValueError
        If the run kept no density.
    """
    if "f" in ds:
        return ds["f"]
    if "g" not in ds:
        raise ValueError("the dataset holds no density: give simulate save_every")
    at = ds[["velocity_scale"]].assign(u=ds["frame_velocity" if "snapshot" in ds else "velocity"])
    if "snapshot" in ds:
        at = at.sel(time=ds["snapshot"]).drop_vars("time")
    theta = at["velocity_scale"]
    f = ds["g"] / theta ** ds.sizes["component"]
    if "c" in ds.dims:
        speeds = theta * ds["c"]
        speeds.attrs = attributes("radial speed |v|")
        f = f.assign_coords(r=speeds)
    else:
        for i, axis in enumerate(ds["component"].values):
            v = at["u"].isel(component=i, drop=True) + theta * ds[f"c{axis}"]
            v.attrs = attributes(f"velocity {axis}")
            f = f.assign_coords({f"v{axis}": v})
    return f.rename("f").assign_attrs(long_name="velocity density f", units="1")
