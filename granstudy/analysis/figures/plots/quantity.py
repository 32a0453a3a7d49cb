"""A quantity over time or over a parameter as lines, and over two parameters as a map."""

from functools import partial
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize, SymLogNorm, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from granstudy.analysis.figures.plots.labels import axis_label, caption, symbol_of, value_label
from granstudy.analysis.figures.plots.looks import Looks, add_bar, add_legend, colour_map, looks_of
from granstudy.analysis.figures.plots.marks import line_opacity, mark, trust_handles
from granstudy.analysis.figures.plots.scales import (
    check_scale,
    linear_up_to,
    number_scale,
    parameter_ticks,
    set_scale,
    time_scale,
)
from granstudy.analysis.figures.plots.series import Series, abscissa, series_of
from granstudy.analysis.figures.style import PANEL_HEIGHT, STYLE, WIDTH, Picture
from granstudy.trust.flags import Trust

TIMES = ("time", "snapshot")

HATCHES = {Trust.MARGINAL: "..", Trust.UNTRUSTED: "////"}
"""Hatching of cells of a map whose runs are not trusted."""

MOST_NUMBERS = 64
"""Cells of a map up to which each has its number."""


def lines_figure(
    y: xr.DataArray,
    x: str,
    trust: xr.DataArray | None = None,
    *,
    xscale: str | None = None,
    yscale: str | None = None,
    title: str | None = None,
) -> Figure:
    """Draw a quantity over one of its dimensions, a line for each value of the others.

    Parameters
    ----------
    y : xarray.DataArray
        The quantity; its attributes are the labels.
    x : str
        A dimension, or a coordinate along one.
    trust : xarray.DataArray, optional
        Labels of the runs, over dimensions of ``y``.
    xscale, yscale : str, optional
        ``linear``, ``log``, ``symlog``; by default what shows all numbers.
    title : str, optional
        By default the long name.
    """
    check_scale("xscale", xscale)
    check_scale("yscale", yscale)
    series = series_of(y, x, trust)
    if not series:
        raise ValueError(f"{y.name}: has no numbers over {x}")
    with mpl.rc_context(STYLE):
        figure = Picture(figsize=(0.8 * WIDTH, PANEL_HEIGHT + 0.8), layout="constrained")
        ax = figure.subplots()
        looks = looks_of(series, value_labels(y))
        draw_series(ax, series, looks)
        set_axes(ax, y, x, series, xscale, yscale)
        handles = [*looks.handles, *trust_handles(one.trust for one in series)]
        add_legend(figure, handles)
        if looks.bar is not None:
            add_bar(figure, ax, looks.bar, symbol_of(y.coords[looks.bar.dim]))
        figure.suptitle(caption(y) if title is None else title, fontsize=10)
    return figure


def value_labels(y: xr.DataArray) -> dict[str, Any]:
    """Functions that write values of each dimension for a legend."""
    coords = {str(d): y.coords[d] if d in y.coords else xr.DataArray(0, name=d) for d in y.dims}
    return {d: partial(value_label, c) for d, c in coords.items()}


def draw_series(ax: Axes, series: list[Series], looks: Looks) -> None:
    """Draw lines, and markers that tell their labels."""
    xs = [np.arange(s.x.size) if s.x.dtype.kind in "OUS" else s.x for s in series]
    for x, one, look in zip(xs, series, looks.lines, strict=True):
        line = {"color": look["color"], "linestyle": look["linestyle"]}
        ax.plot(x, one.y, alpha=line_opacity(one.trust), **line)
    for x, one, look in zip(xs, series, looks.lines, strict=True):
        mark(ax, x, one.y, one.trust, look)


def set_axes(
    ax: Axes,
    y: xr.DataArray,
    x: str,
    series: list[Series],
    xscale: str | None = None,
    yscale: str | None = None,
) -> None:
    """Label both axes and set their scales."""
    at = y.coords[x] if x in y.coords else xr.DataArray(0, name=x)
    xs, ys = [one.x for one in series], [one.y for one in series]
    ax.set(xlabel=axis_label(at), ylabel=axis_label(y))
    trusts = [one.trust for one in series]
    chosen = yscale or number_scale(ys, trusts)
    set_scale(ax, "y", chosen, ys, trusts)
    if chosen != "log" and min(float(v.min()) for v in ys) < 0.0 < max(float(v.max()) for v in ys):
        ax.axhline(0.0, color="0.6", linewidth=0.8, zorder=1)
    if xs[0].dtype.kind in "OUS":
        longest = max(xs, key=len)
        ax.set_xticks(np.arange(longest.size), [str(v) for v in longest])
        return
    if xscale is not None:
        set_scale(ax, "x", xscale, xs)
    elif abscissa(y, x) in ("time", "output", "snapshot", "kept"):
        ax.set_xscale(time_scale(xs))
    else:
        parameter_ticks(ax, x, np.unique(np.concatenate(xs)))


