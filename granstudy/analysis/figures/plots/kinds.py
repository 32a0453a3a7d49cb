"""Kinds of figures of study files that draw labelled data: quantities, maps, profiles of densities."""

from functools import partial

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from granstudy.analysis.figures.plots.data import (
    over_parameters,
    profile,
    quantity_over,
    snapshots,
)
from granstudy.analysis.figures.plots.profiles import profile_figure
from granstudy.analysis.figures.plots.quantity import lines_figure, map_figure
from granstudy.analysis.groups import check_swept
from granstudy.analysis.source import FigureSource
from granstudy.analysis.tables.planned import HAVE
from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.open_runs import open_runs
from granstudy.datasets.parameters import PARAMETERS
from granstudy.states.dataset import QUANTITIES
from granstudy.support.errors import unknown_name

TIME = "time"


def runs_of(source: FigureSource) -> xr.Dataset:
    """The runs of an experiment over its swept parameters, with the table's numbers of them.

    What the runs chose for themselves, such as N for an accuracy, tells no line from another.
    """
    runs = open_runs(source.row_files)
    table = source.table
    swept = {name: table[name].variable for name in table.attrs["swept"].split()}
    more = {
        n: v.variable for n, v in table.data_vars.items() if n not in runs and v.dims == ("run",)
    }
    chosen = [
        n
        for n, c in runs.coords.items()
        if c.dims == ("run",) and n in PARAMETERS and n not in swept
    ]
    runs = runs.reset_coords(chosen).drop_vars([n for n in swept if n in runs], errors="ignore")
    return over_parameters(runs.assign_coords(swept).assign(more))


def check_quantity_over(source: FigureSource) -> None:
    """Raise ValueError unless the runs have the quantity, over time or over the swept parameter."""
    x = _abscissa("figure.x", source, source.asked.x)
    _check_named(source, over_time=x == TIME)


def draw_quantity_over(source: FigureSource) -> Figure:
    """Draw a quantity over time or over a swept parameter, a line for each value of the others."""
    x = _abscissa("figure.x", source, source.asked.x)
    runs = runs_of(source) if x == TIME else _at_ends(source)
    y = quantity_over(runs, _quantity(source), x)
    return lines_figure(y, x, runs.get("trust"), title="")


def check_map(source: FigureSource) -> None:
    """Raise ValueError unless the runs have the quantity over two swept parameters, and no other."""
    for field in ("x", "y"):
        if getattr(source.asked, field) is None:
            raise ValueError(f"figure.{field}: must be given; a map is over two swept parameters")
    x = check_swept("figure.x", str(source.asked.x), source.table)
    y = check_swept("figure.y", str(source.asked.y), source.table)
    if x == y:
        raise ValueError(f"figure.y={source.asked.y!r}: must be another parameter than figure.x")
    others = [n for n in _varied(source.table) if n not in (x, y)]
    if others:
        raise ValueError(
            f"figure.kind='map': is over two swept parameters; the runs differ in {', '.join(others)} too"
        )
    _check_named(source, over_time=False)


def draw_map_over(source: FigureSource) -> Figure:
    """Draw a quantity over two swept parameters as a map."""
    x = check_swept("figure.x", str(source.asked.x), source.table)
    y = check_swept("figure.y", str(source.asked.y), source.table)
    runs = _at_ends(source)
    z = quantity_over(runs, _quantity(source), x)
    z = z.expand_dims([d for d in (x, y) if d not in z.dims])
    return map_figure(z, x, y, runs.get("trust"), title="")


def check_profile(source: FigureSource) -> None:
    """Raise ValueError unless the runs keep densities."""
    kind, run_kind = source.asked.kind, source.experiment.run
    if run_kind not in ("evolution", "state"):
        raise ValueError(
            f"figure.kind={kind!r}: shows densities, which {run_kind} runs do not keep"
        )
    for run, _ in source.rows:
        if run_kind == "evolution" and run.time is not None and run.time.save_every is None:
            raise ValueError(
                f"figure.kind={kind!r}: shows densities, and run {run.path} keeps none; set time.save_every"
            )


def draw_profile(source: FigureSource, kind: str) -> Figure:
    """Draw the last densities of all runs over thermal velocities, on whatever grids they are."""
    found = []
    for file in source.row_files:
        one = profile(snapshots(read_dataset(file), -1), kind)
        found.append(one.reset_coords(drop=True))
    table = source.table
    swept = {name: table[name].variable for name in table.attrs["swept"].split()}
    y = xr.concat(found, "run", coords="minimal", compat="override").assign_coords(swept)
    runs = over_parameters(xr.Dataset({"profile": y}).assign(_labels(source)))
    first = source.rows[0].run
    y = runs["profile"].rename(found[0].name)
    return profile_figure(y, kind, runs.get("trust"), dim=first.scene.dim, title="")


draw_over_maxwellian = partial(draw_profile, kind="over_maxwellian")
draw_tail = partial(draw_profile, kind="tail")
draw_marginal = partial(draw_profile, kind="marginal")


def _labels(source: FigureSource) -> dict[str, xr.Variable]:
    """Labels of the runs."""
    runs = open_runs(source.row_files)
    return {"trust": runs["trust"].variable} if "trust" in runs else {}


def _abscissa(field: str, source: FigureSource, x: str | None) -> str:
    """Time, or a swept parameter."""
    if x is None:
        x = TIME if source.experiment.run == "evolution" else _varied(source.table)[0]
    if x != TIME:
        return check_swept(field, x, source.table)
    if source.experiment.run != "evolution":
        raise ValueError(f"{field}='time': {source.experiment.run} runs do not go through time")
    return x


def _varied(table: xr.Dataset) -> list[str]:
    """Swept parameters with more than one value; all where each has one."""
    swept = table.attrs["swept"].split()
    return [name for name in swept if np.unique(table[name].values).size > 1] or swept


def _quantity(source: FigureSource) -> str:
    """The quantity asked for, or the table's."""
    return source.asked.quantity or str(source.table.attrs["quantity"])


def _check_named(source: FigureSource, over_time: bool) -> None:
    """Raise ValueError unless the runs have the quantity."""
    name, table = _quantity(source), source.table
    numbers = [str(n) for n, v in table.data_vars.items() if v.dtype.kind == "f"]
    if over_time:
        numbers = []
    if source.experiment.run == "evolution":
        runs = [run for run, _ in source.rows]
        numbers += [n for n, (_, has) in HAVE.items() if all(map(has, runs))]
        if over_time:
            numbers = [n for n in numbers if n != "density_drift"]
    if source.experiment.run == "state":
        numbers += [n for n, quantity in QUANTITIES.items() if not quantity.dimensions]
    if name not in numbers:
        error = unknown_name("quantity", name, list(dict.fromkeys(numbers)))
        raise ValueError(f"figure.quantity: {error}")


def _at_ends(source: FigureSource) -> xr.Dataset:
    """The table's runs over the swept parameters; with the runs' own numbers where the table lacks them."""
    table = source.table
    if _quantity(source) not in table:
        return runs_of(source)
    lacks = "trust" not in table and source.experiment.run in ("evolution", "state")
    labels = _labels(source) if lacks else {}
    return over_parameters(table.assign(labels))
