"""Cooling over decades of time as a figure: T(t), and how far its local slope is from Haff's law."""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granstudy.analysis.figures.style import COLOURS, PANEL_HEIGHT, SYMBOLS, WIDTH
from granstudy.analysis.tables.fits import local_slope
from granstudy.datasets.open_runs import open_runs

ASKED = 1e-3
"""The distance from −2/λ that the local slope is asked to come to."""

STYLES = ("-", "--", ":", "-.")
"""Of the runs of a gas."""


def draw_slope(table: xr.Dataset, run_files: list[str]) -> Figure:
    """Draw T(t) on logarithmic axes; beside it |d ln T/d ln t + 2/λ|, which falls as 1/t.

    A colour a gas (e), a line style for each of its runs, so that runs that agree are both seen.
    """
    figure = Figure(figsize=(WIDTH, PANEL_HEIGHT + 1.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    law = -2.0 / float(table["exponent"])
    with open_runs(run_files, densities=False) as runs:
        time, T = runs["time"].values[1:], runs["temperature"].values[:, 1:]
    gases = list(dict.fromkeys(table["e"].values.tolist()))
    seen = dict.fromkeys(gases, 0)
    for i in range(table.sizes["run"]):
        e = table["e"].values[i].item()
        style, label = STYLES[seen[e] % len(STYLES)], f"{SYMBOLS['e']} = {e:g}"
        if "method" in table.attrs["swept"].split():
            label += f", {table['method'].values[i]}"
        look = {"color": COLOURS[gases.index(e) % len(COLOURS)], "linewidth": 1.6 + seen[e]}
        seen[e] += 1
        left.plot(time, T[i], style, label=label, **look)
        at, slope = local_slope(time, T[i])
        right.plot(at, np.abs(slope - law), style, **look)
    right.axhline(ASKED, color="0.6", linewidth=0.8)
    left.set(xlabel="$t$", ylabel="$T$", xscale="log", yscale="log")
    left.set_title("temperature")
    right.set(xlabel="$t$", xscale="log", yscale="log")
    right.set_ylabel(rf"$|\mathrm{{d}}\,\ln T/\mathrm{{d}}\,\ln t + {-law:g}|$")
    right.set_title("distance of the local slope from Haff's law")
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure
