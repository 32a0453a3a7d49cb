"""Temperature over time beside Haff's law, and over decades of time."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.lines import check_one_exponent
from granstudy.analysis.figures.plots.kinds import runs_of
from granstudy.analysis.figures.plots.labels import symbol_of
from granstudy.analysis.figures.plots.looks import Looks, add_bar, add_legend, looks_of
from granstudy.analysis.figures.plots.marks import line_opacity, mark, trust_handles
from granstudy.analysis.figures.plots.quantity import draw_series, value_labels
from granstudy.analysis.figures.plots.scales import check_scale, time_scale
from granstudy.analysis.figures.plots.series import Series, series_of
from granstudy.analysis.figures.style import PANEL_HEIGHT, STYLE, WIDTH, Picture
from granstudy.analysis.source import FigureSource
from granstudy.reading.cooling import local_slope, time_axis
from granstudy.theory import haff_temperature

SAMPLES = 20
"""Markers of a run; the line between them is the fit's, so that the two can be told apart."""

ASKED = 1e-3
"""Distance from −2/λ that the local slope has to fall below."""

FIT: dict[str, Any] = {"linestyle": "--", "linewidth": 1.2}
"""Look of a fitted law."""


def check_cooling(source: FigureSource) -> None:
    """Raise ValueError unless the runs go through time."""
    _check_evolution("cooling", source)


def check_slope(source: FigureSource) -> None:
    """Raise ValueError unless the runs cool by one law of Haff, with outputs between."""
    _check_evolution("slope", source)
    table = source.table
    check_one_exponent("slope", table)
    if float(np.unique(table["exponent"].values)[0]) == 0.0:
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
    """Draw T(t) of an experiment with its fitted Haff laws."""
    return cooling_figure(runs_of(source), title="")


def draw_slope(source: FigureSource) -> Figure:
    """Draw T(t) of an experiment over decades, and the distance of its slope from Haff's law."""
    return slope_figure(runs_of(source), title="")


def cooling_figure(
    runs: xr.Dataset, *, scale: str | None = None, title: str | None = None
) -> Figure:
    """Draw T(t), with fitted Haff laws; beside it (T0/T)^{λ/2} − 1, which Haff's law makes C0 t.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs with a temperature over time; with `C0` where laws were fitted. Without laws λ is 1 beside it.
    scale : str, optional
        Of T and t: ``log``, ``linear``; by default logarithmic where the outputs span decades.
    title : str, optional
        By default what is drawn.
    """
    check_scale("scale", scale)
    fitted = "C0" in runs
    T, series = _temperatures(runs)
    C0 = runs["C0"].reset_coords(drop=True) if fitted else xr.DataArray(np.nan)
    exponent = runs["exponent"].reset_coords(drop=True) if fitted else xr.DataArray(1.0)
    powers = [float(_at(exponent, one.key)) / 2 for one in series]
    with mpl.rc_context(STYLE):
        figure = Picture(figsize=(WIDTH, PANEL_HEIGHT + 0.9), layout="constrained")
        left, right = figure.subplots(1, 2)
        looks = looks_of(series, value_labels(T))
        for one, look, power in zip(series, looks.lines, powers, strict=True):
            t, its_T, trust = one.x, one.y, one.trust
            sampled = np.unique(np.geomspace(1, max(t.size - 1, 1), SAMPLES).astype(int))
            sampled = sampled[sampled < t.size]
            hollow = look | {"markersize": 4.0}
            mark(left, t, its_T, trust, hollow)
            ratio = (its_T[0] / its_T[sampled]) ** power - 1.0
            mark(right, t[sampled], ratio, trust[sampled], hollow)
            constant = float(_at(C0, one.key))
            if np.isfinite(constant):
                law = {"color": look["color"], "alpha": line_opacity(trust), **FIT}
                left.plot(t, haff_temperature(t, its_T[0], constant, 2 * power), **law)
                right.plot(t[sampled], constant * t[sampled], **law)
        if len(looks.handles) == len(series):
            for handle, one in zip(looks.handles, series, strict=True):
                constant = float(_at(C0, one.key))
                if np.isfinite(constant):
                    handle.set_label(f"{handle.get_label()}, {symbol('C0')} = {constant:.4g}")
        chosen = scale or time_scale([one.x for one in series])
        left.set(xlabel="$t$", ylabel=symbol("temperature"))
        if chosen == "log":
            left.set(xscale="log", yscale="log")
        else:
            left.set(xlim=(0.0, None), ylim=(0.0, None))
        left.set_title("temperature" + (", and fitted Haff laws (dashed)" if fitted else ""))
        right.set(xlabel="$t$", ylabel=_law_of(powers), xscale="log", yscale="log")
        right.set_title("Haff's law is a line of slope 1")
        _legend(figure, (left, right), T, looks, series)
        figure.suptitle("Cooling" if title is None else title, fontsize=10)
    return figure


def _law_of(powers: list[float]) -> str:
    """What Haff's law makes a line, as Matplotlib's mathematics."""
    hard = all(power == 0.5 for power in powers)
    return r"$\sqrt{T_0/T} - 1$" if hard else r"$(T_0/T)^{\lambda/2} - 1$"


def slope_figure(runs: xr.Dataset, *, title: str | None = None) -> Figure:
    """Draw T(t) on logarithmic axes; beside it |d ln T/d ln t + 2/λ|, which falls as 1/t.

    Raises
    ------
    ValueError
        For Maxwell molecules, whose temperature has no such slope.
    """
    if bool((runs["exponent"] == 0.0).any()):
        raise ValueError("exponent: Haff's law holds for exponent > 0; select such runs")
    T, series = _temperatures(runs.isel({time_axis(runs): slice(1, None)}))
    exponent = runs["exponent"].reset_coords(drop=True)
    laws = [-2.0 / float(_at(exponent, one.key)) for one in series]
    with mpl.rc_context(STYLE):
        figure = Picture(figsize=(WIDTH, PANEL_HEIGHT + 0.9), layout="constrained")
        left, right = figure.subplots(1, 2)
        looks = looks_of(series, value_labels(T))
        draw_series(left, series, looks)
        distances = []
        for one, law in zip(series, laws, strict=True):
            at, slope = local_slope(one.x, one.y)
            distances.append(Series(one.key, at, np.abs(slope - law), one.trust[1:]))
        draw_series(right, distances, looks)
        right.axhline(ASKED, color="0.6", linewidth=0.8)
        left.set(xlabel="$t$", ylabel=symbol("temperature"), xscale="log", yscale="log")
        left.set_title("temperature")
        right.set(xlabel="$t$", xscale="log", yscale="log")
        steepness = f"{-laws[0]:g}" if len(set(laws)) == 1 else r"2/\lambda"
        right.set_ylabel(rf"$|\mathrm{{d}}\,\ln T/\mathrm{{d}}\,\ln t + {steepness}|$")
        right.set_title("distance of the local slope from Haff's law")
        _legend(figure, (left, right), T, looks, series)
        figure.suptitle("Cooling over decades" if title is None else title, fontsize=10)
    return figure


def _temperatures(runs: xr.Dataset) -> tuple[xr.DataArray, list[Series]]:
    """T over time, and its lines.

    Raises
    ------
    ValueError
        If the runs do not go through time.
    """
    time_axis(runs)
    T = runs["temperature"]
    return T, series_of(T, "time", runs.get("trust"))


def _at(values: xr.DataArray, key: Any) -> xr.DataArray:
    """A number of the run of a line."""
    return values.sel({d: v for d, v in key.items() if d in values.dims})


def _legend(
    figure: Figure, axes: tuple[Axes, Axes], T: xr.DataArray, looks: Looks, series: list[Series]
) -> None:
    handles: list[Line2D] = [*looks.handles, *trust_handles(one.trust for one in series)]
    add_legend(figure, handles)
    if looks.bar is not None:
        add_bar(figure, list(axes), looks.bar, symbol_of(T.coords[looks.bar.dim]))
