"""Temperature over time beside Haff's law, and over decades of time."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.lines import distinguishing
from granstudy.analysis.figures.style import COLOURS, MARKERS, PANEL_HEIGHT, WIDTH
from granstudy.analysis.source import FigureSource
from granstudy.analysis.tables.fits import local_slope
from granstudy.datasets.open_runs import open_runs
from granstudy.theory import haff_temperature

SAMPLES = 20
"""Markers of a run; the line between them is the fit's, so that the two can be told apart."""

BESIDE_CURVES = 3
"""Runs up to which the legend has room between the curves; that of more stands below, two runs a row."""

ROW = 0.2
"""Height of a row of the legend, in inches."""

ASKED = 1e-3
"""Distance from −2/λ that the local slope has to fall below."""

STYLES = ("-", "--", ":", "-.")
"""Line styles of the runs of a gas."""


def draw_cooling(source: FigureSource) -> Figure:
    """Draw T(t) with the fitted Haff laws; beside it √(T0/T) − 1, which Haff's law makes C0 t."""
    table = source.table
    rows = -(-table.sizes["run"] // 2) if table.sizes["run"] > BESIDE_CURVES else 0
    height = PANEL_HEIGHT + 0.4 + ROW * rows
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    left, right = figure.subplots(1, 2)
    names = distinguishing(table, table.attrs["swept"].split())
    runs = open_runs(source.row_files)
    times, T = np.broadcast_arrays(runs["time"].values, runs["temperature"].values)
    for i in range(table.sizes["run"]):
        time = times[i, np.isfinite(times[i])]
        every = max(1, time.size // SAMPLES)
        sampled = np.unique(np.geomspace(1, time.size - 1, SAMPLES).astype(int))
        colour = COLOURS[i % len(COLOURS)]
        label = ", ".join(f"{symbol(n)} = {table[n].values[i]}" for n in names)
        T0 = T[i, 0]
        look: dict[str, Any] = {"color": colour, "linestyle": "none", "marker": MARKERS[i % 4]}
        look |= {"markersize": 4.0, "markerfacecolor": "white"}
        left.plot(time[::every], T[i, : time.size : every], label=label, **look)
        right.plot(time[sampled], np.sqrt(T0 / T[i, sampled]) - 1.0, **look)
        if "C0" in table:
            C0 = table["C0"].values[i]
            law = rf"${T0:.4g}\,(1 + {C0:.4g}\,t)^{{-2}}$"
            dashed: dict[str, Any] = {"color": colour, "linestyle": "--", "linewidth": 1.2}
            left.plot(time, haff_temperature(time, T0, C0), label=law, **dashed)
            right.plot(time[sampled], C0 * time[sampled], **dashed)
    left.set(xlabel="$t$", ylabel=symbol("temperature"), ylim=(0.0, None), xlim=(0.0, None))
    left.set_title("temperature" + (" and fitted Haff laws" if "C0" in table else ""))
    if rows:
        handles = left.get_legend_handles_labels()
        figure.legend(*handles, loc="outside lower center", ncols=4)
    else:
        left.legend()
    right.set(xlabel="$t$", ylabel=r"$\sqrt{T_0/T} - 1$", xscale="log", yscale="log")
    right.set_title("Haff's law is a line of slope 1")
    return figure


def draw_slope(source: FigureSource) -> Figure:
    """Draw T(t) on logarithmic axes; beside it |d ln T/d ln t + 2/λ|, which falls as 1/t.

    A colour a gas (e), a line style for each of its runs, so that runs that agree are both seen.
    """
    table = source.table
    figure = Figure(figsize=(WIDTH, PANEL_HEIGHT + 1.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    law = -2.0 / float(table["exponent"])
    runs = open_runs(source.row_files)
    times, T = np.broadcast_arrays(runs["time"].values, runs["temperature"].values)
    gases = list(dict.fromkeys(table["e"].values.tolist()))
    seen = dict.fromkeys(gases, 0)
    for i in range(table.sizes["run"]):
        e = table["e"].values[i].item()
        style, label = STYLES[seen[e] % len(STYLES)], f"{symbol('e')} = {e:g}"
        if "method" in table.attrs["swept"].split():
            label += f", {table['method'].values[i]}"
        look = {"color": COLOURS[gases.index(e) % len(COLOURS)], "linewidth": 1.6 + seen[e]}
        seen[e] += 1
        there = np.isfinite(times[i])
        time, temperature = times[i, there][1:], T[i, there][1:]
        left.plot(time, temperature, style, label=label, **look)
        at, slope = local_slope(time, temperature)
        right.plot(at, np.abs(slope - law), style, **look)
    right.axhline(ASKED, color="0.6", linewidth=0.8)
    left.set(xlabel="$t$", ylabel=symbol("temperature"), xscale="log", yscale="log")
    left.set_title("temperature")
    right.set(xlabel="$t$", xscale="log", yscale="log")
    right.set_ylabel(rf"$|\mathrm{{d}}\,\ln T/\mathrm{{d}}\,\ln t + {-law:g}|$")
    right.set_title("distance of the local slope from Haff's law")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure
