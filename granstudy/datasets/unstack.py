"""From runs in a row to an array over their parameters."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granstudy.datasets.columns import absent
from granstudy.support.errors import unknown_name

NOT_SWEPT = ("N_theta", "N_phi", "time")
"""Coordinates of a run that follow from others."""


def unstack_runs(runs: xr.Dataset, over: Sequence[str] | None = None) -> xr.Dataset:
    """Turn ``run`` into one dimension for each parameter: an array over (e, N, variant, ...).

    Parameters
    ----------
    runs : xarray.Dataset
        The dataset of `open_runs` or `final_values`.
    over : sequence of str, optional
        Parameters that become dimensions, numbers and text alike; by default all with more than one value.
        Runs without the parameter have a place of their own: NaN for `e` of a restitution law, which the
        parameter `restitution` names.

    Returns
    -------
    xarray.Dataset
        Parameters with one value become scalar coordinates. Where there is no run, `status` and `trust` are
        −1 (missing), and other variables are NaN, "" or −1.

    Raises
    ------
    ValueError
        For an unknown parameter, or where two runs would share a place.
    """
    parameters = [str(name) for name, c in runs.coords.items() if c.dims == ("run",)]
    varying = [name for name in parameters if np.unique(runs[name]).size > 1]
    if over is None:
        over = [name for name in varying if name not in NOT_SWEPT]
    for name in over:
        if name not in parameters:
            raise unknown_name("parameter of the runs", name, parameters)
    found = {name: np.unique(runs[name], return_inverse=True) for name in over}
    places = np.full([values.size for values, _ in found.values()], -1)
    where = tuple(indices for _, indices in found.values())
    if not over or len(set(zip(*where, strict=True))) < runs.sizes["run"]:
        others = [name for name in varying if name not in (*over, *NOT_SWEPT)]
        raise ValueError(
            f"over={tuple(over)}: several runs share a place, as the runs differ in {others} too; "
            "select one value, or add to over"
        )
    places[where] = np.arange(runs.sizes["run"])
    runs = runs.assign_coords(
        {name: runs[name].variable[0] for name in parameters if name not in (*varying, *over)}
    )
    along = [name for name, variable in runs.variables.items() if "run" in variable.dims]
    described = {name: runs[name].attrs for name in over}
    array = runs.drop_vars(over).isel(run=xr.DataArray(np.maximum(places, 0), dims=list(over)))
    if (places < 0).any():
        there = xr.Variable(list(over), places >= 0)
        array = array.assign(
            {
                name: array.variables[name].where(there, absent(str(name), array[name].dtype))
                for name in along
                if name not in over
            }
        )
    axes = {name: (name, values, described[name]) for name, (values, _) in found.items()}
    return array.assign_coords(axes).transpose(*over, ...)
