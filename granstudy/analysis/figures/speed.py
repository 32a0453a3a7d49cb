"""Time of an evaluation of Q against N, a line a method."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granstudy.analysis.columns import SYMBOLS
from granstudy.analysis.figures.lines import _lines, _mark_values
from granstudy.analysis.figures.style import (
    METHOD_COLOURS,
    METHODS_FIRST,
    PANEL_HEIGHT,
    PAPER,
    PAPER_LOOK,
    WIDTH,
)
from granstudy.analysis.labels import families


def _speed(table: xr.Dataset) -> Figure:
    """Draw seconds against N for every method, with one thread and with all."""
    figure = Figure(figsize=(WIDTH, PANEL_HEIGHT + 1.0), layout="constrained")
    ax = figure.subplots()
    counts = np.unique(table["threads"]).tolist()
    named = table.assign_coords(method=("run", families(table)))
    for (method, threads), line in _lines(named, ["method", "threads"]):
        all_threads = int(threads) == counts[-1]
        plural = "thread" if threads == "1" else "threads"
        ax.plot(
            line["N"],
            line["seconds"],
            color=METHOD_COLOURS[method],
            linestyle="-" if all_threads else "--",
            marker="o" if all_threads else "s",
            markerfacecolor=METHOD_COLOURS[method] if all_threads else "white",
            label=f"{method}, {threads} {plural}",
        )
    if "paper" in table:
        for name, marker, methods in (("direct", "^", ["direct"]), ("fast", "D", ["literal"])):
            part = table.isel(run=np.flatnonzero(table["method"].isin(methods).values))
            look = PAPER_LOOK | {"marker": marker, "markersize": 8.0}
            ax.plot(part["N"], part["paper"], label=f"{PAPER}, {name}, 10 cores", **look)
    _complexity_guide(ax, table)
    ax.set_yscale("log")
    ax.set(xlabel=SYMBOLS["N"], ylabel=SYMBOLS["seconds"])
    _mark_values(ax, "N", np.unique(table["N"]))
    handles, labels = ax.get_legend_handles_labels()
    # Stable: ours by method, one thread before all, then the paper and the guide.
    order = sorted(range(len(labels)), key=lambda i: METHODS_FIRST.get(labels[i].split(",")[0], 9))
    ax.legend(
        [handles[i] for i in order],
        [labels[i] for i in order],
        loc="center left",
        bbox_to_anchor=(1.01, 0.5),
    )
    return figure


def _complexity_guide(ax: Axes, table: xr.Dataset) -> None:
    """Draw N⁴ log N, the cost of the fast method in 3D, below the fastest line but `radial`'s."""
    table = table.isel(run=np.flatnonzero(table["method"].values != "radial"))
    N = np.unique(table["N"]).astype(float)
    cost = N**4 * np.log(N)
    seconds = np.array([table["seconds"].values[table["N"].values == n].min() for n in N])
    scale = np.min(seconds / cost) / 2.0
    ax.plot(N, scale * cost, color="0.45", linewidth=1.0, label=r"$\propto N^4 \log N$", zorder=1)
