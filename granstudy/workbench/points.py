"""Points of a sweep: the values of its parameters, their labels, and runs put in their places."""

import itertools
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from pydantic import ValidationError

from granstudy.datasets.columns import absent
from granstudy.datasets.parameters import parameter
from granstudy.datasets.unstack import unstack_runs
from granstudy.model.identity import coordinate
from granstudy.study.schema.sections import RangeModel
from granstudy.support.checks import is_real, plain
from granstudy.support.own_code.code import name_of
from granstudy.trust.flags import Status

Values = Sequence[Any] | np.ndarray | Mapping[str, Any]
"""Values of a swept parameter; or a range, ``{"start": .., "stop": .., "count": ..}``, as in study files."""

Point = dict[str, Any]
"""The value of each swept parameter."""

LOST = "its file was damaged and is removed; the same call computes it anew"
"""Why a point has no run although nothing failed."""


def listed(over: Mapping[str, Values], fixed: Mapping[str, Any]) -> dict[str, list[Any]]:
    """The values of each swept parameter, as numbers of Python.

    Raises
    ------
    ValueError
        For a parameter without values, with the same value twice, or that is fixed too.
    """
    if not isinstance(over, Mapping) or not over:
        raise ValueError(f"over={over!r}: give at least one parameter and its values, as a mapping")
    for name in over:
        if not isinstance(name, str):
            raise ValueError(f"over={{{name!r}: ...}}: a parameter must be named by a text")
        if name in fixed:
            raise ValueError(f"{name}={fixed[name]!r}: is in over too; give it once")
    return {name: _values(name, values) for name, values in over.items()}


def _values(name: str, values: Values) -> list[Any]:
    where = f"over[{name!r}]"
    if isinstance(values, Mapping):
        try:
            found: list[Any] = list(RangeModel.model_validate(dict(values)).values())
        except ValidationError as error:
            raise ValueError(f"{where}: {_refused(error)}") from None
    elif isinstance(values, str) or not isinstance(values, Sequence | np.ndarray | xr.DataArray):
        raise ValueError(f"{where}={values!r}: must be a list of values, or a range")
    else:
        entries = values if isinstance(values, Sequence) else np.asarray(values).tolist()
        found = [plain(value) for value in entries]
    if not found:
        raise ValueError(f"{where}: is empty; give at least one value")
    real = parameter(coordinate(name)).real
    found = [float(value) if real and type(value) is int else value for value in found]
    if len({repr(float(v)) if is_real(v) else repr(v) for v in found}) < len(found):
        raise ValueError(f"{where}={found}: has a value twice")
    return found


def _refused(error: ValidationError) -> str:
    """What is wrong with a range, in a line."""
    return "; ".join(
        ": ".join([*map(str, one["loc"]), one["msg"].removeprefix("Value error, ")])
        for one in error.errors()
    )


def product(lists: Mapping[str, list[Any]]) -> list[Point]:
    """All points."""
    return [dict(zip(lists, point, strict=True)) for point in itertools.product(*lists.values())]


def shown(point: Mapping[str, Any]) -> str:
    """A point in words, for messages."""
    return ", ".join(f"{name}={_text(value)}" for name, value in point.items())


def labels(
    lists: Mapping[str, list[Any]],
    points: Sequence[Point],
    coordinates: Callable[[int], Mapping[str, Any]] = lambda place: {},
) -> dict[str, list[Any]]:
    """What stands for each value in datasets: numbers and texts stand for themselves.

    For a function, a scene or a vector stands what runs have as that coordinate; where this does not tell two
    values apart, their texts.

    Parameters
    ----------
    lists : mapping
        Values of each swept parameter.
    points : sequence of Point
    coordinates : callable
        Place of a point ↦ the coordinates that its run has.

    Raises
    ------
    ValueError
        Where two values have the same text.
    """
    found = {}
    for name, values in lists.items():
        if all(isinstance(value, bool | int | float | str) for value in values):
            found[name] = values
            continue
        first = [next(i for i, p in enumerate(points) if p[name] is value) for value in values]
        held: list[Any] = [coordinates(place).get(coordinate(name)) for place in first]
        if None in held or len(set(held)) < len(held):
            held = [_text(value) for value in values]
        if len(set(held)) < len(held):
            raise ValueError(
                f"over[{name!r}]: values have the same name, {', '.join(map(str, held))}; give each its own"
            )
        found[name] = held
    return found


def _text(value: Any) -> str:
    """A value as text, the same in every process."""
    if isinstance(value, list | tuple):
        return f"({', '.join(map(_text, value))})"
    named = hasattr(value, "__name__") or hasattr(value, "reference")
    return name_of(value) if named else re.sub(" at 0x[0-9a-f]+", "", repr(value))


def at_points(
    runs: xr.Dataset,
    keys: Sequence[str],
    labelled: Mapping[str, list[Any]],
    failures: Mapping[str, str],
) -> xr.Dataset:
    """Runs as an array over the swept parameters.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs over ``run``, with `run_key`.
    keys : sequence of str
        The key of each point, in the order of `product`.
    labelled : mapping
        The labels of each parameter's values.
    failures : mapping of str
        Causes of points that have no run, by key.

    Returns
    -------
    xarray.Dataset
        A point without a run has the status failed, and its cause as `reason`.
    """
    row = {key: i for i, key in enumerate(runs["run_key"].values.tolist())}
    places = np.array([row.get(key, -1) for key in keys])
    found = _with_holes(runs, places)
    causes = [
        "" if place >= 0 else failures.get(key, LOST)
        for place, key in zip(places, keys, strict=True)
    ]
    reasons = found["reason"].values.tolist()
    status = np.where(places < 0, np.int8(Status.FAILED), found["status"].values)
    found = found.assign(
        run_key=("run", list(keys)),
        status=("run", status, found["status"].attrs),
        reason=("run", [cause or reason for cause, reason in zip(causes, reasons, strict=True)]),
    )
    shown_points = product(labelled)
    for word in labelled:
        name, values = coordinate(word), np.array([point[word] for point in shown_points])
        found = found.assign_coords({name: ("run", values, parameter(name).attributes)})
    return unstack_runs(found.set_coords("run_key"), [coordinate(word) for word in labelled])


def _with_holes(runs: xr.Dataset, places: np.ndarray) -> xr.Dataset:
    """The run of each place, and a hole at −1; a parameter that all runs share has its value there too."""
    found = runs.isel(run=np.maximum(places, 0))
    if (places >= 0).all():
        return found
    there = xr.Variable("run", places >= 0)
    varying = {
        name: variable
        for name, variable in found.variables.items()
        if "run" in variable.dims
        and (name not in runs.coords or np.unique(runs[name].values).size > 1)
    }
    holes = {n: v.where(there, absent(str(n), v.dtype)) for n, v in varying.items()}
    return found.assign(holes)
