"""Seconds of an evaluation of Q against N, a line a method."""

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.lines import lines, mark_values
from granstudy.analysis.figures.style import (
    PANEL_HEIGHT,
    PAPER,
    PAPER_LOOK,
    WIDTH,
    Picture,
    family_styles,
)
from granstudy.analysis.groups import values_of
from granstudy.analysis.labels import families
from granstudy.analysis.paper.printed import TIMED
from granstudy.analysis.source import FigureSource
from granstudy.model.methods import METHODS

PAPERS_MARKERS = ("^", "D")
"""Markers of the methods that the paper times."""


def check_speed(source: FigureSource) -> None:
    """Raise ValueError unless the runs are timed, some on a Cartesian grid, whose cost is the guide."""
    if source.experiment.run != "benchmark":
        raise ValueError(
            f"figure.kind='speed': shows seconds of benchmark runs, not of {source.experiment.run} runs"
        )
    if source.asked.x not in (None, "N"):
        raise ValueError(f"figure.x={source.asked.x!r}: a speed figure is drawn over N")
    if not _on_cartesian_grids(source.table).any():
        raise ValueError("figure.kind='speed': needs a method on a Cartesian grid, for its guide")


def _on_cartesian_grids(table: xr.Dataset) -> np.ndarray:
    return np.array([not METHODS[name].radial for name in values_of(table, "method").tolist()])


def draw_speed(source: FigureSource) -> Figure:
    """Draw seconds against N for every method, with one thread and with all."""
    table = source.table
    figure = Picture(figsize=(WIDTH, PANEL_HEIGHT + 1.0), layout="constrained")
    ax = figure.subplots()
    most = np.max(table["threads"].values)
    named = table.assign_coords(method=("run", families(table)))
    styles = family_styles(named["method"].values)
    places = []
    for (method, threads), line in lines(named, ["method", "threads"]):
        all_threads, colour = int(threads) == most, styles[method].colour
        plural = "thread" if threads == "1" else "threads"
        ax.plot(
            line["N"],
            line["seconds"],
            color=colour,
            linestyle="-" if all_threads else "--",
            marker="o" if all_threads else "s",
            markerfacecolor=colour if all_threads else "white",
            label=f"{method}, {threads} {plural}",
        )
        places.append(styles[method].place)
    if "paper" in table:
        for (name, ours), marker in zip(TIMED.items(), PAPERS_MARKERS, strict=True):
            part = table.isel(run=np.flatnonzero(table["method"].values == ours[0]))
            look = PAPER_LOOK | {"marker": marker, "markersize": 8.0}
            ax.plot(part["N"], part["paper"], label=f"{PAPER}, {name}, 10 cores", **look)
    _complexity_guide(ax, table)
    ax.set_yscale("log")
    ax.set(xlabel=symbol("N"), ylabel=symbol("seconds"))
    mark_values(ax, "N", np.unique(table["N"]).tolist())
    handles, labels = ax.get_legend_handles_labels()
    # Stable: ours by method, one thread before all, then the paper and the guide.
    places += [max(places) + 1] * (len(labels) - len(places))
    order = np.argsort(places, kind="stable")
    ax.legend(
        [handles[i] for i in order],
        [labels[i] for i in order],
        loc="center left",
        bbox_to_anchor=(1.01, 0.5),
    )
    return figure


def _complexity_guide(ax: Axes, table: xr.Dataset) -> None:
    """Draw N⁴ log N, the cost of the fast method in 3D, below the fastest line on a Cartesian grid."""
    table = table.isel(run=np.flatnonzero(_on_cartesian_grids(table)))
    N = np.unique(table["N"]).astype(float)
    cost = N**4 * np.log(N)
    seconds = np.array([table["seconds"].values[table["N"].values == n].min() for n in N])
    scale = np.min(seconds / cost) / 2.0
    ax.plot(N, scale * cost, color="0.45", linewidth=1.0, label=r"$\propto N^4 \log N$", zorder=1)
