"""An error against a refined parameter."""

import itertools

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granstudy.analysis.columns import SYMBOLS
from granstudy.analysis.figures.lines import _distinguishing, _label, _lines, _looks, _mark_values
from granstudy.analysis.figures.style import (
    PANEL_HEIGHT,
    PAPER,
    PAPER_LOOK,
    WIDTH,
)


def _convergence(table: xr.Dataset, x: str | None) -> Figure:
    """Draw the quantity against the refined parameter, a column of panels for each e.

    Where methods and variants both differ, there is a row of panels for each variant.
    """
    swept = table.attrs["swept"].split()
    if x is None or x not in swept:
        raise ValueError(f"figure.x={x!r}: must be one of the swept parameters {swept}")
    names = _distinguishing(table, [name for name in swept if name not in (x, "e")])
    down = "variant" if {"variant", "method"} <= set(names) else None
    names = [name for name in names if name != down]
    columns, rows = _panels(table, "e"), _panels(table, down)
    width = WIDTH if len(columns) > 1 else 0.75 * WIDTH
    size = (width, PANEL_HEIGHT * (1.0 if len(rows) == 1 else 0.85) * len(rows) + 0.9)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
    looks = _looks([key for key, _ in _lines(table, names)])
    for ax, (row, column) in zip(axes.flat, itertools.product(rows, columns), strict=True):
        part = table.isel(run=sorted(set(row[1]) & set(column[1])))
        for key, unsorted in _lines(part, names):
            line = unsorted.sortby(x)
            ax.plot(line[x], line[table.attrs["quantity"]], **looks[key])
        _draw_paper(ax, part, x)
        if x == "dt":
            _order_guide(ax, part, x)
        if column[0] or row[0]:
            ax.set_title(", ".join(filter(None, (column[0], row[0]))))
        ax.set_yscale("log")
        _mark_values(ax, x, np.unique(table[x]))
    _label_outer(axes, x, table.attrs["quantity"])
    handles = [
        Line2D([], [], label=_label(key) or str(table["method"].values.flat[0]), **look)
        for key, look in looks.items()
    ]
    if _paper_is_drawn(table):
        handles.append(Line2D([], [], label=PAPER, **PAPER_LOOK))
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 3))
    return figure


def _label_outer(axes: np.ndarray, x: str, quantity: str) -> None:
    for ax in axes[-1]:
        ax.set_xlabel(SYMBOLS.get(x, x))
    for ax in axes[:, 0]:
        ax.set_ylabel(SYMBOLS.get(quantity, quantity))


def _panels(table: xr.Dataset, name: str | None) -> list[tuple[str, list[int]]]:
    """Title and runs of the panels for each value of a parameter, or one panel of all runs."""
    if name is None or name not in table.attrs["swept"].split():
        return [("", list(range(table.sizes["run"])))]
    return [
        (
            f"{SYMBOLS[name]} = {value}" if name == "e" else str(value),
            np.flatnonzero(table[name] == value).tolist(),
        )
        for value in np.unique(table[name])
    ]


def _paper_is_drawn(table: xr.Dataset) -> bool:
    return "paper" in table and table.attrs["paper_quantity"] == table.attrs["quantity"]


def _draw_paper(ax: Axes, part: xr.Dataset, x: str) -> None:
    """Draw the printed numbers, open and black around ours."""
    if _paper_is_drawn(part):
        ax.plot(part[x], part["paper"], **PAPER_LOOK)


def _order_guide(ax: Axes, part: xr.Dataset, x: str, order: int = 3) -> None:
    """Draw a grey line of slope 3, the order of the Runge–Kutta scheme, below the data."""
    ends = np.array([part[x].min().item(), part[x].max().item()])
    scale = np.nanmin(part[part.attrs["quantity"]] / part[x] ** order).item() / 2.5
    ax.plot(ends, scale * ends**order, color="0.45", linewidth=1.0, zorder=1)
    middle = np.sqrt(ends.prod())
    text = rf"$\propto \Delta t^{order}$"
    ax.annotate(
        text, (middle, scale * middle**order), (4, -10), textcoords="offset points", color="0.35"
    )
