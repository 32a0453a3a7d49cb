"""Kurtosis of cooling and heated states against e, and its distance from theory or particles."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.lines import check_one_exponent
from granstudy.analysis.figures.plots.marks import line_opacity, mark, trust_handles
from granstudy.analysis.figures.style import (
    COLOURS,
    MARKERS,
    PANEL_HEIGHT,
    WIDTH,
    Picture,
    family_styles,
)
from granstudy.analysis.groups import Key, groups, keys
from granstudy.analysis.labels import families
from granstudy.analysis.source import FigureSource
from granstudy.analysis.tables.states import theory_a2

THEORIES = {
    "a2_linear": ("linear theory (van Noije & Ernst)", "--"),
    "a2_divided": ("divided by $1 + a_2$ (Montanero & Santos)", ":"),
    "a2_exact": ("exact moments", "-"),
}
"""Label and line style of theories by the table's column."""

UNIT = 1e-3
"""Differences from particles are drawn in this unit."""

ASKED = 1e-4
"""Error that states of Maxwell molecules have to fall below from e = 0.5 on."""


def check_states(source: FigureSource) -> None:
    """Raise ValueError unless each table is one of states, swept over e, at one exponent."""
    for table in (source.table, *source.beside):
        if "state" not in table.attrs or "e" not in table.attrs["swept"].split():
            raise ValueError(f"{table.attrs['title']}: is no table of states swept over e")
        check_one_exponent("states", table)


def draw_states(source: FigureSource) -> Figure:
    """Draw a2 against e, a column a table; below, where a table has it, particles less a2 or a2's error."""
    tables = [source.table, *source.beside]
    compared = any("a2_error" in table or _beside(table) for table in tables)
    ratios = [3, 2] if compared else [3]
    height = 0.35 * sum(ratios) * PANEL_HEIGHT + 0.9
    figure = Picture(figsize=(WIDTH, height), layout="constrained")
    axes = figure.subplots(
        len(ratios), len(tables), squeeze=False, sharex="col", height_ratios=ratios
    )
    for (upper, *below), table in zip(axes.T, tables, strict=True):
        exact = "a2_error" in table
        _theories(upper, table)
        for part, look in _groups(table):
            _states(upper, part, "a2", look)
        upper.set_title(table.attrs["title"])
        upper.set_ylabel(symbol("a2"))
        (below or [upper])[-1].set_xlabel(symbol("e"))
        if not below:
            continue
        (lower,) = below
        if exact:
            for part, look in _groups(table):
                _states(lower, part, "a2_error", look)
        _particles(upper, lower, table)
        if exact:
            lower.axhline(ASKED, color="0.6", linewidth=0.8, linestyle="--")
            lower.set(yscale="log", ylabel=symbol("a2_error"))
        else:
            lower.axhline(0.0, color="0.6", linewidth=0.8)
            lower.set_ylabel(f"particles $-\\ a_2$, in $10^{{{np.log10(UNIT):.0f}}}$")
    labelled = {
        label: handle
        for ax in axes[0]
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    handles = [*labelled.values(), *trust_handles(table["trust"].values for table in tables)]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 3))
    return figure


def _theories(ax: Axes, table: xr.Dataset) -> None:
    """Draw the theories that the table has columns of."""
    state, dim, exponent = table.attrs["state"], table.attrs["dim"], float(table["exponent"])
    e = np.linspace(0.0, 1.0, 201)[:-1]
    for name, (label, style) in THEORIES.items():
        if name in table:
            a2 = [theory_a2(name, state, value, dim, exponent) for value in e]
            ax.plot(e, a2, style, color="0.45", linewidth=1.2, label=label, zorder=1)


def _groups(table: xr.Dataset) -> list[tuple[xr.Dataset, dict[str, Any]]]:
    """Runs that differ in e (and ε) alone, and their look."""
    names = [name for name in table.attrs["swept"].split() if name not in ("e", "diffusion")]
    if not names:
        (family,) = set(families(table))
        colour = family_styles([family])[family].colour
        return [(table, {"color": colour, "marker": "o", "label": "solved for"})]
    found = groups(keys(table, names))
    return [
        (table.isel(run=members), {"color": colour, "marker": marker, "label": _label(names, key)})
        for (key, members), colour, marker in zip(found.items(), cycle(COLOURS), cycle(MARKERS))
    ]


def _label(names: Sequence[str], key: Key) -> str:
    return ", ".join(
        value if isinstance(value, str) else f"{symbol(name)} = {value:g}"
        for name, value in zip(names, key, strict=True)
    )


def _states(ax: Axes, part: xr.Dataset, name: str, look: dict[str, Any]) -> None:
    """Draw a line through the states, with markers that tell their labels."""
    part = part.sortby("e")
    e, y, trust = part["e"].values, part[name].values, part["trust"].values
    # The legend shows the marker that `mark` puts on the points.
    ax.plot(e, y, markersize=4.5, markevery=[], alpha=line_opacity(trust), zorder=2, **look)
    mark(ax, e, y, trust, {"markersize": 4.5, "zorder": 3} | look)


def _beside(table: xr.Dataset) -> list[str]:
    """Experiments of particles that stand beside the states of a table."""
    return [n for n in table.attrs.get("beside", "").split() if f"a2_{n}_standard_error" in table]


def _particles(upper: Axes, lower: Axes, table: xr.Dataset) -> None:
    """Draw the particles' numbers, with two standard errors either way."""
    for name in _beside(table):
        bars = 2.0 * table[f"a2_{name}_standard_error"]
        look: dict[str, Any] = {"color": "black", "linestyle": "none", "marker": "_", "zorder": 4}
        look |= {"capsize": 2.5, "elinewidth": 0.9, "markersize": 5.0}
        label = "particles, ± 2 standard errors"
        upper.errorbar(table["e"], table[f"a2_{name}"], bars, label=label, **look)
        lower.errorbar(table["e"], table[f"a2_{name}_difference"] / UNIT, bars / UNIT, **look)
