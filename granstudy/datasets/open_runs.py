"""Many runs opened as one labelled dataset."""

import glob
from collections.abc import Callable, Hashable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from granstudy.datasets.parameters import ABSENT, parameter
from granstudy.support.errors import unknown_name
from granstudy.support.variables import attributes
from granstudy.trust.flags import Status

NOT_SWEPT = ("N_theta", "N_phi", "time")
"""Coordinates of a run that follow from others."""

VELOCITY_AXES = {"vx", "vy", "vz", "r", "cx", "cy", "cz", "c"}
"""Axes of densities: velocities v of fixed frames, scaled velocities c of rescaled ones."""

OF_STATES = {"iteration", "tail_speed"}
"""Axes that datasets of states alone have: steps of Newton's method, and speeds in the tail."""

Where = str | Path | Iterable[str | Path]
"""Where runs lie: a folder, a glob pattern, or the files themselves."""


def open_runs(where: Where, densities: bool = True) -> xr.Dataset:
    """Open many runs as one dataset over ``run``; values stay on disk until they are used.

    Parameters
    ----------
    where : str, Path or iterable of them
        A folder (all runs under it, references excluded), a glob pattern, or the files themselves.
    densities : bool
        Whether to open kept densities too. Without densities, runs of all grids go into one array.

    Returns
    -------
    xarray.Dataset
        Every variable has the leading dimension ``run``; every parameter (e, N, variant, dt, ...) is a
        coordinate along ``run``.

        ====================  ===========================================================
        `status`              how a run ended: ok, failed, diverged
        `reason`              why a run ended early
        `warnings`            what was noticed of a run
        after an early end    NaN
        an absent parameter   −1, "" or False (`granstudy.datasets.parameters.ABSENT`)
        ====================  ===========================================================

    Raises
    ------
    FileNotFoundError
        If there is no run.
    ValueError
        If runs differ in ``dt``, or, with densities, in their velocity grid: they have no common array.

    See Also
    --------
    final_values : the last time of every run, for runs that differ in dt.
    unstack_runs : from ``run`` to an array over (e, N, variant, ...).
    """
    runs = _open(where, (lambda ds: ds) if densities else _without_densities)
    if "time" in runs.dims and "dt" in runs.coords and np.unique(runs["dt"]).size > 1:
        raise ValueError(
            f"dt: the runs have steps {np.unique(runs['dt']).tolist()} and so no common times; "
            "open one dt at a time, or take final_values"
        )
    if VELOCITY_AXES & set(runs.dims) and any(np.unique(runs[key]).size > 1 for key in ("N", "R")):
        grids = sorted(set(zip(runs["N"].values.tolist(), runs["R"].values.tolist(), strict=True)))
        raise ValueError(
            f"N, R: the runs have velocity grids {grids}; open one grid at a time, "
            "or with densities=False"
        )
    return runs


def final_values(where: Where) -> xr.Dataset:
    """Open moments and errors of many runs at the last time of each, as one dataset over ``run``.

    The dataset is as of `open_runs` without densities, with two differences: `time` is a coordinate along
    ``run``, and `density_drift` is the relative change of the density from first to last time.
    """
    return _open(where, _at_last_time)


