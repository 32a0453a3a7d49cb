"""Sweeps over a function of the user that returns a dataset."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.columns import absent
from granstudy.datasets.gathering import agreed
from granstudy.runs.store import Store
from granstudy.support.own_code.code import name_of
from granstudy.trust.flags import Status, flag_variable
from granstudy.workbench.points import LOST, shown
from granstudy.workbench.tasks import CallTask, call_key


def call_tasks(
    function: Callable[..., xr.Dataset], points: Sequence[dict[str, Any]], fixed: Mapping[str, Any]
) -> list[CallTask]:
    """The call of a function at each point.

    Raises
    ------
    ValueError
        For arguments that the function does not take, and a function or an argument that has no content to be
        known by.
    """
    tasks, signature = [], inspect.signature(function)
    for point in points:
        arguments = {**fixed, **point}
        try:
            bound = signature.bind(**arguments)
        except TypeError as error:
            raise ValueError(f"{shown(point)}: {name_of(function)}: {error}") from None
        bound.apply_defaults()  # so that a default that is given is the same call
        tasks.append(CallTask(function, arguments, call_key(function, bound.arguments)))
    return tasks


def call_runs(keys: Sequence[str], store: Store) -> xr.Dataset:
    """What calls returned, over ``run``, with `run_key`, `status` and `reason`.

    Results are put on common axes: where one has no value at an entry of an axis, it has a hole there
    (`granstudy.datasets.columns.absent`), as it has for a variable that it lacks.

    Raises
    ------
    ValueError
        If results differ in the axes of a variable, or in the length of an axis without coordinates.
    RuntimeError
        If no file can be read.
    """
    read = {key: ds for key in keys if (ds := store.read(key)) is not None}
    if not read:
        raise RuntimeError(f"no point can be read: {LOST}")
    found = [_with_reason(ds) for ds in read.values()]
    scalars = {name for ds in found for name in ds.coords if name not in ds.dims}
    found = [ds.reset_coords() for ds in found]
    kinds = {name: v.dtype for ds in found for name, v in ds.variables.items()}
    holes = {name: absent(str(name), kind) for name, kind in kinds.items()}
    try:
        aligned = xr.align(*found, join="outer", fill_value=holes)
    except ValueError as error:
        raise ValueError(f"what the function returns has no common axes: {error}") from None
    names = dict.fromkeys(name for ds in aligned for name in ds.data_vars)
    held = {name: _over_runs(str(name), [ds.get(name) for ds in aligned]) for name in names}
    axes = {name: axis for ds in aligned for name, axis in ds.coords.items()}
    attributes = aligned[0].attrs
    for ds in aligned:
        attributes = agreed(attributes, ds.attrs)
    runs = xr.Dataset(held, axes, attributes).assign(run_key=("run", list(read)))
    return runs.set_coords(["run_key", *scalars])


def _over_runs(name: str, values: Sequence[xr.DataArray | None]) -> xr.Variable:
    """A variable of all runs; holes where a run lacks it."""
    known = [one for one in values if one is not None]
    dims, hole = known[0].dims, absent(name, known[0].dtype)
    if any(one.dims != dims for one in known):
        raise ValueError(f"{name}: has the axes {' and '.join({str(one.dims) for one in known})}")
    rows = [np.full(known[0].shape, hole) if one is None else one.values for one in values]
    attributes = known[0].attrs
    for one in known:
        attributes = agreed(attributes, one.attrs)
    return xr.Variable(("run", *dims), np.stack(rows), attributes)


def _with_reason(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with its status, and with the reason of an early end as a variable."""
    if "status" not in ds:
        ds = ds.assign(status=flag_variable(Status.OK, "how the run ended"))
    attributes = dict(ds["status"].attrs)
    reason = str(attributes.pop("reason", ""))
    ds = ds.assign(reason=((), np.array(reason)))
    ds["status"].attrs = attributes
    return ds
