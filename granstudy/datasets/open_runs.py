"""Many runs opened as one labelled dataset."""

import numpy as np
import xarray as xr

from granstudy.datasets.belonging import Where, belonging
from granstudy.datasets.columns import absent
from granstudy.datasets.densities import Densities
from granstudy.datasets.gathering import OUTPUTS, Gathered, place
from granstudy.datasets.netcdf import heads
from granstudy.support.variables import attributes

OF_STATES = ("iteration", "tail_speed")
"""Axes that datasets of states alone have: steps of Newton's method, and speeds in the tail."""


def open_runs(where: Where, densities: bool = False, verify: bool = True) -> xr.Dataset:
    """Open many runs as one dataset over ``run``: moments and errors in memory, densities when used.

    Runs of all kinds of gases, grids and times open together. No file stays open. Ten thousand runs of 150
    outputs take a quarter of a minute and half a gigabyte.

    Parameters
    ----------
    where : str, Path or iterable of them
        A folder (all runs under it, references excluded), a glob pattern, or the files themselves. In a
        folder of results, runs that the study does not have now are left out, with a warning.
    densities : bool
        Whether kept densities are opened too, as Dask arrays: a file is read when its density is used.
    verify : bool
        Whether what is read is compared with its checksum: the head of each file, which is all but densities,
        and the whole file when a density is used. It takes a tenth of the time.

    Returns
    -------
    xarray.Dataset
        Every variable has the leading dimension ``run``; every parameter (e, N, variant, dt, ...) is a
        coordinate along ``run``.

        ===========================  =======================================================
        `status`                     how a run ended: ok, failed, diverged
        `reason`                     why a run ended early
        `warnings`, `trust_reasons`  what was noticed of a run; why it is not trusted
        `outputs`                    how many outputs a run has
        `run_key`, `title`           attributes of the runs
        after an early end           NaN
        what a run does not have     NaN, "", −1 or False (`granstudy.datasets.columns.absent`)
        ===========================  =======================================================

        Runs with common times have the dimension `time`. Otherwise the dimension is `output`, and `time` is a
        coordinate over (run, output). Other axes are treated alike (`granstudy.datasets.gathering.place`).

    Raises
    ------
    FileNotFoundError
        If there is no run.
    DamagedFileError
        If files are damaged; the error names all of them.
    ValueError
        With densities, if runs differ in their velocity grid: they have no common array.

    See Also
    --------
    final_values : the last output of every run.
    granstudy.datasets.unstack.unstack_runs : from ``run`` to an array over (e, N, variant, ...).
    """
    found = belonging(where)
    gathered = Gathered(len(found.files))
    kept = Densities()
    others = []
    for file, run in heads(found.files, verify):
        if found.keys.get(file) not in (None, run.attrs.get("run_key")):
            others.append(file)
            continue
        gathered.add(run)
        if densities:
            kept.add(file, run)
    found.warn(others)
    if not gathered.rows:
        raise FileNotFoundError(f"{where}: no runs of the study there")
    runs = gathered.dataset()
    return kept.added_to(runs) if densities else runs


def final_values(where: Where | xr.Dataset) -> xr.Dataset:
    """Moments and errors of many runs at the last output of each, as one dataset over ``run``.

    Parameters
    ----------
    where : str, Path, iterable of them, or xarray.Dataset
        Where the runs lie, as of `open_runs`; or the dataset of `open_runs`, which is not read again.

    Returns
    -------
    xarray.Dataset
        The dataset of `open_runs` without densities, with two differences: `time` is a coordinate along
        ``run``, and `density_drift` is the relative change of the density from first to last time. Runs that
        ended before their first output have NaN.
    """
    runs = where if isinstance(where, xr.Dataset) else open_runs(where)
    fleeting = {name for axis in (*OF_STATES, "snapshot") for name in (axis, place(axis))}
    runs = runs.drop_dims(fleeting.intersection(runs.dims))
    if OUTPUTS not in runs:
        return runs
    axis = "time" if "time" in runs.dims else place("time")
    outputs = np.nan_to_num(runs[OUTPUTS].values).astype(int)
    held = {
        name: _at(str(name), v, axis, outputs - 1) if axis in v.dims else v
        for name, v in runs.variables.items()
    }
    if "density" in held:
        first = _at("density", runs["density"].variable, axis, np.minimum(outputs, 1) - 1)
        held["density_drift"] = held["density"] / first - 1.0
        held["density_drift"].attrs = attributes("density, last over first, minus 1")
    coords = {name: held.pop(name) for name in runs.coords}
    return xr.Dataset(held, coords, runs.attrs)


def _at(name: str, variable: xr.Variable, axis: str, places: np.ndarray) -> xr.Variable:
    """The value of each run at its place along an axis; `absent` where the place is −1."""
    count, size = places.size, variable.sizes[axis]
    variable = variable.to_base_variable()
    if "run" not in variable.dims:
        variable = variable.set_dims({"run": count, **variable.sizes})
    variable = variable.transpose("run", axis, ...)
    shape = (count, *variable.shape[2:])
    values = np.full(shape, absent(name, variable.dtype), variable.dtype)
    there = places >= 0
    if size:
        values[there] = variable.values[there, places[there]]
    return xr.Variable(("run", *variable.dims[2:]), values, variable.attrs)