def map_figure(
    z: xr.DataArray,
    x: str,
    y: str,
    trust: xr.DataArray | None = None,
    *,
    title: str | None = None,
) -> Figure:
    """Draw a quantity over two of its dimensions: a coloured cell for each run, hatched by its label.

    Raises
    ------
    ValueError
        If the quantity has further dimensions, or not these two.
    """
    for field, name in (("x", x), ("y", y)):
        if name not in z.dims:
            raise ValueError(f"{field}={name!r}: must be one of {', '.join(map(str, z.dims))}")
    if x == y:
        raise ValueError(f"y={y!r}: must be another than x")
    rest = [str(d) for d in z.dims if d not in (x, y) and z.sizes[d] > 1]
    if rest:
        raise ValueError(
            f"{z.name}: a map has two dimensions; select one value of {', '.join(rest)}"
        )
    z = z.squeeze([d for d in z.dims if d not in (x, y)]).transpose(y, x)
    with mpl.rc_context(STYLE):
        figure = Picture(figsize=(0.8 * WIDTH, PANEL_HEIGHT + 0.8), layout="constrained")
        ax = figure.subplots()
        values = np.asarray(z.values, dtype=float)
        labels = _labels(z, trust)
        norm, colours = _norm(values, labels)
        drawn = ax.pcolormesh(
            np.ma.masked_invalid(values), norm=norm, cmap=colours, edgecolor="white"
        )
        drawn.set_linewidth(1.0)
        for axis, name in ((ax.xaxis, x), (ax.yaxis, y)):
            ticks = z.coords[name].values if name in z.coords else np.arange(z.sizes[name])
            every = max(1, -(-len(ticks) // 12))
            shown = np.arange(0, len(ticks), every)
            axis.set_ticks(shown + 0.5, [_text(ticks[i]) for i in shown])
            axis.set_label_text(axis_label(z.coords[name]) if name in z.coords else name)
        ax.grid(False)
        ax.tick_params(length=0)
        bar = figure.colorbar(drawn, ax=ax, pad=0.02)
        bar.set_label(axis_label(z))
        if values.size <= MOST_NUMBERS:
            _write_numbers(ax, values, norm, colours)
        add_legend(figure, _hatch(ax, np.isfinite(values), labels))
        figure.suptitle(caption(z) if title is None else title, fontsize=10)
    return figure


def _text(value: Any) -> str:
    return str(value) if isinstance(value, str) else f"{value:g}"


def _labels(z: xr.DataArray, trust: xr.DataArray | None) -> np.ndarray:
    """Labels of a map's cells."""
    if trust is None:
        return np.full(z.shape, int(Trust.TRUSTED))
    plain = trust.reset_coords(drop=True)
    plain = plain.squeeze([d for d in plain.dims if d not in z.dims and plain.sizes[d] == 1])
    return plain.broadcast_like(z.reset_coords(drop=True)).transpose(*z.dims).values


def _norm(values: np.ndarray, labels: np.ndarray) -> tuple[Normalize, Any]:
    """Scale and colours of a map: signed numbers have white at 0."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return Normalize(0.0, 1.0), colour_map()
    low, high = float(finite.min()), float(finite.max())
    scale = number_scale([values], [labels])
    if low < 0.0 < high:
        most = max(-low, high)
        if scale == "symlog":
            linear = linear_up_to([values], [labels])
            return SymLogNorm(linear, vmin=-most, vmax=most), mpl.colormaps["RdBu_r"]
        return TwoSlopeNorm(0.0, -most, most), mpl.colormaps["RdBu_r"]
    if scale == "log":
        return LogNorm(low, high), colour_map()
    return Normalize(low, high if high > low else low + 1.0), colour_map()


def _write_numbers(ax: Axes, values: np.ndarray, norm: Normalize, colours: Any) -> None:
    """Write each cell's number, black or white as its colour asks."""
    for (i, j), value in np.ndenumerate(values):
        if np.isfinite(value):
            red, green, blue, _ = colours(norm(value))
            light = 0.3 * red + 0.59 * green + 0.11 * blue > 0.5
            ax.text(
                j + 0.5, i + 0.5, f"{value:.2g}", ha="center", va="center", fontsize=7.5,
                color="black" if light else "white",
            )  # fmt: skip


def _hatch(ax: Axes, there: np.ndarray, labels: np.ndarray) -> list[Any]:
    """Hatch cells that are not trusted; the legend of it."""
    found = []
    for label, hatch in HATCHES.items():
        cells = np.argwhere(there & (labels == label))
        look: dict[str, Any] = {
            "fill": False,
            "edgecolor": "0.45",
            "linewidth": 0.0,
            "hatch": hatch,
        }
        for i, j in cells:
            ax.add_patch(Rectangle((j, i), 1.0, 1.0, **look))
        if cells.size:
            found.append(Patch(label=Trust(label).name.lower(), **look | {"facecolor": "white"}))
    return found
