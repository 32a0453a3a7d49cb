"""Figures of an experiment, drawn from its table and its runs."""

import itertools
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from granstudy.analysis.figures.front import draw_front, draw_run_front
from granstudy.analysis.figures.gallery import draw_gallery
from granstudy.analysis.figures.states import draw_states
from granstudy.analysis.figures.style import (
    COLOURS,
    LABELS,
    MARKERS,
    METHOD_COLOURS,
    METHODS_FIRST,
    PANEL_HEIGHT,
    PAPER,
    PAPER_LOOK,
    STYLE,
    SYMBOLS,
    WIDTH,
)
from granstudy.datasets.open_runs import open_runs
from granstudy.slope_figure import draw_slope
from granstudy.study.benchmark.front import families
from granstudy.support.files import write_whole
from granstudy.theory import haff_temperature

if TYPE_CHECKING:  # a figure does not depend on the solvers that the study module imports
    from granstudy.study.run import Run
    from granstudy.study.schema.file import Experiment


def draw(
    experiment: "Experiment",
    table: xr.Dataset,
    run_files: list[str],
    beside: Sequence[xr.Dataset] = (),
    runs: Mapping[str, "Run"] | None = None,
) -> Figure:
    """Draw an experiment's figure, of the kind its study file asks for.

    Parameters
    ----------
    experiment : Experiment
    table : xarray.Dataset
        From `granstudy.analysis.tables.table.experiment_table`.
    run_files : list of str
        The runs' files; ``cooling`` and ``slope`` figures need them.
    beside : sequence of xarray.Dataset
        Tables of other experiments, which ``front`` and ``states`` show in panels of their own.
    runs : dict of Run
        The experiment's runs by path, in the order of their files; a ``gallery`` needs them.
    """
    asked = experiment.figure
    if asked is None:
        raise ValueError(f"{experiment.title}: asks for no figure")
    with mpl.rc_context(STYLE):
        if asked.kind == "cooling":
            figure = _cooling(table, run_files)
        elif asked.kind == "speed":
            figure = _speed(table)
        elif asked.kind == "front":
            of_runs = experiment.truth is not None
            figure = draw_run_front(table) if of_runs else draw_front([table, *beside])
        elif asked.kind == "states":
            figure = draw_states([table, *beside])
        elif asked.kind == "slope":
            figure = draw_slope(table, run_files)
        elif asked.kind == "gallery":
            assert runs is not None
            files = dict(zip(runs, run_files, strict=True))
            rows = [(run, files[path]) for path, run in runs.items() if not run.is_reference]
            figure = draw_gallery(table, rows, files)
        else:
            figure = _convergence(table, asked.x)
        figure.suptitle(asked.title or experiment.title, fontsize=10)
    return figure


def save_figure(figure: Figure, png: str | Path, svg: str | Path) -> None:
    """Write a figure as PNG and SVG, each whole or not at all, same figure same bytes."""
    with mpl.rc_context(STYLE):
        for path, metadata in ((Path(png), {"Software": None}), (Path(svg), {"Date": None})):
            write_whole(
                path,
                lambda partial, metadata=metadata: figure.savefig(
                    partial, dpi=200, metadata=metadata
                ),
            )


def _convergence(table: xr.Dataset, x: str | None) -> Figure:
    """Draw the quantity against the refined parameter, a column of panels for each e.

    Where methods and variants both differ, there is a row of panels for each variant.
    """
    swept = table.attrs["swept"].split()
    if x is None or x not in swept:
        raise ValueError(f"figure.x={x!r}: must be one of the swept parameters {swept}")
    names = _distinguishing(table, [name for name in swept if name not in (x, "e")])
    down = "variant" if {"variant", "method"} <= set(names) else None
    names = [name for name in names if name != down]
    columns, rows = _panels(table, "e"), _panels(table, down)
    width = WIDTH if len(columns) > 1 else 0.75 * WIDTH
    size = (width, PANEL_HEIGHT * (1.0 if len(rows) == 1 else 0.85) * len(rows) + 0.9)
    figure = Figure(figsize=size, layout="constrained")
    axes = figure.subplots(len(rows), len(columns), sharex=True, sharey=True, squeeze=False)
    looks = _looks([key for key, _ in _lines(table, names)])
    for ax, (row, column) in zip(axes.flat, itertools.product(rows, columns), strict=True):
        part = table.isel(run=sorted(set(row[1]) & set(column[1])))
        for key, unsorted in _lines(part, names):
            line = unsorted.sortby(x)
            ax.plot(line[x], line[table.attrs["quantity"]], **looks[key])
        _draw_paper(ax, part, x)
        if x == "dt":
            _order_guide(ax, part, x)
        if column[0] or row[0]:
            ax.set_title(", ".join(filter(None, (column[0], row[0]))))
        ax.set_yscale("log")
        _mark_values(ax, x, np.unique(table[x]))
    _label_outer(axes, x, table.attrs["quantity"])
    handles = [
        Line2D([], [], label=_label(key) or str(table["method"].values.flat[0]), **look)
        for key, look in looks.items()
    ]
    if _paper_is_drawn(table):
        handles.append(Line2D([], [], label=PAPER, **PAPER_LOOK))
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), 3))
    return figure


