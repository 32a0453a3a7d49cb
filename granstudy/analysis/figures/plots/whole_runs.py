"""Errors of the answer over the seconds of whole runs: a column of panels a gas, a row T and a row a2."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.plots.marks import mark, trust_handles
from granstudy.analysis.figures.style import (
    PANEL_HEIGHT,
    WIDTH,
    FamilyStyle,
    Picture,
    family_styles,
)
from granstudy.analysis.groups import values_of
from granstudy.analysis.labels import ASKED, families
from granstudy.analysis.tables.truth import KNOWN_TO
from granstudy.study.benchmark.front import on_front
from granstudy.trust.flags import Status

RUN_ERRORS = ("largest_temperature_error", "largest_a2_error")
"""Errors of runs beside a truth, a row of panels each."""

COLUMN_WIDTH, ROW_HEIGHT = 2.5, 2.3
"""Size of a panel beside others, in inches."""

FRONT = "front: no run is faster at that error"
FRONT_LOOK: dict[str, Any] = {
    "color": "0.85",
    "linewidth": 4.0,
    "solid_capstyle": "round",
    "zorder": 1,
}

KNOWN = "how well the truth is known"
KNOWN_LOOK: dict[str, Any] = {"color": "0.4", "linewidth": 0.9, "linestyle": ":", "zorder": 2}

ASKED_STYLE = FamilyStyle("black", "o", -1)
"""Look of the runs that were asked for an accuracy: the one line among marks."""

MARKERS = {"fast, rtol": "v", "dsmc": "X"}
"""Markers of families that would have the circle of those that were asked for."""

HALO = [withStroke(linewidth=1.5, foreground="white")]
"""What keeps a text readable on a line."""

NAMES = {ASKED: "accuracy asked: grid, method, steps chosen"}
"""Names of families in the legend, where they are not their own."""


def check_seconds(tables: Iterable[xr.Dataset]) -> None:
    """Raise ValueError unless all tables are of runs beside a truth, with their seconds."""
    for table in tables:
        title = table.attrs["title"]
        if "truth" not in table.attrs:
            raise ValueError(f"{title}: has no truth; the front beside it is of runs with one")
        if "seconds" not in table:
            raise ValueError(f"{title}: a front needs table.seconds: true")


def run_front(tables: Sequence[xr.Dataset]) -> Figure:
    """Draw errors of T and of a2 over the wall time of whole runs.

    Gases stand side by side, T above a2; one gas alone has both panels side by side. Accuracies that were
    asked for stand beside the points of T. Runs that ended early are left out.

    Parameters
    ----------
    tables : sequence of xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`, of runs beside a truth, with their seconds.

    Raises
    ------
    ValueError
        If a table does not have truth and seconds.
    """
    check_seconds(tables)
    parts = [table.isel(run=np.flatnonzero(table["status"] == Status.OK)) for table in tables]
    styles = _styles(name for part in parts for name in families(part))
    figure, axes = _panels(len(tables))
    for column, part in zip(axes.T, parts, strict=True):
        for ax, measure in zip(column, RUN_ERRORS, strict=True):
            _draw(ax, part, measure, styles)
        _say_asked(column[0], part)
        if len(tables) > 1:
            column[0].set_title(part.attrs["title"])
    shown = [
        _draw_known(ax, part.attrs.get(name, 0.0))
        for row, name in zip(axes, KNOWN_TO, strict=True)
        for ax, part in zip(row, parts, strict=True)
    ]
    handles = _handles(styles, any(shown)) + trust_handles(part["trust"].values for part in parts)
    figure.legend(handles=handles, loc="outside lower center", ncols=max(3, len(tables)))
    return figure


def _panels(gases: int) -> tuple[Figure, np.ndarray]:
    """A figure, and its panels as (measure, gas)."""
    if gases == 1:
        figure = Picture(figsize=(WIDTH, PANEL_HEIGHT + 0.9), layout="constrained")
        axes = figure.subplots(1, 2, sharex=True, squeeze=False).T
    else:
        size = (COLUMN_WIDTH * gases, ROW_HEIGHT * len(RUN_ERRORS) + 1.0)
        figure = Picture(figsize=size, layout="constrained")
        axes = figure.subplots(len(RUN_ERRORS), gases, sharex=True, sharey="row", squeeze=False)
    for ax in axes.flat if gases == 1 else axes[-1]:
        ax.set_xlabel("time of the run (s)")
    for ax, measure in zip(axes[:, 0], RUN_ERRORS, strict=True):
        ax.set_ylabel(symbol(measure))
    for ax in axes.flat:
        ax.set(xscale="log", yscale="log")
    return figure, axes


def _draw(ax: Axes, table: xr.Dataset, measure: str, styles: dict[str, FamilyStyle]) -> None:
    """Draw the marks of each family, the line of those that were asked for, and the front."""
    seconds, error = table["seconds"].values, table[measure].values
    family, trust = np.array(families(table)), table["trust"].values
    for name, style in styles.items():
        own = np.flatnonzero(family == name)
        if name == ASKED:
            own = own[np.argsort(values_of(table, ASKED)[own])]
            ax.plot(seconds[own], error[own], color=style.colour, linewidth=1.4, zorder=3)
        mark(ax, seconds[own], error[own], trust[own], _look(style))
    best = np.flatnonzero(on_front(seconds, error))
    best = best[np.argsort(seconds[best])]
    ax.plot(seconds[best], error[best], drawstyle="steps-post", **FRONT_LOOK)


def _draw_known(ax: Axes, known: float) -> bool:
    """Draw how well the truth is known, where that is within the panel; returns whether it is."""
    low, high = ax.get_ylim()
    if not low < known < high:
        return False
    ax.axhline(known, **KNOWN_LOOK)
    ax.set_ylim(low, high)
    return True


def _say_asked(ax: Axes, table: xr.Dataset) -> None:
    """Write the accuracy that was asked for beside its run."""
    error, seconds = table[RUN_ERRORS[0]].values, table["seconds"].values
    asked = values_of(table, ASKED, -1.0)
    for i in np.flatnonzero(asked > 0):
        ax.annotate(
            _power(float(asked[i])),
            (seconds[i], error[i]),
            (5, 2),
            textcoords="offset points",
            fontsize=8.0,
            path_effects=HALO,
            zorder=5,
        )


def _power(value: float) -> str:
    """An accuracy as a power of ten, with a factor where it is none."""
    factor, exponent = f"{value:.1e}".split("e")
    power = f"10^{{{int(exponent)}}}"
    return f"${power}$" if factor == "1.0" else rf"${float(factor):g}\times {power}$"


def _styles(names: Iterable[str]) -> dict[str, FamilyStyle]:
    """Looks of the families, those that were asked for first."""
    shown = set(names)
    asked = {ASKED: ASKED_STYLE} if ASKED in shown else {}
    others = family_styles(shown - {ASKED})
    return asked | {
        name: replace(style, marker=MARKERS.get(name, style.marker))
        for name, style in others.items()
    }


def _look(style: FamilyStyle) -> dict[str, Any]:
    return {"color": style.colour, "marker": style.marker, "markersize": 5.0, "zorder": 4}


def _handles(styles: dict[str, FamilyStyle], known: bool) -> list[Line2D]:
    """Legend: the families shown, the front, the truth."""
    handles = [
        Line2D(
            [],
            [],
            label=NAMES.get(name, name),
            linestyle="-" if name == ASKED else "none",
            **_look(style),
        )
        for name, style in styles.items()
    ]
    handles.append(Line2D([], [], label=FRONT, **FRONT_LOOK))
    return handles + [Line2D([], [], label=KNOWN, **KNOWN_LOOK)] * known
