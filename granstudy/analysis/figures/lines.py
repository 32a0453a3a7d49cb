"""Runs as lines of a figure: which belong together, their look, their names."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.style import COLOURS, FAMILY_COLOURS, LABELS, MARKERS
from granstudy.analysis.groups import groups, keys, values_of
from granstudy.analysis.labels import PAPERS_OWN

Line = tuple[str, ...]
"""Values of the parameters that tell a line from others."""


def check_one_exponent(kind: str, table: xr.Dataset) -> None:
    """Raise ValueError unless all runs have one exponent, as their law is drawn once."""
    if np.unique(values_of(table, "exponent")).size != 1:
        raise ValueError(f"figure.kind={kind!r}: shows one exponent; give each its own experiment")


def distinguishing(table: xr.Dataset, names: Sequence[str]) -> list[str]:
    """Find the parameters that are needed to tell the lines apart."""
    kept = [name for name in names if name not in ("N_theta", "N_phi")]
    # What says least is left out first.
    for name in sorted(kept, key=lambda name: (name != "dt", name != "method")):
        fewer = [other for other in kept if other != name]
        if len(groups(keys(table, fewer))) == len(groups(keys(table, kept))):
            kept = fewer
    return kept


def lines(table: xr.Dataset, names: Sequence[str]) -> Iterator[tuple[Line, xr.Dataset]]:
    """Group runs with equal values of ``names``, by these values."""
    for key, members in groups(keys(table, names)).items():
        yield tuple(map(str, key)), table.isel(run=members)


def label(line: Line, names: Sequence[str]) -> str:
    """Name of a line in a legend: words, and numbers with the symbols of their parameters."""
    return ", ".join(
        f"{symbol(name)} = {value}" if _is_number(value) else LABELS.get(value, value)
        for name, value in zip(names, line, strict=True)
    )


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def looks(found: Sequence[Line]) -> dict[Line, dict[str, Any]]:
    """Colour, marker and width of every line."""
    styles: dict[Line, dict[str, Any]] = {}
    for i, line in enumerate(found):
        colours = [FAMILY_COLOURS[value] for value in line if value in FAMILY_COLOURS]
        # The paper's own line lies under ours, wide and pale, so that both are seen.
        under = bool(set(PAPERS_OWN) & set(line)) and len(found) == 2
        styles[line] = {
            "color": colours[0] if colours else COLOURS[i % len(COLOURS)],
            "marker": "o" if under else MARKERS[i % len(MARKERS)],
            "linewidth": 4.0 if under else 1.4,
            "markersize": 8.0 if under else 4.5,
            "zorder": 2 if under else 3,
        }
    return styles


def mark_values(ax: Axes, x: str, values: Sequence[float]) -> None:
    """Put ticks where the runs are."""
    if x == "M_sph":
        return
    ax.set_xscale("log", base=2)
    ax.xaxis.set_major_locator(FixedLocator(list(values)))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
