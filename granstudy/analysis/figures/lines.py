"""Runs as lines: which belong to one, how it looks, what it is called."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from granstudy.analysis.figures.style import (
    COLOURS,
    LABELS,
    MARKERS,
    METHOD_COLOURS,
)


def _distinguishing(table: xr.Dataset, names: list[str]) -> list[str]:
    """Find the parameters that are needed to tell the lines apart."""
    kept = [name for name in names if name not in ("N_theta", "N_phi")]
    # What says least is left out first.
    for name in sorted(kept, key=lambda name: (name != "dt", name != "method")):
        fewer = [other for other in kept if other != name]
        if len(list(_lines(table, fewer))) == len(list(_lines(table, kept))):
            kept = fewer
    return kept


def _lines(table: xr.Dataset, names: list[str]) -> Iterator[tuple[tuple[str, ...], xr.Dataset]]:
    """Group runs with equal values of ``names``, by these values."""
    keys = [tuple(str(table[name].values[i]) for name in names) for i in range(table.sizes["run"])]
    for key in dict.fromkeys(keys):
        yield key, table.isel(run=[i for i, other in enumerate(keys) if other == key])


def _label(key: tuple[str, ...]) -> str:
    return ", ".join(LABELS.get(value, value) for value in key)


def _looks(keys: list[tuple[str, ...]]) -> dict[tuple[str, ...], dict[str, Any]]:
    """Colour, marker and width of every line."""
    looks: dict[tuple[str, ...], dict[str, Any]] = {}
    for i, key in enumerate(keys):
        method = next((value for value in key if value in METHOD_COLOURS), None)
        # What others agree with lies under them, wide and pale, so that both are seen.
        under = bool({"literal", "full"} & set(key)) and len(keys) == 2
        looks[key] = {
            "color": METHOD_COLOURS[method] if method else COLOURS[i % len(COLOURS)],
            "marker": "o" if under else MARKERS[i % len(MARKERS)],
            "linewidth": 4.0 if under else 1.4,
            "markersize": 8.0 if under else 4.5,
            "zorder": 2 if under else 3,
        }
    return looks


def _mark_values(ax: Axes, x: str, values: np.ndarray) -> None:
    """Ticks where the runs are."""
    if x == "M_sph":
        return
    ax.set_xscale("log", base=2)
    ax.xaxis.set_major_locator(FixedLocator(values.tolist()))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
