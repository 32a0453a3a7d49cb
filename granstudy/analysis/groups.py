"""Groups of a table's runs: runs with equal values of some parameters."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.study.schema.words import coordinate

Key = tuple[Any, ...]
"""Values of some parameters, in their order."""


def values_of(table: xr.Dataset, name: str, absent: object = "") -> np.ndarray:
    """A parameter's value for every run, swept or held fixed; ``absent`` where the table lacks it."""
    values = table[name].values if name in table.coords else np.array(absent)
    return np.broadcast_to(values, table.sizes["run"])


def check_swept(field: str, name: str, table: xr.Dataset) -> str:
    """The coordinate of a table that a field of a study file names; ValueError unless it is swept."""
    swept = table.attrs["swept"].split()
    found = name if name in swept else coordinate(name)
    if found not in swept:
        raise ValueError(
            f"{field}={name!r}: must be one of the swept parameters {', '.join(swept)}"
        )
    return found


def check_numbers(field: str, name: str, table: xr.Dataset) -> None:
    """Raise ValueError unless a swept parameter is a positive number in every run."""
    values = values_of(table, name)
    if values.dtype.kind not in "if" or not np.all(np.isfinite(values) & (values > 0)):
        shown = ", ".join(map(str, list(dict.fromkeys(values.tolist()))[:5]))
        raise ValueError(f"{field}={name!r}: must have positive numbers, not {shown}")


def keys(table: xr.Dataset, names: Sequence[str]) -> list[Key]:
    """Values of some parameters for every run."""
    columns = [values_of(table, name).tolist() for name in names]
    return list(zip(*columns, strict=True)) if columns else [()] * table.sizes["run"]


def groups(keys: Sequence[Key]) -> dict[Key, list[int]]:
    """Runs by their key, in the order in which keys first occur."""
    found: dict[Key, list[int]] = {}
    for i, key in enumerate(keys):
        found.setdefault(key, []).append(i)
    return found