def _label_outer(axes: np.ndarray, x: str, quantity: str) -> None:
    for ax in axes[-1]:
        ax.set_xlabel(SYMBOLS.get(x, x))
    for ax in axes[:, 0]:
        ax.set_ylabel(SYMBOLS.get(quantity, quantity))


def _panels(table: xr.Dataset, name: str | None) -> list[tuple[str, list[int]]]:
    """Title and runs of the panels for each value of a parameter, or one panel of all runs."""
    if name is None or name not in table.attrs["swept"].split():
        return [("", list(range(table.sizes["run"])))]
    return [
        (
            f"{SYMBOLS[name]} = {value}" if name == "e" else str(value),
            np.flatnonzero(table[name] == value).tolist(),
        )
        for value in np.unique(table[name])
    ]


def _distinguishing(table: xr.Dataset, names: list[str]) -> list[str]:
    """Find the parameters that are needed to tell the lines apart."""
    kept = [name for name in names if name not in ("N_theta", "N_phi")]
    # What says least is left out first.
    for name in sorted(kept, key=lambda name: (name != "dt", name != "method")):
        fewer = [other for other in kept if other != name]
        if len(list(_lines(table, fewer))) == len(list(_lines(table, kept))):
            kept = fewer
    return kept


def _lines(table: xr.Dataset, names: list[str]) -> Iterator[tuple[tuple[str, ...], xr.Dataset]]:
    """Group runs with equal values of ``names``, by these values."""
    keys = [tuple(str(table[name].values[i]) for name in names) for i in range(table.sizes["run"])]
    for key in dict.fromkeys(keys):
        yield key, table.isel(run=[i for i, other in enumerate(keys) if other == key])


def _label(key: tuple[str, ...]) -> str:
    return ", ".join(LABELS.get(value, value) for value in key)


def _looks(keys: list[tuple[str, ...]]) -> dict[tuple[str, ...], dict[str, Any]]:
    """Colour, marker and width of every line."""
    looks: dict[tuple[str, ...], dict[str, Any]] = {}
    for i, key in enumerate(keys):
        method = next((value for value in key if value in METHOD_COLOURS), None)
        # What others agree with lies under them, wide and pale, so that both are seen.
        under = bool({"literal", "full"} & set(key)) and len(keys) == 2
        looks[key] = {
            "color": METHOD_COLOURS[method] if method else COLOURS[i % len(COLOURS)],
            "marker": "o" if under else MARKERS[i % len(MARKERS)],
            "linewidth": 4.0 if under else 1.4,
            "markersize": 8.0 if under else 4.5,
            "zorder": 2 if under else 3,
        }
    return looks


def _paper_is_drawn(table: xr.Dataset) -> bool:
    return "paper" in table and table.attrs["paper_quantity"] == table.attrs["quantity"]


def _draw_paper(ax: Axes, part: xr.Dataset, x: str) -> None:
    """Draw the printed numbers, open and black around ours."""
    if _paper_is_drawn(part):
        ax.plot(part[x], part["paper"], **PAPER_LOOK)


def _order_guide(ax: Axes, part: xr.Dataset, x: str, order: int = 3) -> None:
    """Draw a grey line of slope 3, the order of the Runge–Kutta scheme, below the data."""
    ends = np.array([part[x].min().item(), part[x].max().item()])
    scale = np.nanmin(part[part.attrs["quantity"]] / part[x] ** order).item() / 2.5
    ax.plot(ends, scale * ends**order, color="0.45", linewidth=1.0, zorder=1)
    middle = np.sqrt(ends.prod())
    text = rf"$\propto \Delta t^{order}$"
    ax.annotate(
        text, (middle, scale * middle**order), (4, -10), textcoords="offset points", color="0.35"
    )


