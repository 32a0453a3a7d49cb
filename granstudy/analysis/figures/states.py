"""Kurtosis of cooling and heated states as a figure: against e, and its distance from theory or particles."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granstudy.analysis.columns import SYMBOLS
from granstudy.analysis.figures.style import COLOURS, MARKERS, METHOD_COLOURS, PANEL_HEIGHT, WIDTH
from granstudy.analysis.tables.states import EXACT_MOMENTS, LINEAR
from granstudy.trust.flags import Trust

THEORIES = {
    "a2_linear": ("linear theory (van Noije & Ernst)", "--"),
    "a2_divided": ("divided by $1 + a_2$ (Montanero & Santos)", ":"),
    "a2_exact": ("exact moments", "-"),
}
"""Label and line style of theories by the table's column."""

UNIT = 1e-3
"""Of differences from particles."""

ASKED = 1e-4
"""The error that states of Maxwell molecules are asked to be below from e = 0.5 on."""

NOT_TRUSTED = "open: not labelled trusted"


def draw_states(tables: Sequence[xr.Dataset]) -> Figure:
    """Draw a2 against e, a column a table; below, particles less a2, or the error of a2.

    Parameters
    ----------
    tables : sequence of xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`, of state runs swept over e.

    Raises
    ------
    ValueError
        If a table is not one of states, or e is not swept.
    """
    for table in tables:
        if "state" not in table.attrs or "e" not in table.attrs["swept"].split():
            raise ValueError(f"{table.attrs['title']}: is no table of states swept over e")
    figure = Figure(figsize=(WIDTH, 1.75 * PANEL_HEIGHT + 0.9), layout="constrained")
    axes = figure.subplots(2, len(tables), squeeze=False, sharex="col", height_ratios=[3, 2])
    for (upper, lower), table in zip(axes.T, tables, strict=True):
        exact = "a2_error" in table
        _theories(upper, table)
        for part, look in _groups(table):
            _states(upper, part, "a2", look)
            if exact:
                _states(lower, part, "a2_error", look)
        _particles(upper, lower, table)
        upper.set_title(table.attrs["title"])
        upper.set_ylabel("$a_2$")
        lower.set_xlabel(SYMBOLS["e"])
        if exact:
            lower.axhline(ASKED, color="0.6", linewidth=0.8, linestyle="--")
            lower.set(yscale="log", ylabel="$|a_2 - a_2^{exact}|$")
        else:
            lower.axhline(0.0, color="0.6", linewidth=0.8)
            lower.set_ylabel(f"particles $-\\ a_2$, in $10^{{{np.log10(UNIT):.0f}}}$")
    labelled = {
        label: handle
        for ax in axes[0]
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True)
    }
    labels = sorted(labelled, key=lambda label: label == NOT_TRUSTED)
    figure.legend(
        [labelled[label] for label in labels], labels, loc="outside lower center",
        ncols=min(len(labels), 3),
    )  # fmt: skip
    return figure


def _theories(ax: Axes, table: xr.Dataset) -> None:
    """Curves of the theories that the table has columns of."""
    state, dim = table.attrs["state"], table.attrs["dim"]
    e = np.linspace(0.0, 1.0, 201)[:-1]
    laws: dict[str, Any] = {
        name: lambda e, law=law: law(e, dim, float(table["exponent"]))
        for name, law in LINEAR[state].items()
    }
    laws["a2_exact"] = lambda e: EXACT_MOMENTS[state](2, e, dim)[2] - 1.0
    for name, (label, style) in THEORIES.items():
        if name in table:
            a2 = [laws[name](value) for value in e]
            ax.plot(e, a2, style, color="0.45", linewidth=1.2, label=label, zorder=1)


def _groups(table: xr.Dataset) -> list[tuple[xr.Dataset, dict[str, Any]]]:
    """The runs that differ in e (and ε) alone, and how they look."""
    names = [name for name in table.attrs["swept"].split() if name not in ("e", "epsilon")]
    if not names:
        look = {"color": METHOD_COLOURS["radial"], "marker": "o", "label": "solved for"}
        return [(table, look)]
    keys = [tuple(table[name].values[i] for name in names) for i in range(table.sizes["run"])]
    found = []
    for key, colour, marker in zip(dict.fromkeys(keys), cycle(COLOURS), cycle(MARKERS)):
        part = table.isel(run=[i for i, other in enumerate(keys) if other == key])
        label = ", ".join(
            f"{SYMBOLS.get(n, n)} = {v:g}" if isinstance(v, np.number) else str(v)
            for n, v in zip(names, key, strict=True)
        )
        found.append((part, {"color": colour, "marker": marker, "label": label}))
    return found


def _states(ax: Axes, part: xr.Dataset, name: str, look: dict[str, Any]) -> None:
    """Line through the computed states, markers filled where they are labelled trusted."""
    part = part.sortby("e")
    trusted = part["trust"].values == Trust.TRUSTED
    ax.plot(part["e"], part[name], markersize=4.5, zorder=2, **look)
    hollow = look | {"linestyle": "none", "markerfacecolor": "white", "markersize": 4.5}
    if not trusted.all():
        ax.plot(part["e"][~trusted], part[name][~trusted], zorder=3, **hollow | {"label": "_"})
        ax.plot([], [], **hollow | {"color": "0.3", "marker": "o", "label": NOT_TRUSTED})


def _particles(upper: Axes, lower: Axes, table: xr.Dataset) -> None:
    """What particles came to, with two standard errors either way."""
    beside = [n for n in table.attrs.get("beside", "").split() if f"a2_{n}_standard_error" in table]
    for name in beside:
        bars = 2.0 * table[f"a2_{name}_standard_error"]
        look: dict[str, Any] = {"color": "black", "linestyle": "none", "marker": "_", "zorder": 4}
        look |= {"capsize": 2.5, "elinewidth": 0.9, "markersize": 5.0}
        label = "particles, ± 2 standard errors"
        upper.errorbar(table["e"], table[f"a2_{name}"], bars, label=label, **look)
        lower.errorbar(table["e"], table[f"a2_{name}_difference"] / UNIT, bars / UNIT, **look)
