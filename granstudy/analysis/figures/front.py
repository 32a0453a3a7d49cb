"""The front of speed against error as a figure: a panel a scene."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granstudy.analysis.columns import SYMBOLS
from granstudy.analysis.figures.style import (
    MARKERS,
    METHOD_COLOURS,
    METHODS_FIRST,
    PANEL_HEIGHT,
    WIDTH,
)
from granstudy.analysis.labels import families
from granstudy.study.benchmark.front import fastest_within, on_front
from granstudy.trust.flags import Status

COLUMNS = 2
FRONT = "front: none is faster at that error"
BASELINE = "baseline, and the fastest at its error"
RUN_ERRORS = {
    "largest_temperature_error": r"largest $|T/T_\mathrm{true} - 1|$",
    "largest_a2_error": r"largest $|a_2 - a_{2,\mathrm{true}}|$",
}


def draw_front(tables: Sequence[xr.Dataset]) -> Figure:
    """Draw seconds against error of every run on all threads, a panel a table.

    Parameters
    ----------
    tables : sequence of xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`, of benchmarks with a reference.

    Raises
    ------
    ValueError
        If a table has no errors.
    """
    for table in tables:
        if "front" not in table:
            raise ValueError(
                f"{table.attrs['title']}: has no errors; the experiment needs a reference"
            )
    columns = min(COLUMNS, len(tables))
    rows = -(-len(tables) // columns)
    size = (WIDTH * (1.0 if columns > 1 else 0.75), PANEL_HEIGHT * rows + 1.1)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False)
    shown: set[str] = set()
    for ax, table in zip(axes.flat, tables, strict=False):
        part = table.isel(run=_timed_on_all_threads(table))
        shown |= set(families(part))
        _panel(ax, part)
        if len(tables) > 1:
            ax.set_title(table.attrs["title"])
    for ax in axes.flat[len(tables) :]:
        ax.set_axis_off()
    for ax in axes[-1]:
        ax.set_xlabel(SYMBOLS["error"])
    for ax in axes[:, 0]:
        ax.set_ylabel(SYMBOLS["seconds"])
    handles = [*_handles(shown), Line2D([], [], label=BASELINE, **_ring())]
    figure.legend(handles=handles, loc="outside lower center", ncols=3 if columns > 1 else 2)
    return figure


def draw_run_front(table: xr.Dataset) -> Figure:
    """Draw how long runs took against their errors of T and of a2, a panel each.

    Parameters
    ----------
    table : xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`, of runs beside a truth, with their seconds.

    Raises
    ------
    ValueError
        If the table does not have the seconds.
    """
    if "seconds" not in table:
        raise ValueError(f"{table.attrs['title']}: a front needs table.seconds: true")
    table = table.isel(run=np.flatnonzero(table["status"] == Status.OK))
    figure = Figure(figsize=(WIDTH, PANEL_HEIGHT + 0.9), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    seconds = table["seconds"].values
    for ax, (measure, label) in zip(axes, RUN_ERRORS.items(), strict=True):
        error = table[measure].values
        _lines(ax, families(table), error, seconds, on_front(seconds, error))
        ax.set_xlabel(label)
    axes[0].set_ylabel("time of the run (s)")
    figure.legend(handles=_handles(set(families(table))), loc="outside lower center", ncols=4)
    return figure


def _timed_on_all_threads(table: xr.Dataset) -> list[int]:
    """Runs on the most threads that have numbers."""
    most = table["threads"] == table["threads"].max()
    return np.flatnonzero((most & np.isfinite(table["error"])).values).tolist()


def _panel(ax: Axes, table: xr.Dataset) -> None:
    """Draw the runs of a scene, the front through them, and what the baseline is beaten by."""
    error, seconds = table["error"].values, table["seconds"].values
    _lines(ax, families(table), error, seconds, table["front"].values)
    _mark_baseline(ax, table)


def _lines(
    ax: Axes, names: list[str], error: np.ndarray, seconds: np.ndarray, best: np.ndarray
) -> None:
    """Draw a line for each family, and the front through the best runs."""
    family = np.array(names)
    for name in sorted(set(family), key=lambda name: METHODS_FIRST[name]):
        own = np.flatnonzero(family == name)
        order = own[np.argsort(error[own])]
        ax.plot(error[order], seconds[order], linewidth=0.8, **_look(name))
    front = np.flatnonzero(best)
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


def _look(name: str) -> dict[str, Any]:
    marker = MARKERS[METHODS_FIRST[name] % len(MARKERS)]
    return {"color": METHOD_COLOURS[name], "marker": marker, "markersize": 5.0, "zorder": 3}


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


def _handles(shown: set[str]) -> list[Line2D]:
    """Legend: the methods shown, the front."""
    names = sorted(shown, key=lambda name: METHODS_FIRST[name])
    handles = [Line2D([], [], label=name, linewidth=0.8, **_look(name)) for name in names]
    handles.append(Line2D([], [], label=FRONT, **_front_look()))
    return handles