def unstack_runs(runs: xr.Dataset, over: Sequence[str] | None = None) -> xr.Dataset:
    """Turn ``run`` into one dimension for each parameter: an array over (e, N, variant, ...).

    Parameters
    ----------
    runs : xarray.Dataset
        The dataset of `open_runs` or `final_values`.
    over : sequence of str, optional
        Parameters that become dimensions; by default all with more than one value.

    Returns
    -------
    xarray.Dataset
        Parameters with one value become scalar coordinates. Where there is no run, `status` is −1
        (missing), and other variables are NaN, "" or −1.

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
    places = pd.DataFrame({name: runs[name].values for name in over})
    if places.duplicated().any() or not over:
        others = [name for name in varying if name not in (*over, *NOT_SWEPT)]
        raise ValueError(
            f"over={tuple(over)}: several runs share a place, as the runs differ in {others} too; "
            "select one value, or add to over"
        )
    runs = runs.assign_coords(
        {name: runs[name].variable[0] for name in parameters if name not in (*varying, *over)}
    )
    if len(over) == 1:
        return runs.swap_dims(run=over[0]).sortby(over[0])
    fill = {name: _hole(name, variable.dtype) for name, variable in runs.variables.items()}
    array = runs.set_index(run=list(over)).unstack("run", fill_value=fill)
    return array.sortby(list(over)).transpose(*over, ...)


def run_files(where: Where) -> list[str]:
    """Files of the runs in a folder, of a glob pattern, or as given; FileNotFoundError if there are none."""
    if not isinstance(where, (str, Path)):
        files = [str(path) for path in where]
    elif Path(where).is_dir():
        files = sorted(
            str(path)
            for path in Path(where).rglob("*.nc")
            if "reference" not in path.relative_to(where).parts
            # excludes half-written files and files of unfinished jobs
            and not any(part.startswith(".") for part in path.relative_to(where).parts)
        )
    else:
        files = sorted(glob.glob(str(where), recursive=True))
    if not files:
        raise FileNotFoundError(f"{where}: no runs there")
    return files


def _open(where: Where, select: Callable[[xr.Dataset], xr.Dataset]) -> xr.Dataset:
    """Open runs over ``run``, each reduced by ``select`` first."""
    known: set[Hashable] = set()

    def preprocess(ds: xr.Dataset) -> xr.Dataset:
        known.update(ds.coords)
        return _labelled(select(ds))

    runs = xr.open_mfdataset(
        run_files(where),
        engine="netcdf4",
        combine="nested",
        concat_dim="run",
        preprocess=preprocess,
        data_vars="minimal",
        coords="minimal",
        compat="override",
        # Runs that ended early have fewer times; the times that they have are the same numbers.
        join="outer",
        combine_attrs="drop_conflicts",
    )
    return runs.drop_vars(ABSENT.keys() - known)


def _labelled(ds: xr.Dataset) -> xr.Dataset:
    """One run with a dimension ``run``, and its parameters along ``run``."""
    status = ds["status"]
    texts = {name: ((), status.attrs.pop(name, "")) for name in ("reason", "warnings")}
    scalars = {name: c.values for name, c in ds.coords.items() if c.ndim == 0}
    scalars |= {name: np.array(v) for name, v in ABSENT.items() if name not in scalars}
    ds = ds.assign(texts).drop_vars(list(scalars), errors="ignore").expand_dims("run")
    return ds.assign_coords(
        {
            name: ("run", value[np.newaxis], parameter(str(name)).attributes)
            for name, value in scalars.items()
        }
    )


def _without_densities(ds: xr.Dataset) -> xr.Dataset:
    """The run without kept densities and their axes."""
    return ds.drop_dims(({"snapshot"} | VELOCITY_AXES) & set(ds.dims))


def _at_last_time(ds: xr.Dataset) -> xr.Dataset:
    """The run at its last time, NaN where it ended before its first moments."""
    ds = _without_densities(ds)
    ds = ds.drop_dims(OF_STATES & set(ds.dims))
    if "time" not in ds.dims:
        return ds
    if ds.sizes["time"] == 0:
        ds = ds.reindex(time=[np.nan])
    density = ds["density"]
    ds["density_drift"] = density[-1] / density[0] - 1.0
    ds["density_drift"].attrs = attributes("density, last over first, minus 1")
    return ds.isel(time=-1)


def _hole(name: Hashable, dtype: np.dtype) -> Any:
    """The value that stands where there is no run."""
    if name == "status":
        return np.int8(Status.MISSING)
    if dtype.kind in "iu":
        return -1
    return "" if dtype.kind in "OUT" else np.nan
