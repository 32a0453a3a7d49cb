"""The atlas of a study as a figure: maps over e and λ, a row a number, a column a state."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize, SymLogNorm, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from granstudy.analysis.figures.plots.looks import colour_map
from granstudy.analysis.figures.style import STYLE, Picture
from granstudy.trust.flags import Trust

ROW_HEIGHT, COLUMN_WIDTH = 1.75, 2.3
"""Size of a map, in inches."""

HATCHES = {Trust.MARGINAL: "....", Trust.UNTRUSTED: "//////"}
"""Hatching of states that are not trusted."""


@dataclass(frozen=True)
class Row:
    """One row of maps.

    Attributes
    ----------
    label : str
        What is mapped, as Matplotlib's mathematics.
    values : callable
        Atlas ↦ the numbers.
    scale : str
        ``signed`` (white at 0), ``symlog`` (the same, in decades) or ``log``.
    linear : float
        Size up to which a ``symlog`` scale is linear.
    """

    label: str
    values: Callable[[xr.Dataset], xr.DataArray]
    scale: str
    linear: float = 1e-3


ROWS = (
    Row("$a_2$", lambda ds: ds["a2"], "symlog", 0.01),
    Row(
        "linear theory:\n" r"$a_{2,\mathrm{lin}}-a_2$",
        lambda ds: ds["a2_linear"] - ds["a2"],
        "symlog",
    ),
    Row("$a_3$", lambda ds: ds["a3"], "symlog", 0.01),
    Row("$K$", lambda ds: ds["cooling_coefficient"], "log"),
    Row(
        "linear theory:\n" r"$K_\mathrm{lin}/K-1$",
        lambda ds: ds["cooling_coefficient_linear"] / ds["cooling_coefficient"] - 1.0,
        "symlog",
        1e-5,
    ),
    Row("tail: $A$\n(cooling, $\\lambda=0$: $s$)", lambda ds: ds["tail_rate"], "log"),
    Row("estimated\nerror of $a_2$", lambda ds: ds["a2_error"].where(ds["exponent"] > 0), "log"),
)
"""The rows of an atlas, from top to bottom."""


def draw_atlas(atlas: xr.Dataset) -> Figure:
    """Draw an atlas: a row for each of `ROWS`, a column for each state and dimension; one scale a row.

    Parameters
    ----------
    atlas : xarray.Dataset
        From `granstudy.analysis.tables.atlas.atlas_of`.
    """
    columns = [(s, d) for s in atlas["state"].values for d in atlas["dim"].values]
    size = (1.6 + COLUMN_WIDTH * len(columns), 1.0 + ROW_HEIGHT * len(ROWS))
    with mpl.rc_context(STYLE):
        figure = Picture(figsize=size, layout="constrained")
        axes = figure.subplots(len(ROWS), len(columns), squeeze=False, sharex=True, sharey=True)
        for row, line in zip(ROWS, axes, strict=True):
            values = row.values(atlas)
            norm, colours = _norm(row, values.values)
            for ax, (state, dim) in zip(line, columns, strict=True):
                part = values.sel(state=state, dim=dim).transpose("exponent", "e")
                drawn = _map(ax, part, norm, colours)
                _hatch(ax, part, atlas["trust"].sel(state=state, dim=dim).values)
            bar = figure.colorbar(drawn, ax=line.tolist(), pad=0.01, aspect=12)
            bar.set_label(row.label, fontsize=8)
            line[0].set_ylabel(r"$\lambda$")
        for ax, (state, dim) in zip(axes[0], columns, strict=True):
            ax.set_title(f"{state}, {dim}D")
        for ax in axes[-1]:
            ax.set_xlabel("$e$")
        labels = set(np.unique(atlas["trust"].values).tolist())
        handles = [
            Patch(
                facecolor="white",
                edgecolor="0.45",
                linewidth=0.0,
                hatch=hatch,
                label=label.name.lower(),
            )
            for label, hatch in HATCHES.items()
            if int(label) in labels
        ]
        if handles:
            figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
        figure.suptitle(atlas.attrs["title"], fontsize=11)
    return figure


def _map(ax: Axes, part: xr.DataArray, norm: Normalize, colours: Any) -> Any:
    """Draw one map: a cell a state, grey where there is no number."""
    e, exponent = part["e"].values, part["exponent"].values
    ax.set_facecolor("0.85")
    drawn = ax.imshow(
        np.ma.masked_invalid(part.values),
        origin="lower", aspect="auto", interpolation="nearest", norm=norm, cmap=colours,
        extent=(*_ends(e), *_ends(exponent)),
    )  # fmt: skip
    ax.grid(False)
    return drawn


def _ends(values: np.ndarray) -> tuple[float, float]:
    """Where the cells of equally spaced values begin and end."""
    half = 0.5 * (values[-1] - values[0]) / max(values.size - 1, 1) or 0.5
    return float(values[0] - half), float(values[-1] + half)


def _hatch(ax: Axes, part: xr.DataArray, trust: np.ndarray) -> None:
    """Hatch the states that are not trusted."""
    (left, right), (bottom, top) = _ends(part["e"].values), _ends(part["exponent"].values)
    width, height = (right - left) / part.sizes["e"], (top - bottom) / part.sizes["exponent"]
    for label, hatch in HATCHES.items():
        for i, j in np.argwhere(trust == label):
            corner = left + j * width, bottom + i * height
            ax.add_patch(
                Rectangle(
                    corner, width, height, fill=False, edgecolor="0.1", linewidth=0.0, hatch=hatch
                )
            )


def _norm(row: Row, values: np.ndarray) -> tuple[Normalize, Any]:
    """Scale and colours of a row."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return Normalize(0.0, 1.0), colour_map()
    if row.scale == "log":
        positive = finite[finite > 0.0]
        return LogNorm(float(positive.min()), float(positive.max())), colour_map()
    most = float(np.abs(finite).max()) or 1.0
    if row.scale == "symlog" and most > row.linear:
        return SymLogNorm(row.linear, vmin=-most, vmax=most), mpl.colormaps["RdBu_r"]
    return TwoSlopeNorm(0.0, -most, most), mpl.colormaps["RdBu_r"]
