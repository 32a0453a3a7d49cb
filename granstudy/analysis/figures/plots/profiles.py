"""Densities over thermal velocities: beside a Maxwellian, their tails, their marginals."""

from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from granstudy.analysis.figures.plots.data import LEAST
from granstudy.analysis.figures.plots.labels import axis_label, caption, symbol_of
from granstudy.analysis.figures.plots.looks import add_bar, add_legend, looks_of
from granstudy.analysis.figures.plots.marks import line_opacity, mark, trust_handles
from granstudy.analysis.figures.plots.quantity import value_labels
from granstudy.analysis.figures.plots.scales import number_scale, set_scale
from granstudy.analysis.figures.plots.series import series_of
from granstudy.analysis.figures.style import PANEL_HEIGHT, STYLE, WIDTH, Picture
from granstudy.trust.flags import Trust

GUIDE: dict[str, Any] = {"color": "0.35", "linestyle": "--", "linewidth": 1.0, "zorder": 1}
"""Look of the Maxwellian."""

NEGATIVE: dict[str, Any] = {"linestyle": "none", "marker": "x", "markersize": 3.5}
"""Look of −f where f is negative, on a logarithmic axis."""


def profile_figure(
    y: xr.DataArray,
    kind: str,
    trust: xr.DataArray | None = None,
    *,
    dim: int,
    power: float = 1.0,
    title: str | None = None,
) -> Figure:
    """Draw profiles of densities, a line for each value of the dimensions beside c.

    Parameters
    ----------
    y : xarray.DataArray
        From `granstudy.analysis.figures.plots.data.profile`.
    kind : str
        ``over_maxwellian``, ``tail`` or ``marginal``.
    trust : xarray.DataArray, optional
        Labels of the runs.
    dim : int
        Velocity dimension, for the Maxwellian beside them.
    power : float
        Power of c on a tail's abscissa: exp(−A c^power) is a line then.
    title : str, optional
        By default the long name.
    """
    series = series_of(y, "c", trust)
    if not series:
        raise ValueError(f"{y.name}: no density is kept of these runs")
    with mpl.rc_context(STYLE):
        figure = Picture(figsize=(0.8 * WIDTH, PANEL_HEIGHT + 0.8), layout="constrained")
        ax = figure.subplots()
        looks = looks_of(series, value_labels(y))
        logarithmic = kind == "tail"
        any_negative = False
        for one, look in zip(series, looks.lines, strict=True):
            line = {"color": look["color"], "linestyle": look["linestyle"]}
            line["alpha"] = line_opacity(one.trust)
            x = np.sign(one.x) * np.abs(one.x) ** power
            shown = np.where(one.y > 0.0, one.y, np.nan) if logarithmic else one.y
            ax.plot(x, shown, **line)
            if (one.trust != Trust.TRUSTED).any():
                mark(ax, x, shown, one.trust, look)
            negative = one.y < -LEAST * np.abs(one.y).max()
            if logarithmic and negative.any():
                any_negative = True
                ax.plot(x[negative], -one.y[negative], **line | NEGATIVE)
        handles = [*looks.handles, _guide(ax, kind, dim, power, y)]
        if any_negative:
            handles.append(Line2D([], [], color="0.3", label="$-f$, where $f < 0$", **NEGATIVE))
        handles += trust_handles(one.trust for one in series)
        c = y.coords["c"]
        ax.set(xlabel=_abscissa(symbol_of(c), power), ylabel=axis_label(y))
        if logarithmic:
            top = max(float(one.y.max()) for one in series)
            ax.set(yscale="log", ylim=(LEAST * top, 2.0 * top))
        elif kind == "over_maxwellian":
            values = [one.y for one in series]
            set_scale(ax, "y", number_scale(values), values)
        add_legend(figure, handles)
        if looks.bar is not None:
            add_bar(figure, ax, looks.bar, symbol_of(y.coords[looks.bar.dim]))
        figure.suptitle(caption(y) if title is None else title, fontsize=10)
    return figure


def _guide(ax: Any, kind: str, dim: int, power: float, y: xr.DataArray) -> Line2D:
    """Draw the Maxwellian."""
    c = np.linspace(float(y["c"].min()), float(y["c"].max()), 200)
    d = 1 if kind == "marginal" else dim
    if kind == "over_maxwellian":
        ax.axhline(1.0, **GUIDE)
    else:
        gaussian = np.exp(-(c**2) / 2) / (2 * np.pi) ** (d / 2)
        ax.plot(np.sign(c) * np.abs(c) ** power, gaussian, **GUIDE)
    return Line2D([], [], label="Maxwellian", **GUIDE)


def _abscissa(symbol: str, power: float) -> str:
    return symbol if power == 1.0 else f"({symbol})$^{{{power:g}}}$"
