"""Sweeps over a function of the user that returns a dataset."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.runs.store import Store
from granstudy.trust.flags import Status, flag_variable
from granstudy.workbench.tasks import CallTask, call_keys


def call_tasks(
    function: Callable[..., xr.Dataset], points: list[dict[str, Any]], fixed: Mapping[str, Any]
) -> list[CallTask]:
    """The call of a function at each point."""
    keys = call_keys(function, points, fixed)
    return [
        CallTask(function, {**fixed, **point}, key) for point, key in zip(points, keys, strict=True)
    ]


def call_dataset(
    tasks: Sequence[CallTask],
    points: Sequence[dict[str, Any]],
    store: Store,
    failures: Mapping[str, str],
) -> xr.Dataset:
    """What the calls returned, over the swept parameters; a call that failed has its cause as `reason`."""
    found = []
    for task in tasks:
        ds = store.read(task.key)
        if ds is None:
            ds = _failed(failures.get(task.key, "it is not in the store"))
        found.append(_with_reason(ds))
    dims = list(points[0])
    index = {name: list(dict.fromkeys(_label(point[name]) for point in points)) for name in dims}
    joined = xr.concat(
        found, "point", join="outer", data_vars="all", coords="minimal", compat="override",
        combine_attrs="drop_conflicts",
    )  # fmt: skip
    sizes = [len(values) for values in index.values()]
    variables = {
        name: _folded(variable, dims, sizes) for name, variable in joined.data_vars.items()
    }
    others = {name: c for name, c in joined.coords.items() if "point" not in c.dims}
    return xr.Dataset(variables, {**others, **index}, joined.attrs)


def _folded(variable: xr.DataArray, dims: Sequence[str], sizes: Sequence[int]) -> xr.Variable:
    """A variable over the points, which are in the order of a product, over the product's parameters."""
    moved = variable.variable.transpose("point", ...)
    shape = (*sizes, *moved.shape[1:])
    return xr.Variable((*dims, *moved.dims[1:]), moved.values.reshape(shape), moved.attrs)


def _failed(reason: str) -> xr.Dataset:
    return xr.Dataset({"status": flag_variable(Status.FAILED, "how the run ended", reason=reason)})


def _with_reason(ds: xr.Dataset) -> xr.Dataset:
    """The dataset with its status, and with the reason of an early end as a variable."""
    if "status" not in ds:
        ds = ds.assign(status=flag_variable(Status.OK, "how the run ended"))
    attributes = dict(ds["status"].attrs)
    reason = str(attributes.pop("reason", ""))
    ds = ds.drop_attrs(deep=False).assign(reason=((), np.array(reason, dtype=object)))
    ds["status"].attrs = attributes
    return ds


def _label(value: Any) -> Any:
    """A value as a label along a dimension."""
    return value if isinstance(value, bool | int | float | str) else str(value)
