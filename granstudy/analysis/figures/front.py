"""The front of speed against error: of evaluations of Q a panel a scene; of whole runs see `run_front`."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.plots.whole_runs import check_seconds, run_front
from granstudy.analysis.figures.style import (
    PANEL_HEIGHT,
    WIDTH,
    FamilyStyle,
    Picture,
    family_styles,
)
from granstudy.analysis.labels import families
from granstudy.analysis.source import FigureSource
from granstudy.study.benchmark.front import fastest_within

COLUMNS = 2
"""Panels side by side."""

FRONT = "front: none is faster at that error"
BASELINE = "baseline, and the fastest at its error"


def check_front(source: FigureSource) -> None:
    """Raise ValueError unless the tables have what a front shows: seconds, errors, and one baseline each."""
    (check_seconds if "truth" in source.table.attrs else _check_errors)(_tables(source))


def _tables(source: FigureSource) -> list[xr.Dataset]:
    return [source.table, *source.beside]


def _check_errors(tables: Sequence[xr.Dataset]) -> None:
    for table in tables:
        if "front" not in table:
            raise ValueError(
                f"{table.attrs['title']}: has no errors; a front needs a benchmark with a reference, or an "
                "evolution with a truth and table.seconds: true"
            )
        count = int(np.sum(table["baseline"] & (table["threads"] == table["threads"].max())))
        if count != 1:
            raise ValueError(
                f"{table.attrs['title']}: has {count} baselines; a front needs one: give timing.baseline"
            )


def draw_front(source: FigureSource) -> Figure:
    """Draw a front: of evaluations of Q, or of whole runs where the table has a truth; others beside it."""
    draw = run_front if "truth" in source.table.attrs else benchmark_front
    return draw(_tables(source))


def benchmark_front(tables: Sequence[xr.Dataset]) -> Figure:
    """Draw seconds against error of every run on all threads, a panel a table.

    Parameters
    ----------
    tables : sequence of xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`, of benchmarks with a reference.

    Raises
    ------
    ValueError
        If a table has no errors, or not one baseline.
    """
    _check_errors(tables)
    columns = min(COLUMNS, len(tables))
    rows = -(-len(tables) // columns)
    size = (WIDTH * (1.0 if columns > 1 else 0.75), PANEL_HEIGHT * rows + 1.1)
    figure = Picture(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    parts = [table.isel(run=_timed_on_all_threads(table)) for table in tables]
    styles = family_styles(name for part in parts for name in families(part))
    for ax, table, part in zip(axes.flat, tables, parts, strict=False):
        _lines(ax, part, styles)
        _mark_baseline(ax, part)
        if len(tables) > 1:
            ax.set_title(table.attrs["title"])
    for ax in axes.flat[len(tables) :]:
        ax.set_axis_off()
    for ax in axes[-1]:
        ax.set_xlabel(symbol("error"))
    for ax in axes[:, 0]:
        ax.set_ylabel(symbol("seconds"))
    handles = [*_handles(styles), Line2D([], [], label=BASELINE, **_ring())]
    figure.legend(handles=handles, loc="outside lower center", ncols=3 if columns > 1 else 2)
    return figure


def _timed_on_all_threads(table: xr.Dataset) -> list[int]:
    """Runs on the most threads that have numbers."""
    most = table["threads"] == table["threads"].max()
    return np.flatnonzero((most & np.isfinite(table["error"])).values).tolist()


def _lines(ax: Axes, table: xr.Dataset, styles: dict[str, FamilyStyle]) -> None:
    """Draw a line for each family, and the front through the best runs."""
    error, seconds, family = (
        table["error"].values,
        table["seconds"].values,
        np.array(families(table)),
    )
    for name, style in styles.items():
        own = np.flatnonzero(family == name)
        order = own[np.argsort(error[own])]
        if own.size:
            ax.plot(error[order], seconds[order], linewidth=0.8, **_look(style))
    front = np.flatnonzero(table["front"].values)
    front = front[np.argsort(error[front])]
    ax.plot(error[front], seconds[front], drawstyle="steps-post", **_front_look())
    ax.set(xscale="log", yscale="log")


def _mark_baseline(ax: Axes, table: xr.Dataset) -> None:
    """Ring the baseline, and point from it to the fastest run that is no less exact."""
    (base,) = np.flatnonzero(table["baseline"].values)
    error, seconds = table["error"].values, table["seconds"].values
    ax.plot(error[base], seconds[base], **_ring())
    best = fastest_within(seconds, error, float(error[base]))
    if best is None or best == base:
        return
    # Straight down: both lie on or to the left of the line of the baseline's error.
    ax.annotate(
        "",
        (error[base], seconds[best]),
        (error[base], seconds[base]),
        arrowprops={"arrowstyle": "->", "color": "0.25", "linewidth": 1.0, "shrinkA": 6.0},
    )
    middle = np.sqrt(seconds[base] * seconds[best])
    text = f"{float(f'{seconds[base] / seconds[best]:.3g}'):,g}×"
    ax.annotate(
        text,
        (error[base], middle),
        (4, 0),
        textcoords="offset points",
        color="0.25",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
    )


def _look(style: FamilyStyle) -> dict[str, Any]:
    return {"color": style.colour, "marker": style.marker, "markersize": 5.0, "zorder": 3}


def _front_look() -> dict[str, Any]:
    return {"color": "0.75", "linewidth": 4.0, "solid_capstyle": "round", "zorder": 1}


def _ring() -> dict[str, Any]:
    return {
        "color": "black",
        "linestyle": "none",
        "marker": "o",
        "markersize": 11.0,
        "markerfacecolor": "none",
        "zorder": 4,
    }


def _handles(styles: dict[str, FamilyStyle]) -> list[Line2D]:
    """Legend: the families shown, the front."""
    handles = [
        Line2D([], [], label=name, linewidth=0.8, **_look(style)) for name, style in styles.items()
    ]
    return [*handles, Line2D([], [], label=FRONT, **_front_look())]