def _mark_values(ax: Axes, x: str, values: np.ndarray) -> None:
    """Ticks where the runs are."""
    if x == "M_sph":
        return
    ax.set_xscale("log", base=2)
    ax.xaxis.set_major_locator(FixedLocator(values.tolist()))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def _cooling(table: xr.Dataset, run_files: list[str]) -> Figure:
    """Draw T(t) with the fitted Haff laws; beside it √(T0/T) − 1, which Haff's law makes C0 t."""
    figure = Figure(figsize=(WIDTH, PANEL_HEIGHT + 0.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    names = _distinguishing(table, table.attrs["swept"].split())
    with open_runs(run_files, densities=False) as runs:
        time, T = runs["time"].values, runs["temperature"].values
    for i in range(table.sizes["run"]):
        colour = COLOURS[i % len(COLOURS)]
        label = ", ".join(f"{SYMBOLS.get(n, n)} = {table[n].values[i]}" for n in names)
        T0 = T[i, 0]
        # twenty markers: the line between them is the fit's, and the two must be told apart
        every = max(1, time.size // 20)
        look: dict[str, Any] = {"color": colour, "linestyle": "none", "marker": MARKERS[i % 4]}
        look |= {"markersize": 4.0, "markerfacecolor": "white"}
        left.plot(time[::every], T[i, ::every], label=label, **look)
        sampled = np.unique(np.geomspace(1, time.size - 1, 20).astype(int))
        right.plot(time[sampled], np.sqrt(T0 / T[i, sampled]) - 1.0, **look)
        if "C0" in table:
            C0 = table["C0"].values[i]
            law = rf"${T0:.4g}\,(1 + {C0:.4g}\,t)^{{-2}}$"
            dashed: dict[str, Any] = {"color": colour, "linestyle": "--", "linewidth": 1.2}
            left.plot(time, haff_temperature(time, T0, C0), label=law, **dashed)
            right.plot(time[sampled], C0 * time[sampled], **dashed)
    left.set(xlabel="$t$", ylabel="$T$", ylim=(0.0, None), xlim=(0.0, None))
    left.set_title("temperature and fitted Haff laws")
    left.legend()
    right.set(xlabel="$t$", ylabel=r"$\sqrt{T_0/T} - 1$", xscale="log", yscale="log")
    right.set_title("Haff's law is a line of slope 1")
    return figure


def _speed(table: xr.Dataset) -> Figure:
    """Draw seconds against N for every method, with one thread and with all."""
    figure = Figure(figsize=(WIDTH, PANEL_HEIGHT + 1.0), layout="constrained")
    ax = figure.subplots()
    counts = np.unique(table["threads"]).tolist()
    named = table.assign_coords(method=("run", families(table)))
    for (method, threads), line in _lines(named, ["method", "threads"]):
        all_threads = int(threads) == counts[-1]
        plural = "thread" if threads == "1" else "threads"
        ax.plot(
            line["N"],
            line["seconds"],
            color=METHOD_COLOURS[method],
            linestyle="-" if all_threads else "--",
            marker="o" if all_threads else "s",
            markerfacecolor=METHOD_COLOURS[method] if all_threads else "white",
            label=f"{method}, {threads} {plural}",
        )
    if "paper" in table:
        for name, marker, methods in (("direct", "^", ["direct"]), ("fast", "D", ["literal"])):
            part = table.isel(run=np.flatnonzero(table["method"].isin(methods).values))
            look = PAPER_LOOK | {"marker": marker, "markersize": 8.0}
            ax.plot(part["N"], part["paper"], label=f"{PAPER}, {name}, 10 cores", **look)
    _complexity_guide(ax, table)
    ax.set_yscale("log")
    ax.set(xlabel=SYMBOLS["N"], ylabel=SYMBOLS["seconds"])
    _mark_values(ax, "N", np.unique(table["N"]))
    handles, labels = ax.get_legend_handles_labels()
    # Stable: ours by method, one thread before all, then the paper and the guide.
    order = sorted(range(len(labels)), key=lambda i: METHODS_FIRST.get(labels[i].split(",")[0], 9))
    ax.legend(
        [handles[i] for i in order],
        [labels[i] for i in order],
        loc="center left",
        bbox_to_anchor=(1.01, 0.5),
    )
    return figure


def _complexity_guide(ax: Axes, table: xr.Dataset) -> None:
    """Draw N⁴ log N, the cost of the fast method in 3D, below the fastest line but `radial`'s."""
    table = table.isel(run=np.flatnonzero(table["method"].values != "radial"))
    N = np.unique(table["N"]).astype(float)
    cost = N**4 * np.log(N)
    seconds = np.array([table["seconds"].values[table["N"].values == n].min() for n in N])
    scale = np.min(seconds / cost) / 2.0
    ax.plot(N, scale * cost, color="0.45", linewidth=1.0, label=r"$\propto N^4 \log N$", zorder=1)
