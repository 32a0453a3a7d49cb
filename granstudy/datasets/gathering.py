"""Many runs as arrays over ``run``, each run in its row.

Memory is that of the result: an array is made at the first run that has the variable, and each run fills
its row.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.columns import absent, column
from granstudy.datasets.storage.encoding import DENSITY_AXES, Contents, Values

TEXTS = (
    ("status", "reason", "reason"),
    ("status", "warnings", "warnings"),
    ("trust", "reasons", "trust_reasons"),
)
"""Attributes of flags that become variables: flag, attribute, name of the variable."""

OWN = ("run_key", "title")
"""Attributes of a run that become variables."""

STAMPED = ("checksum", "schema_version", "payload_sha256", *OWN)
"""Attributes of a run that are none of many runs."""

PLACES = {"time": "output", "snapshot": "kept"}
"""Names of axes along which runs differ in their coordinate."""

INDEX = "_index"
"""Ending of the names of other such axes."""

OUTPUTS = "outputs"
"""Variable that counts the outputs of each run, those up to an early end."""


def place(axis: str) -> str:
    """Name of an axis along which runs differ in the coordinate ``axis``, which is then over (run, place)."""
    return PLACES.get(axis, axis + INDEX)


def axis_at(place: str) -> str:
    """The axis whose `place` this is; the name itself where it is none."""
    named = {name: axis for axis, name in PLACES.items()}
    return named.get(place, place.removesuffix(INDEX))


class Gathered:
    """Runs gathered so far, out of at most so many."""

    def __init__(self, count: int) -> None:
        self.count, self.rows = count, 0
        self.attrs: dict[str, Any] | None = None
        self.labels: set[str] = set()
        self.dims: dict[str, tuple[str, ...]] = {}
        self.described: dict[str, dict[str, Any]] = {}
        self.axes: dict[str, Axis] = {}
        self.series: dict[str, Series] = {}
        self.scalars: dict[str, dict[int, Any]] = {}

    def add(self, run: Contents) -> None:
        """Take the next run, without its densities and their axes.

        Raises
        ------
        ValueError
            If a variable has other axes than in a run before.
        """
        row, self.rows = self.rows, self.rows + 1
        attrs = {name: value for name, value in run.attrs.items() if name not in STAMPED}
        self.attrs = attrs if self.attrs is None else agreed(self.attrs, attrs)
        self.labels |= run.labels
        for name, variable in run.variables.items():
            if not DENSITY_AXES.intersection(variable[0]):
                self._take(row, name, variable)
        if "time" in run.variables and run.variables["time"][0] == ("time",):
            size = run.variables["time"][1].size
            self._take(row, OUTPUTS, ((), np.array(size), {"long_name": "number of outputs"}))
        for name in OWN:
            if name in run.attrs:
                self._take(row, name, ((), np.array(run.attrs[name]), {}))

    def dataset(self) -> xr.Dataset:
        """All runs as one dataset; a variable that a run lacks has the value `absent` there."""
        renamed = {name: place(name) for name, axis in self.axes.items() if not axis.is_shared}
        sizes = {name: axis.longest.size for name, axis in self.axes.items()}
        for series in self.series.values():
            for dim, size in zip(series.dims, series.extent, strict=True):
                sizes[dim] = max(size, sizes.get(dim, 0))
        held: dict[str, xr.Variable] = {}
        for name, described in self.described.items():
            if name in self.axes:
                axis = self.axes[name]
                values = axis.values(self.rows) if name in renamed else axis.longest
                dims: Sequence[str] = ("run", renamed[name]) if name in renamed else (name,)
            elif name in self.series:
                series = self.series[name]
                values = series.values(self.rows, [sizes[dim] for dim in series.dims])
                dims = ("run", *(renamed.get(dim, dim) for dim in series.dims))
            else:
                found = self.scalars[name]
                values = column(name, [found.get(row) for row in range(self.rows)])
                dims = ("run",)
            held[name] = xr.Variable(dims, values, described)
        labels = {name for name in held if name in self.labels or name in self.axes}
        data = {name: v for name, v in held.items() if name not in labels}
        coords = {name: v for name, v in held.items() if name in labels}
        return xr.Dataset(data, coords, self.attrs)

    def _take(self, row: int, name: str, variable: Values) -> None:
        """Take one variable of a run."""
        dims, values, described = variable
        if self.dims.setdefault(name, dims) != dims:
            raise ValueError(
                f"{name}: has the axes {self.dims[name]} in some runs and {dims} in others; open the two "
                "kinds of runs (evolutions, states) one after the other"
            )
        for flag, key, text in TEXTS:
            if flag == name and key in described:
                self._take(row, text, ((), np.array(described[key]), {}))
                described = {k: v for k, v in described.items() if k != key}
        known = self.described.get(name)
        self.described[name] = described if known is None else agreed(known, described)
        if dims == (name,):
            self.axes.setdefault(name, Axis()).add(row, values)
        elif dims:
            series = self.series.get(name)
            if series is None:
                series = self.series[name] = Series(name, dims, values, self.count)
            series.put(row, values)
        else:
            self.scalars.setdefault(name, {})[row] = (
                values.item() if values.dtype.kind == "U" else values[()]
            )


class Axis:
    """Coordinates of an axis, run by run."""

    def __init__(self) -> None:
        self.by_row: dict[int, np.ndarray] = {}
        self.longest = np.empty(0)
        self.is_shared = True

    def add(self, row: int, values: np.ndarray) -> None:
        """Take the coordinates of a run."""
        if not self.by_row:
            self.longest = values
        # Runs that share an axis share the array.
        self.by_row[row] = self.longest if np.array_equal(values, self.longest) else values
        common = min(values.size, self.longest.size)
        self.is_shared = self.is_shared and np.array_equal(values[:common], self.longest[:common])
        if values.size > self.longest.size:
            self.longest = values

    def values(self, rows: int) -> np.ndarray:
        """The coordinates of every run, which end where the run does."""
        series = Series("", ("",), self.longest, rows)
        for row, values in self.by_row.items():
            series.put(row, values)
        return series.values(rows, [self.longest.size])


class Series:
    """One variable of all runs: an array with a row for each run.

    Parameters
    ----------
    name : str
    dims : tuple of str
        Axes beside ``run``.
    first : ndarray
        The values of one run.
    count : int
        Number of runs at most.
    """

    def __init__(self, name: str, dims: tuple[str, ...], first: np.ndarray, count: int) -> None:
        self.dims, self.extent = dims, (0,) * len(dims)
        kind = first.dtype.kind
        dtype: Any = first.dtype if kind == "f" else object if kind in "UO" else np.float64
        self.hole = absent(name, np.dtype(dtype))
        self.rows = np.full((count, *first.shape), self.hole, dtype)

    def put(self, row: int, values: np.ndarray) -> None:
        """Put the values of a run into its row."""
        room = self.rows.shape[1:]
        if any(size > most for size, most in zip(values.shape, room, strict=True)):
            # Room for more than is needed, so that runs of growing length are not copied at each of them.
            more = [
                math.ceil(1.5 * size) if size > most else most
                for size, most in zip(values.shape, room, strict=True)
            ]
            self.rows = self._sized(self.rows.shape[0], more)
        self.extent = tuple(map(max, self.extent, values.shape))
        self.rows[row][tuple(slice(size) for size in values.shape)] = values

    def values(self, rows: int, sizes: Sequence[int]) -> np.ndarray:
        """The first rows, with so many places along each axis."""
        exact = self.rows if self.rows.shape == (rows, *sizes) else self._sized(rows, sizes)
        return exact.astype(str) if exact.dtype.kind == "O" else exact

    def _sized(self, rows: int, sizes: Sequence[int]) -> np.ndarray:
        found = np.full((rows, *sizes), self.hole, self.rows.dtype)
        common = tuple(slice(min(pair)) for pair in zip(found.shape, self.rows.shape, strict=True))
        found[common] = self.rows[common]
        return found


def agreed(one: dict[str, Any], other: dict[str, Any]) -> dict[str, Any]:
    """Attributes that are equal in both."""
    return {k: v for k, v in one.items() if k in other and _is_equal(v, other[k])}


def _is_equal(one: Any, other: Any) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return bool(type(one) is type(other) and one == other)
    return np.array_equal(one, other)
