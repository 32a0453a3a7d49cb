"""A hard case as a figure: T and a2 over time and the last density, of every run and of the truth."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from granstudy.analysis.columns import symbol
from granstudy.analysis.figures.plots.marks import line_opacity
from granstudy.analysis.figures.style import COLOURS, PANEL_HEIGHT, WIDTH, Picture
from granstudy.analysis.groups import keys
from granstudy.analysis.labels import run_text, telling_apart
from granstudy.analysis.source import FigureSource
from granstudy.analysis.tables.truth import truth_model, truth_of
from granstudy.datasets.netcdf import read_dataset
from granstudy.evolution.frames.physical import physical_density
from granstudy.reading.weights import trigonometric_weights
from granstudy.trust.flags import flag_word
from granstudy.trust.truth import Truth

LEAST_DENSITY = 1e-7
"""Densities are drawn down to this part of the largest."""

LONG_AGO = 100.0
"""Times are drawn in their logarithm where the last output is so many times the first."""

TIMES_OF_LAW = 200
"""Times at which an exact law is drawn."""


def check_gallery(source: FigureSource) -> None:
    """Raise ValueError unless the runs have a truth to be shown beside."""
    if not source.experiment.has_truth:
        raise ValueError("figure.kind='gallery': shows runs beside their truth; give one")


def draw_gallery(source: FigureSource) -> Figure:
    """Draw the runs of an experiment beside their truth, which is black."""
    figure = Picture(figsize=(1.3 * WIDTH, PANEL_HEIGHT + 1.2), layout="constrained")
    panels = figure.subplots(1, 3)
    rows, files, names = source.rows, source.by_path, telling_apart(source.table)
    truths: dict[str, Truth] = {}
    for i, ((run, file), key) in enumerate(zip(rows, keys(source.table, names), strict=True)):
        ds = read_dataset(file)
        look: dict[str, Any] = {"color": COLOURS[i % len(COLOURS)], "zorder": 3}
        # Runs that agree lie over each other, the first one wide and pale, so that all are seen.
        opacity = 0.85 * line_opacity(np.atleast_1d(ds["trust"].values))
        look |= {"linewidth": 1.3 + 0.8 * (len(rows) - 1 - i), "alpha": opacity}
        label = run_text(dict(zip(names, key, strict=True)), symbol)
        label += f": {flag_word('trust', ds['trust'])}{', stopped' * bool(int(ds['status']))}"
        panels[0].plot(ds["time"], ds["temperature"], **look, label=label)
        panels[1].plot(ds["time"], ds["a2"], **look)
        _density(panels[2], ds, look)
        assert run.time is not None
        by_law = truth_model(run).law is not None
        gas = str(run.scene.describe()) if by_law else run.truth.path
        if gas not in truths:
            truths[gas] = truth_of(run, files, _dense(run.time.recorded))
            _draw_truth(panels, truths[gas], None if by_law else files[gas])
    _scales(panels, next(iter(truths.values())))
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    return figure


def _is_long(times: np.ndarray) -> bool:
    return bool(times.size > 2 and times[-1] > LONG_AGO * times[1])


def _dense(times: np.ndarray) -> np.ndarray:
    """Times for a smooth curve, the outputs among them, even in time or in its logarithm."""
    if times.size < 3:
        return times
    space = np.geomspace if _is_long(times) else np.linspace
    return np.union1d(times, space(times[1], times[-1], TIMES_OF_LAW))


def _density(ax: Axes, ds: xr.Dataset, look: dict[str, Any]) -> None:
    """Draw the last density; where it is negative, its size as crosses."""
    profile = thermal_profile(ds)
    if profile is None:
        return
    x, y = profile
    ax.plot(x, np.where(y > 0.0, y, np.nan), **look)
    ax.plot(x, np.where(y < 0.0, -y, np.nan), **look | {"linestyle": "none", "marker": "x"})


def _draw_truth(panels: Sequence[Axes], truth: Truth, file: str | None) -> None:
    """Draw a truth in black, with the density of its run."""
    look: dict[str, Any] = {"color": "black", "linestyle": "--", "linewidth": 1.0, "zorder": 4}
    panels[0].plot(truth.time, truth.temperature, **look, label=f"truth: {truth.source}")
    panels[1].plot(truth.time, truth.a2, **look)
    if file is not None:
        _density(panels[2], read_dataset(file), look)


def _scales(panels: Sequence[Axes], truth: Truth) -> None:
    """Set the axes: logarithms where numbers span decades, densities down to `LEAST_DENSITY`."""
    T, times = truth.temperature, truth.time
    for ax in panels[:2]:
        ax.set(xlabel="$t$", xlim=(0.0, times[-1]))
        if _is_long(times):
            ax.set(xscale="log", xlim=(times[1], times[-1]))
    if T.max() > 10.0 * T.min():
        panels[0].set_yscale("log")
    # A run that runs away must not flatten the truth.
    spread = max(0.05, 3.0 * np.ptp(truth.a2))
    panels[1].set_ylim(truth.a2.min() - spread, truth.a2.max() + spread)
    panels[0].set(title="temperature $T$")
    panels[1].set(title="kurtosis excess $a_2$")
    panels[2].set(
        title="density at the end (×: −f)",
        xlabel=r"$(v_x - u_x)/\sqrt{T}$",
        yscale="log",
        ylim=(LEAST_DENSITY, 1.0),
        xlim=(-6.0, 6.0),
    )


def thermal_profile(ds: xr.Dataset) -> tuple[np.ndarray, np.ndarray] | None:
    """Increasing x = (v_x − u_x)/√T, and T^{d/2} f/ρ there; None where no density is kept of the last time.

    Between the nodes of the other axes a Cartesian density is its trigonometric interpolant; a radial one is
    shown at x and −x.
    """
    if "snapshot" not in ds.dims or ds["snapshot"][-1] != ds["time"][-1]:
        return None
    last = ds.isel(time=-1)
    u, d = last["velocity"].values, ds.sizes["component"]
    thermal = np.sqrt(float(last["temperature"]))
    f = physical_density(ds).isel(snapshot=-1)
    values = f.values * thermal**d / float(last["density"])
    if f.ndim == 1:
        r = f["r"].values / thermal
        return np.concatenate([-r[::-1], r]), np.concatenate([values[::-1], values])
    axes = [f[f"v{axis}"].values for axis in ds["component"].values]
    for axis in reversed(range(1, d)):
        values = values @ trigonometric_weights(axes[axis], u[axis])
    return (axes[0] - u[0]) / thermal, values
