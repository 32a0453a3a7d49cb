"""Labels of axes and lines: a symbol and a unit; the long name goes into the caption."""

from typing import Any

import xarray as xr

from granstudy.analysis.columns import symbol
from granstudy.analysis.labels import parameter_text

TIMES = {"time": "$t$", "snapshot": "$t$", "output": "output", "kept": "output"}
"""Symbols of axes of time."""


def symbol_of(data: xr.DataArray) -> str:
    """The symbol of a variable or coordinate: its own, that of tables, else its name."""
    name = str(data.name)
    return TIMES.get(name) or str(data.attrs.get("symbol") or symbol(name))


def axis_label(data: xr.DataArray) -> str:
    """Symbol, and unit where it has one."""
    units = data.attrs.get("units", "1")
    return symbol_of(data) if units in ("1", "") else f"{symbol_of(data)} ({units})"


def caption(data: xr.DataArray) -> str:
    """The long name of a variable, which says what its symbol is."""
    return str(data.attrs.get("long_name", ""))


def value_label(data: xr.DataArray, value: Any) -> str:
    """Write a value of a coordinate as a legend does: ``e = 0.5``, ``rescaled``."""
    if isinstance(value, str):
        return parameter_text(str(data.name), value, symbol_of(data))
    return f"{symbol_of(data)} = {value:.4g}"
