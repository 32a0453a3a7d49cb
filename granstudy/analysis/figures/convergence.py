"""An error against a refined parameter."""

import itertools

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.lines import distinguishing, label, lines, looks, mark_values
from granstudy.analysis.figures.plots.marks import line_opacity, mark, trust_handles
from granstudy.analysis.figures.plots.scales import number_scale, set_scale
from granstudy.analysis.figures.style import PANEL_HEIGHT, PAPER, PAPER_LOOK, WIDTH, Picture
from granstudy.analysis.groups import check_numbers, check_swept, groups, keys
from granstudy.analysis.source import FigureSource
from granstudy.trust.flags import Trust

MOST_PANELS = 4
"""Values of e up to which each has a panel."""

ORDER = 3
"""Order of the Runge–Kutta scheme, which the guide beside refined steps shows."""


def _abscissa(source: FigureSource) -> str:
    """The swept parameter on the abscissa."""
    if source.asked.x is None:
        raise ValueError(
            "figure.x: must be given; a convergence figure is drawn over a swept parameter"
        )
    return check_swept("figure.x", source.asked.x, source.table)


def check_convergence(source: FigureSource) -> None:
    """Raise ValueError unless the figure has an abscissa of numbers; e has a panel for each value."""
    x = _abscissa(source)
    check_numbers("figure.x", x, source.table)
    if x == "e":
        raise ValueError(
            "figure.x='e': has a panel for each value; give a parameter that is refined"
        )


def draw_convergence(source: FigureSource) -> Figure:
    """Draw the quantity against the refined parameter, a column of panels for each e.

    Where methods and variants both differ, there is a row of panels for each variant.
    """
    table, x = source.table, _abscissa(source)
    swept = table.attrs["swept"].split()
    # Many e have a line each, in place of a panel each.
    across = "e" if "e" in swept and np.unique(table["e"].values).size <= MOST_PANELS else None
    names = distinguishing(table, [name for name in swept if name not in (x, across)])
    down = "variant" if {"variant", "method"} <= set(names) else None
    names = [name for name in names if name != down]
    columns, rows = _panels(table, across), _panels(table, down)
    width = WIDTH if len(columns) > 1 else 0.75 * WIDTH
    size = (width, PANEL_HEIGHT * (1.0 if len(rows) == 1 else 0.85) * len(rows) + 0.9)
    figure = Picture(figsize=size, layout="constrained")
    axes = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
    styles = looks([line for line, _ in lines(table, names)])
    values = [table[table.attrs["quantity"]].values]
    scale = "log" if np.nanmin(values) > 0.0 else number_scale(values)
    for ax, (row, column) in zip(axes.flat, itertools.product(rows, columns), strict=True):
        part = table.isel(run=sorted(set(row[1]) & set(column[1])))
        for line, unsorted in lines(part, names):
            runs = unsorted.sortby(x)
            look, y = styles[line], runs[table.attrs["quantity"]].values
            trust = runs["trust"].values if "trust" in runs else np.full(y.size, Trust.TRUSTED)
            drawn = {k: v for k, v in look.items() if k not in ("marker", "markersize")}
            ax.plot(runs[x], y, **drawn, alpha=line_opacity(trust))
            mark(ax, runs[x].values, y, trust, look)
        if _paper_is_drawn(part):
            ax.plot(part[x], part["paper"] / part["paper"].attrs.get("factor", 1.0), **PAPER_LOOK)
        if x == "dt":
            _order_guide(ax, part, x)
        if column[0] or row[0]:
            ax.set_title(", ".join(filter(None, (column[0], row[0]))))
        set_scale(ax, "y", scale, values)
        mark_values(ax, x, np.unique(table[x]).tolist())
    _label_outer(axes, x, table.attrs["quantity"])
    handles = [
        Line2D([], [], label=label(line, names) or str(table["method"].values.flat[0]), **style)
        for line, style in styles.items()
    ]
    if _paper_is_drawn(table):
        handles.append(Line2D([], [], label=PAPER, **PAPER_LOOK))
    if "trust" in table:
        handles += trust_handles([table["trust"].values])
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 3))
    return figure


def _panels(table: xr.Dataset, name: str | None) -> list[tuple[str, list[int]]]:
    """Title and runs of the panels for each value of a parameter, or one panel of all runs."""
    if name is None or name not in table.attrs["swept"].split():
        return [("", list(range(table.sizes["run"])))]
    title = f"{symbol(name)} = " if name == "e" else ""
    members = groups(keys(table, [name]))
    return [(f"{title}{value}", members[value,]) for (value,) in sorted(members)]


def _label_outer(axes: np.ndarray, x: str, quantity: str) -> None:
    for ax in axes[-1]:
        ax.set_xlabel(symbol(x))
    for ax in axes[:, 0]:
        ax.set_ylabel(symbol(quantity))


def _paper_is_drawn(table: xr.Dataset) -> bool:
    return "paper" in table and table.attrs["paper_quantity"] == table.attrs["quantity"]


def _order_guide(ax: Axes, part: xr.Dataset, x: str) -> None:
    """Draw a grey line of slope `ORDER` below the data."""
    ends = np.array([part[x].min().item(), part[x].max().item()])
    scale = np.nanmin(part[part.attrs["quantity"]] / part[x] ** ORDER).item() / 2.5
    ax.plot(ends, scale * ends**ORDER, color="0.45", linewidth=1.0, zorder=1)
    middle = np.sqrt(ends.prod())
    ax.annotate(
        rf"$\propto \Delta t^{ORDER}$",
        (middle, scale * middle**ORDER),
        (4, -10),
        textcoords="offset points",
        color="0.35",
    )
