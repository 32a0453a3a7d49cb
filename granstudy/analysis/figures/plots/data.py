"""Data of plots: runs over their parameters, a quantity over time or at the end, profiles of densities."""

import numpy as np
import xarray as xr

from granstudy.datasets.unstack import NOT_SWEPT, unstack_runs
from granstudy.reading.densities import marginal, over_maxwellian, scaled
from granstudy.reading.kept import Kept, kept
from granstudy.support.errors import unknown_name
from granstudy.trust.flags import Status

OUTPUTS = ("time", "output")
"""Names of the axis of outputs."""

KEPT = ("snapshot", "kept")
"""Names of the axis of kept densities."""

PROFILES = ("over_maxwellian", "tail", "marginal")
"""What is drawn of densities."""

LEAST = 1e-7
"""Densities are drawn down to this part of the largest; below it a grid's noise may be all there is."""


ABOVE_ERRORS = 5.0
"""Densities are held against a Maxwellian where they are so many times the largest negative one."""


def over_parameters(runs: xr.Dataset) -> xr.Dataset:
    """The runs with a dimension for each parameter in which they differ, in place of ``run``.

    Runs that several parameters tell apart together, as solvers do, stay over ``run``.
    """
    if "run" not in runs.dims:
        return runs
    varied = [
        str(name)
        for name, c in runs.coords.items()
        if c.dims == ("run",) and name not in NOT_SWEPT and np.unique(c.values).size > 1
    ]
    count = runs.sizes["run"]
    for name in varied:
        if np.unique(runs[name].values).size == count and len(varied) == 1:
            return unstack_runs(runs, [name])
    if not varied:
        return runs.squeeze("run") if count == 1 else runs
    try:
        return unstack_runs(runs, varied)
    except ValueError:
        return runs


def quantity_over(runs: xr.Dataset, quantity: str | xr.DataArray, x: str) -> xr.DataArray:
    """A quantity over time where ``x`` is ``time``, else at each run's end; NaN of runs that ended early.

    Raises
    ------
    ValueError
        For an unknown quantity, or one that is not over time where that is asked for.
    """
    if isinstance(quantity, xr.DataArray):
        return quantity
    found = _variable(runs, quantity)
    axis = [dim for dim in OUTPUTS if dim in found.dims]
    if x == "time":
        if not axis:
            raise ValueError(f"x='time': {quantity} is not over time")
        return found
    return at_end(found, runs)


def _variable(runs: xr.Dataset, quantity: str) -> xr.DataArray:
    """A variable of the runs; ValueError where there is none of that name."""
    if quantity not in runs:
        numbers = [str(name) for name, v in runs.data_vars.items() if v.dtype.kind == "f"]
        raise unknown_name("quantity", quantity, numbers)
    return runs[quantity]


def at_end(values: xr.DataArray, runs: xr.Dataset) -> xr.DataArray:
    """Values at the last output of each run; NaN of runs that ended early."""
    axis = [dim for dim in OUTPUTS if dim in values.dims]
    if axis:
        kept_attrs, name = values.attrs, values.name
        last = values.isel({axis[0]: -1}, drop=True)
        if "outputs" in runs:
            place = (runs["outputs"].fillna(1).astype(int) - 1).clip(min=0)
            last = values.isel({axis[0]: place.reset_coords(drop=True)}).drop_vars(
                ["time"], errors="ignore"
            )
        values = last.rename(name).assign_attrs(kept_attrs)
    if "status" in runs and set(runs["status"].dims) <= set(values.dims):
        values = values.where(runs["status"] == Status.OK)
    return values


def default_abscissa(runs: xr.Dataset, quantity: str | xr.DataArray) -> str:
    """Time for a quantity over time; else the parameter with most values, numbers first."""
    found = quantity if isinstance(quantity, xr.DataArray) else _variable(runs, quantity)
    if set(found.dims) & set(OUTPUTS):
        return "time"
    dims = [str(dim) for dim in found.dims]
    if not dims:
        raise ValueError(f"{found.name}: is one number; there is nothing to draw it over")

    def rank(dim: str) -> tuple[bool, int]:
        return dim in found.coords and found[dim].dtype.kind in "iuf", found.sizes[dim]

    return max(dims, key=rank)


def profile(ds: xr.Dataset, kind: str, axis: str | None = None) -> xr.DataArray:
    """A profile of kept densities over thermal velocities c, without what is below the noise of a grid.

    Parameters
    ----------
    kind : str
        One of `PROFILES`: f over the Maxwellian, T^{d/2} f/ρ, or √T ∫f over other components.
    axis : str, optional
        Along which axis; by default averages over directions, and x for a marginal.
    """
    held = kept(ds)
    if kind == "marginal":
        return _thermal_marginal(held, axis or "x")
    density = scaled(held, None, axis)
    if kind == "tail":
        return density
    # Densities are positive: what is negative shows how large the errors are.
    floor = np.maximum(LEAST * density.max("c"), ABOVE_ERRORS * (-density.min("c")).clip(min=0.0))
    return over_maxwellian(density.where(density > floor), held.dim)


def _thermal_marginal(held: Kept, axis: str) -> xr.DataArray:
    """√T f_x/ρ over c = (v_x − u_x)/√T."""
    attrs = {
        "long_name": f"thermal velocity (v_{axis} − u_{axis})/√T",
        "symbol": rf"$(v_{axis}-u_{axis})/\sqrt{{T}}$",
        "units": "1",
    }
    c = xr.DataArray(np.linspace(-6.0, 6.0, 121), dims="c")
    c = c.assign_coords(c=("c", c.values, attrs))
    values = marginal(held, axis, held.bulk(axis) + c * held.thermal)
    found = values * held.thermal / held.density
    return found.rename("marginal").assign_attrs(
        long_name=f"density of the velocity component {axis} in thermal units",
        symbol=rf"$\sqrt{{T}}\,f_{axis}/\rho$",
        units="1",
    )


def snapshots(ds: xr.Dataset, which: str | int | None = None) -> xr.Dataset:
    """The dataset with its last kept density alone, or with the one of an index.

    ``all`` keeps all; None takes all of one run, and the last of many runs.
    """
    axis = [dim for dim in KEPT if dim in ds.dims]
    if not axis or which == "all":
        return ds
    if which is None:
        alone = all(dim in (*OUTPUTS, *KEPT) or not _is_parameter(ds, str(dim)) for dim in ds.dims)
        return ds if alone else ds.isel({axis[0]: -1})
    if not isinstance(which, int):
        raise ValueError(f"snapshot={which!r}: must be 'all' or an index")
    return ds.isel({axis[0]: which})


def _is_parameter(ds: xr.Dataset, dim: str) -> bool:
    return dim == "run" or dim in ds.get("status", xr.DataArray(0)).dims
