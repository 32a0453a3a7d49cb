"""Temperature over time beside Haff's law, and over decades of time."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.lines import check_one_exponent, distinguishing
from granstudy.analysis.figures.style import COLOURS, MARKERS, PANEL_HEIGHT, WIDTH
from granstudy.analysis.groups import values_of
from granstudy.analysis.source import FigureSource
from granstudy.datasets.open_runs import open_runs
from granstudy.reading.cooling import local_slope
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


def check_cooling(source: FigureSource) -> None:
    """Raise ValueError unless the runs go through time."""
    _check_evolution("cooling", source)


def check_slope(source: FigureSource) -> None:
    """Raise ValueError unless the runs cool by one law of Haff, over e, with outputs between."""
    _check_evolution("slope", source)
    table = source.table
    if "e" not in table.attrs["swept"].split():
        raise ValueError("figure.kind='slope': has a colour for each e; sweep e")
    check_one_exponent("slope", table)
    if float(table["exponent"]) == 0.0:
        raise ValueError(
            "figure.kind='slope': Haff's law holds for exponent > 0; the runs have exponent 0"
        )
    for run, _ in source.rows:
        assert run.time is not None
        if run.time.recorded.size < 3:
            raise ValueError(
                f"figure.kind='slope': needs three outputs or more; run {run.path} has "
                f"{run.time.recorded.size}"
            )


def _check_evolution(kind: str, source: FigureSource) -> None:
    if source.experiment.run != "evolution":
        raise ValueError(
            f"figure.kind={kind!r}: shows T(t) of evolution runs, not of {source.experiment.run} runs"
        )


def draw_cooling(source: FigureSource) -> Figure:
    """Draw T(t) with the fitted Haff laws; beside it (T0/T)^{λ/2} − 1, which Haff's law makes C0 t.

    Without a fit, λ is 1 there.
    """
    table = source.table
    rows = -(-table.sizes["run"] // 2) if table.sizes["run"] > BESIDE_CURVES else 0
    height = PANEL_HEIGHT + 0.4 + ROW * rows
    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    left, right = figure.subplots(1, 2)
    names = distinguishing(table, table.attrs["swept"].split())
    runs = open_runs(source.row_files)
    times, T = np.broadcast_arrays(runs["time"].values, runs["temperature"].values)
    exponents = values_of(table, "exponent", 1.0) if "C0" in table else np.ones(table.sizes["run"])
    for i in range(table.sizes["run"]):
        time = times[i, np.isfinite(times[i])]
        every = max(1, time.size // SAMPLES)
        sampled = np.unique(np.geomspace(1, time.size - 1, SAMPLES).astype(int))
        colour = COLOURS[i % len(COLOURS)]
        label = ", ".join(f"{symbol(n)} = {table[n].values[i]}" for n in names)
        T0, power = T[i, 0], exponents[i] / 2
        look: dict[str, Any] = {"color": colour, "linestyle": "none", "marker": MARKERS[i % 4]}
        look |= {"markersize": 4.0, "markerfacecolor": "white"}
        left.plot(time[::every], T[i, : time.size : every], label=label, **look)
        right.plot(time[sampled], (T0 / T[i, sampled]) ** power - 1.0, **look)
        if "C0" in table:
            C0 = table["C0"].values[i]
            law = rf"${T0:.4g}\,(1 + {C0:.4g}\,t)^{{{-1.0 / power:.3g}}}$"
            dashed: dict[str, Any] = {"color": colour, "linestyle": "--", "linewidth": 1.2}
            left.plot(time, haff_temperature(time, T0, C0, exponents[i]), label=law, **dashed)
            right.plot(time[sampled], C0 * time[sampled], **dashed)
    left.set(xlabel="$t$", ylabel=symbol("temperature"), ylim=(0.0, None), xlim=(0.0, None))
    left.set_title("temperature" + (" and fitted Haff laws" if "C0" in table else ""))
    if rows:
        handles = left.get_legend_handles_labels()
        figure.legend(*handles, loc="outside lower center", ncols=4)
    else:
        left.legend()
    right.set(xlabel="$t$", ylabel=_law_of(exponents), xscale="log", yscale="log")
    right.set_title("Haff's law is a line of slope 1")
    return figure


def _law_of(exponents: np.ndarray) -> str:
    """What Haff's law makes a line, as Matplotlib's mathematics."""
    return r"$\sqrt{T_0/T} - 1$" if np.all(exponents == 1.0) else r"$(T_0/T)^{\lambda/2} - 1$"


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
