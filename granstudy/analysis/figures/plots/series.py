"""Lines of a plot out of labelled data: one for each value of the dimensions beside the abscissa."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from granstudy.trust.flags import Trust

MOST_LINES = 400
"""Lines of a plot at most."""


@dataclass(frozen=True)
class Series:
    """One line.

    Attributes
    ----------
    key : mapping
        Values of the dimensions that tell it from others.
    x, y : ndarray, shape (n,)
        Its points, by increasing x where x are numbers.
    trust : ndarray of int, shape (n,)
        Label of each point.
    """

    key: Mapping[str, Any]
    x: np.ndarray
    y: np.ndarray
    trust: np.ndarray


def abscissa(y: xr.DataArray, x: str) -> str:
    """The dimension that an abscissa is along.

    Raises
    ------
    ValueError
        If the data have no such dimension or coordinate.
    """
    if x in y.dims:
        return x
    along = [str(dim) for dim in y.coords[x].dims] if x in y.coords else []
    if not along:
        varied = [str(dim) for dim in y.dims]
        raise ValueError(
            f"x={x!r}: must be one of {', '.join(varied) or 'none, as there is one value'}"
        )
    # A coordinate over runs and outputs is along the last.
    return along[-1]


def series_of(y: xr.DataArray, x: str, trust: xr.DataArray | None = None) -> list[Series]:
    """All lines of y over x; NaN is left out.

    Raises
    ------
    ValueError
        If the data have no such abscissa, or there are more than `MOST_LINES` lines.
    """
    dim = abscissa(y, x)
    others = [str(d) for d in y.dims if d != dim]
    at = y.coords[x] if x in y.coords else xr.DataArray(np.arange(y.sizes[dim]), dims=dim)
    label = xr.DataArray(int(Trust.TRUSTED)) if trust is None else trust
    label = label.reset_coords(drop=True)
    label = label.isel({d: 0 for d in label.dims if d not in y.dims})
    xs, labels, _ = xr.broadcast(at.reset_coords(drop=True), label, y.reset_coords(drop=True))
    order = [*others, dim]
    values, xs, labels = (a.transpose(*order) for a in (y, xs, labels))
    shape = values.shape[:-1]
    if int(np.prod(shape)) > MOST_LINES:
        sizes = ", ".join(f"{d}: {y.sizes[d]}" for d in others)
        raise ValueError(f"{y.name}: has {np.prod(shape)} lines over {x} ({sizes}); select some")
    names = {
        d: (y.coords[d].values if d in y.coords else np.arange(y.sizes[d])).tolist() for d in others
    }
    found = []
    for place in np.ndindex(*shape):
        one, there, trusted = values.values[place], xs.values[place], labels.values[place]
        kept = np.isfinite(one)
        if there.dtype.kind == "f":
            kept &= np.isfinite(there)
        if not kept.any():
            continue
        key = {
            d: names[d][i].item() if hasattr(names[d][i], "item") else names[d][i]
            for d, i in zip(others, place, strict=True)
        }
        sort = np.argsort(there[kept], kind="stable") if there.dtype.kind in "fiu" else slice(None)
        found.append(Series(key, there[kept][sort], one[kept][sort], trusted[kept][sort]))
    return found


def varying(series: list[Series]) -> dict[str, list[Any]]:
    """Dimensions in which lines differ, with their values in order."""
    found: dict[str, list[Any]] = {}
    for dim in series[0].key if series else ():
        values = list(dict.fromkeys(one.key[dim] for one in series))
        if len(values) > 1:
            found[dim] = values
    return found
