"""The map of a study as a figure: cases down, configurations across, cells coloured by label."""

from textwrap import fill
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from granstudy.analysis.figures.style import STYLE, Picture
from granstudy.analysis.groups import groups, keys
from granstudy.analysis.tables.map import rule_line
from granstudy.trust.flags import flag_word

LABEL_COLOURS = {"trusted": "#A8DDB5", "marginal": "#FDE7A0", "untrusted": "#F4A6A0"}
"""Colours light enough for black numbers, which say the same to readers who see no colours."""

ERRORS = ("largest_temperature_error", "largest_a2_error")
"""Numbers of a cell."""

CELL_WIDTH = 2.9
LINE_HEIGHT = 0.27
"""Width of a column and height of a run, in inches."""

LETTERS_AN_INCH = 14
"""Letters of the title that fit into an inch."""

LETTERS = 52
"""Letters that fit into a cell; longer texts take two lines, in smaller type."""


def draw_map(table: xr.Dataset) -> Figure:
    """Draw a map: a line "error of T | error of a2" for each run, in the cell of its case and configuration.

    Parameters
    ----------
    table : xarray.Dataset
        From `granstudy.analysis.tables.map.label_map`.
    """
    cases = list(dict.fromkeys(table["case"].values))
    columns = sorted(set(table["configuration"].values))
    place = {name: i for i, name in enumerate(columns)}
    cells = groups(keys(table, ["case", "configuration"]))
    heights = [max(len(cells.get((case, c), [])) for c in columns) for case in cases]
    tops = np.cumsum([0, *heights])
    with mpl.rc_context(STYLE):
        size = (2.3 + CELL_WIDTH * len(columns), 1.5 + LINE_HEIGHT * tops[-1])
        figure = Picture(figsize=size, layout="constrained")
        ax = figure.subplots()
        for (case, column), members in cells.items():
            row = cases.index(case)
            each = heights[row] / len(members)
            for number, i in enumerate(members):
                _line(ax, table.isel(run=i), place[column], tops[row] + number * each, each)
        for top in tops:
            ax.axhline(top, color="0.4", linewidth=0.6, zorder=3)
        ax.set(xlim=(0, len(columns)), ylim=(tops[-1], 0))
        ax.set_xticks(np.arange(len(columns)) + 0.5, columns)
        ax.set_yticks((tops[:-1] + tops[1:]) / 2, [case.replace("_", " ") for case in cases])
        ax.xaxis.tick_top()
        ax.tick_params(length=0)
        ax.grid(False)
        handles = [Patch(color=colour, label=name) for name, colour in LABEL_COLOURS.items()]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
        told = fill(
            f"largest errors of T (relative) and of a2. {rule_line(table)}",
            int(LETTERS_AN_INCH * size[0]),
        )
        figure.suptitle(f"{table.attrs['title']}\n{told}", fontsize=9)
    return figure


def _line(ax: Axes, row: xr.Dataset, x: float, y: float, height: float) -> None:
    """One run: its errors on its label's colour, framed where the label is wrong."""
    wrong = bool(row["wrong"])
    ax.add_patch(
        Rectangle(
            (x, y), 1.0, height,
            facecolor=LABEL_COLOURS[flag_word("trust", row["trust"])],
            edgecolor="red" if wrong else "white",
            linewidth=2.0 if wrong else 0.8,
            zorder=2 if wrong else 1,
        )
    )  # fmt: skip
    numbers = " | ".join(f"{float(row[name]):.0e}" for name in ERRORS)
    variation = str(row["variation"].item())
    fits = len(variation) + len(numbers) < LETTERS
    text = f"{variation}:  {numbers}" if fits else f"{variation}:\n{numbers}"
    look: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 4, "linespacing": 1.0}
    ax.text(x + 0.5, y + height / 2, text, fontsize=7.5 if fits else 6.0, **look)
