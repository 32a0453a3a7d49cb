"""From rescaled velocities c = (v − u)/θ back to v: moments and densities (docs/method.md §5)."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy.velocity.moments import MOMENTS


def physical_moments(values: dict[str, Any], scale: float, velocity: np.ndarray) -> dict[str, Any]:
    """Moments of f(v) = θ^{−d} g((v − u)/θ) from those of g.

    Each goes as its row of `granstudy.velocity.moments.MOMENTS` says; E = ½ρ(|u_f|² + dT).

    Parameters
    ----------
    values : dict
        `granstudy.velocity.moments.moment_values` of g.
    scale, velocity : float and ndarray of shape (d,)
        θ, and the bulk velocity u_f of f.
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
    """The saved densities f(t, v) of a run, whatever its frame, or the density f(v) of a state.

    Of a rescaled run f = θ^{−d} g lies on velocities v = u + θc of its own at each snapshot: ``vx``, ``vy``
    (``vz``), or ``r``, are coordinates over ``snapshot`` and the scaled axis; of a state over that axis.

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
        speeds.attrs = {"long_name": "radial speed |v|", "units": "1"}
        f = f.assign_coords(r=speeds)
    else:
        for i, axis in enumerate(ds["component"].values):
            v = at["u"].isel(component=i, drop=True) + theta * ds[f"c{axis}"]
            v.attrs = {"long_name": f"velocity {axis}", "units": "1"}
            f = f.assign_coords({f"v{axis}": v})
    return f.rename("f").assign_attrs(long_name="velocity density f", units="1")
