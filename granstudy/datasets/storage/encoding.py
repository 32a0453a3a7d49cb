"""A dataset as what files hold: numbers, characters of fixed width, axes that are not empty."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.storage.classic import Header

VELOCITY_AXES = {"vx", "vy", "vz", "r", "cx", "cy", "cz", "c"}
"""Axes of densities: velocities v of fixed frames, scaled velocities c of rescaled ones."""

DENSITY_AXES = VELOCITY_AXES | {"snapshot"}
"""Axes that densities alone have, and their coordinates."""

LABELS = "coordinates"
"""Attribute of a file that names coordinates, as xarray reads it."""

EMPTY = "empty_axes"
"""Attribute of a file that names axes of length 0, for each of which the file holds one place."""

STORAGE = ("head_checksum", "head_bytes", LABELS, EMPTY)
"""Attributes of a file that are none of its dataset."""

Values = tuple[tuple[str, ...], np.ndarray, dict[str, Any]]
"""Axes, values and attributes of a variable."""


@dataclass(frozen=True)
class Density:
    """Axes, shape, type and attributes of a density."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    dtype: np.dtype
    attrs: dict[str, Any]


@dataclass(frozen=True)
class Contents:
    """What was read of a dataset's file.

    Attributes
    ----------
    attrs : dict
        Attributes of the dataset.
    labels : set of str
        Names of its coordinates that are no axes.
    variables : dict
        The variables that were read, by name.
    densities : dict
        The densities that were not read, by name.
    """

    attrs: dict[str, Any]
    labels: set[str]
    variables: dict[str, Values]
    densities: dict[str, Density] = field(default_factory=dict)

    @property
    def dataset(self) -> xr.Dataset:
        """What was read, as a dataset."""
        held = {name: xr.Variable(*values) for name, values in self.variables.items()}
        labels = {name for name, v in held.items() if name in self.labels or v.dims == (name,)}
        data = {name: v for name, v in held.items() if name not in labels}
        return xr.Dataset(data, {name: held[name] for name in held if name in labels}, self.attrs)

    @property
    def without_densities(self) -> "Contents":
        """The same with densities as if they had not been read."""
        found = {
            name: Density(dims, values.shape, values.dtype, attrs)
            for name, (dims, values, attrs) in self.variables.items()
            if is_density(dims, name in self.labels or dims == (name,))
        }
        kept = {name: v for name, v in self.variables.items() if name not in found}
        return Contents(self.attrs, self.labels, kept, found)


def is_density(dims: tuple[str, ...], is_label: bool) -> bool:
    """Whether a variable is a density, by its axes; coordinates of velocities are none."""
    return not is_label and bool(DENSITY_AXES.intersection(dims))


def contents_of(ds: xr.Dataset) -> Contents:
    """All of a dataset in memory."""
    held = {name: ds.variables[name] for name in (*ds.coords, *ds.data_vars)}
    variables: dict[str, Values] = {
        str(name): (tuple(map(str, v.dims)), v.values, {str(k): a for k, a in v.attrs.items()})
        for name, v in held.items()
    }
    attrs = {str(name): value for name, value in ds.attrs.items()}
    return Contents(attrs, {str(name) for name in ds.coords if name not in ds.dims}, variables)


def encoded(contents: Contents) -> tuple[dict[str, Any], dict[str, Values]]:
    """Attributes and variables of a file.

    Text becomes characters in UTF-8 along an axis `string<width>`, with the attribute `_Encoding`; truth
    values become small whole numbers with the attribute `dtype`. xarray does both alike.

    Raises
    ------
    ValueError
        For values that files do not hold.
    """
    attrs, labels = dict(contents.attrs), [n for n in contents.variables if n in contents.labels]
    if any(" " in name for name in labels):
        raise ValueError(f"coordinates {labels}: names of coordinates have no spaces")
    if labels:
        attrs[LABELS] = " ".join(labels)
    empty = {
        dim
        for dims, values, _ in contents.variables.values()
        for dim, size in zip(dims, values.shape, strict=True)
        if size == 0
    }
    if empty:
        attrs[EMPTY] = " ".join(sorted(empty))
    return attrs, {name: _encoded(name, *v) for name, v in contents.variables.items()}


def decoded(header: Header, data: bytes) -> Contents:
    """The contents of a file from its header, and from its bytes or the first of them."""
    empty = set(header.attrs.get(EMPTY, "").split())
    attrs = {name: value for name, value in header.attrs.items() if name not in STORAGE}
    read = {name: v for name, v in header.variables.items() if v.begin < len(data)}
    variables = {name: _decoded(v.dims, v.values(data), v.attrs, empty) for name, v in read.items()}
    densities = {
        name: Density(
            v.dims,
            tuple(0 if d in empty else n for d, n in zip(v.dims, v.shape, strict=True)),
            v.dtype.newbyteorder("="),
            v.attrs,
        )
        for name, v in header.variables.items()
        if name not in read
    }
    return Contents(attrs, set(header.attrs.get(LABELS, "").split()), variables, densities)


def _decoded(
    dims: tuple[str, ...], values: np.ndarray, attrs: dict[str, Any], empty: set[str]
) -> Values:
    """A variable of a dataset from that of its file."""
    if "_Encoding" in attrs:
        text = values.view(f"S{values.shape[-1]}")[..., 0]
        values, dims = np.char.decode(text, "utf-8"), dims[:-1]
    elif attrs.get("dtype") == "bool":
        values = values.astype(bool)
    attrs = {name: value for name, value in attrs.items() if name not in ("_Encoding", "dtype")}
    if empty.intersection(dims):
        values = values[tuple(slice(0) if dim in empty else slice(None) for dim in dims)]
    return dims, values, attrs


def _encoded(name: str, dims: tuple[str, ...], values: np.ndarray, attrs: dict[str, Any]) -> Values:
    """A variable of a file from that of its dataset."""
    if values.dtype.kind in "OT" and all(isinstance(value, str) for value in values.flat):
        values = values.astype(str)
    if values.size == 0:
        place = np.array(np.nan if values.dtype.kind == "f" else 0).astype(values.dtype)
        values = np.full([max(1, n) for n in values.shape], place)
    if values.dtype.kind == "U":
        text = np.char.encode(values, "utf-8")
        characters = np.frombuffer(text.tobytes(), "S1").reshape(*text.shape, -1)
        return (*dims, f"string{characters.shape[-1]}"), characters, attrs | {"_Encoding": "utf-8"}
    if values.dtype.kind == "b":
        return dims, values.astype("i1"), attrs | {"dtype": "bool"}
    if values.dtype.kind not in "iuf":
        raise ValueError(
            f"{name}: has values of type {values.dtype}; files hold numbers, truth values and text"
        )
    return dims, values, attrs
