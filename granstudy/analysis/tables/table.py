"""One labelled table of an experiment's runs: our numbers, the paper's, their ratio, fits."""

import csv
import io
import json
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import dask
import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.analysis.paper.printed import match_printed, printed_quantity
from granstudy.analysis.tables.fits import fit_haff, fit_order, growth_exponent, local_slope
from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.states import columns, state_table, with_beside
from granstudy.analysis.tables.truth import COLUMNS, truth_table
from granstudy.datasets.open_runs import final_values, open_runs
from granstudy.datasets.run_dataset import (
    CONVENTIONS,
    FLAGS,
    Status,
    flag_word,
    read_dataset,
    write_dataset,
)
from granstudy.particles.averages import time_average
from granstudy.study.benchmark.front import families
from granstudy.support.errors import unknown_name
from granstudy.support.files import write_whole

if TYPE_CHECKING:  # a table does not depend on the solvers that the study module imports
    from granstudy.study.run import Run
    from granstudy.study.schema.file import AverageModel, Experiment, FitModel, TableModel

DEFAULT_QUANTITY = {
    "evolution": "temperature",
    "collision": "collision_error",
    "benchmark": "seconds",
    "state": "a2",
}
LEAST_MEMORY_MB = 8.0
"""Peak memories below this are the allocator's, and not fitted."""

Rows = list[tuple["Run", str]]


def experiment_table(
    experiment: "Experiment",
    runs: dict[str, "Run"],
    files: list[str],
    beside: Sequence[xr.Dataset] = (),
) -> xr.Dataset:
    """Table of an experiment, a row (dimension ``run``) for each run.

    Parameters
    ----------
    experiment : Experiment
        What the study file says: which quantity, which of the paper's tables, which fit.
    runs : dict of Run
        The experiment's runs by path, references among them.
    files : list of str
        Their files in the same order; of a benchmark its one file.
    beside : sequence of Dataset
        Tables of the experiments that stand beside states, as the study file lists them.

    Returns
    -------
    xarray.Dataset
        Swept parameters are coordinates along ``run`` (listed in the attribute `swept`), all others
        scalar coordinates. Variables: the quantity; of the paper `paper` and `ratio`
        (ours / paper), NaN where `has_paper` is false; other measures of the same runs; fits;
        `status`. A run that ended early has NaN for its numbers, and its status.

    Raises
    ------
    ValueError
        For a quantity, fit or printed table that the runs do not fit.
    """
    rows: Rows = []
    if experiment.run == "benchmark":
        table = _benchmark(files)
    else:
        paths = [(path, run, file) for (path, run), file in zip(runs.items(), files, strict=True)]
        for path, _, file in paths:
            if not file.endswith(f"{path}.nc"):
                raise ValueError(f"{file}: is not the file of run {path}")
        rows = [(run, file) for _, run, file in paths if not run.is_reference]
        by_path = {path: file for path, _, file in paths}
        if experiment.truth is not None:
            table = _with_swept(truth_table(rows, by_path), rows)
            if experiment.table is not None and experiment.table.seconds:
                table = _with_seconds(table, rows)
        elif experiment.run == "evolution":
            table = _evolution(rows, experiment.table)
        elif experiment.run == "state":
            table = _with_swept(state_table(rows), rows)
            names = experiment.table.beside if experiment.table else []
            table = with_beside(table, dict(zip(names, beside, strict=True)))
        else:
            table = _collision(rows, by_path)
    asked = experiment.table
    quantity = asked.quantity if asked else DEFAULT_QUANTITY[experiment.run]
    numbers = [str(name) for name, v in table.data_vars.items() if v.dtype.kind == "f"]
    if quantity not in numbers:
        raise unknown_name("quantity", quantity, numbers)
    table.attrs["quantity"] = quantity
    if experiment.fit is not None:
        table = _with_fit(table, experiment.fit, rows)
    if asked and asked.paper:
        table = _with_paper(table, asked.paper, printed_quantity(asked.paper, quantity))
    return _finish(table, experiment)


def write_table(
    table: xr.Dataset,
    nc: str | Path,
    csv: str | Path,
    md: str | Path,
    markdown: Callable[[xr.Dataset], str] = markdown_table,
) -> None:
    """Write a table as NetCDF, CSV and Markdown, each whole or not at all."""
    write_dataset(table, nc, sidecar=False)
    write_whole(Path(csv), lambda partial: partial.write_text(csv_table(table)))
    write_whole(Path(md), lambda partial: partial.write_text(markdown(table)))


def csv_table(table: xr.Dataset) -> str:
    """Write the table as CSV: swept parameters, numbers to 10 digits, status as a word."""
    swept = table.attrs["swept"].split()
    names = [str(name) for name in table.data_vars if name != "has_paper"]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*swept, *names])
    for i in range(table.sizes["run"]):
        row = table.isel(run=i)
        writer.writerow(
            [str(row[name].item()) for name in swept] + [_cell(name, row[name]) for name in names]
        )
    return stream.getvalue()


def _cell(name: str, value: xr.DataArray) -> str:
    if name in FLAGS:
        return flag_word(name, value)
    if value.dtype.kind == "f":
        return "" if np.isnan(value) else f"{value.item():.10g}"
    return str(value.item())


def _evolution(rows: Rows, asked: "TableModel | None") -> xr.Dataset:
    """Moments and errors at the final time, or averages that are asked for."""
    # Before all files are open: netCDF4 has crashed where a file was opened twice.
    averages = _averages(rows, asked.average) if asked and asked.average else {}
    with final_values([file for _, file in rows]) as final:
        names = [name for name, v in final.data_vars.items() if v.dims == ("run",)]
        # One thread: netCDF4 has crashed under several.
        table = final[names].drop_vars(["reason", "warnings"]).load(scheduler="synchronous")
    ended = table["status"] == Status.OK
    table = table.map(lambda v: v.where(ended) if v.dtype.kind == "f" else v, keep_attrs=True)
    return _with_swept(table.assign(averages), rows)


def _collision(rows: Rows, files: dict[str, str]) -> xr.Dataset:
    """Largest difference of Q from each run's reference, on all grid points."""
    with ExitStack() as stack:
        Q: dict[str, xr.DataArray] = {}
        for file in files.values():
            ds = xr.open_dataset(file, engine="netcdf4", chunks={})
            Q[file] = stack.enter_context(ds)["Q"]
        references = [Q[files[run.reference.path]] for run, _ in rows]
        errors = [
            abs(Q[file] - reference).max()
            for (_, file), reference in zip(rows, references, strict=True)
        ]
        largest = [abs(reference).max() for reference in references]
        # One thread: netCDF4 has crashed under several.
        errors, largest = dask.compute(errors, largest, scheduler="synchronous")
    with final_values([file for _, file in rows]) as final:
        table = final[["status"]].load()
    error = np.array([value.item() for value in errors])
    scale = np.array([value.item() for value in largest])
    for name, values, long_name in (
        ("collision_error", error, "max|Q − Q_reference| on the grid"),
        ("relative_error", error / scale, "max|Q − Q_reference| / max|Q_reference|"),
    ):
        table[name] = ("run", values, {"long_name": long_name, "units": "1"})
    return _with_swept(table, rows)


def _benchmark(files: list[str]) -> xr.Dataset:
    (file,) = files
    table = read_dataset(file)
    table.attrs["swept"] = " ".join(
        str(name) for name, c in table.coords.items() if c.dims == ("run",)
    )
    return table


def _with_swept(table: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Keep swept parameters along ``run``; one value of each other one."""
    swept = [key for key, _ in rows[0][0].values]
    if "M_sph" in swept and "N_theta" in table.coords and (table["N_theta"] > 0).any():
        swept[swept.index("M_sph") + 1 : swept.index("M_sph") + 1] = ["N_theta", "N_phi"]
    along = [str(name) for name, c in table.coords.items() if c.dims == ("run",)]
    others = {name: table[name].values for name in along if name not in swept}
    table = table.drop_vars(list(others)).assign_coords(
        {name: values[0] for name, values in others.items() if np.unique(values).size == 1}
    )
    table.attrs["swept"] = " ".join(swept)
    return table


def _with_fit(table: xr.Dataset, fit: "FitModel", rows: Rows) -> xr.Dataset:
    if fit.law == "order":
        return _with_order(table, table.attrs["quantity"], fit.x)
    if fit.law == "growth":
        return _with_growth(table)
    return {"slope": _with_slope, "haff": _with_haff}[fit.law](table, rows)


def _with_order(table: xr.Dataset, quantity: str, x: str | None) -> xr.Dataset:
    """Add `order`, the fitted slope of each group of runs that differ in ``x`` alone."""
    swept = table.attrs["swept"].split()
    if x not in swept:
        raise ValueError(f"fit.x={x!r}: an order is fitted against a swept parameter: {swept}")
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i in range(table.sizes["run"]):
        key = tuple(table[name].values[i] for name in swept if name != x)
        groups.setdefault(key, []).append(i)
    order = np.full(table.sizes["run"], np.nan)
    for members in groups.values():
        error = table[quantity].values[members]
        order[members], _ = fit_order(table[x].values[members], error)
    long_name = f"p of {quantity} ~ {x}^p, fitted to the runs that differ in {x} alone"
    table["order"] = ("run", order, {"long_name": long_name, "units": "1"})
    table.attrs["refined"] = x
    return table


def _with_growth(table: xr.Dataset) -> xr.Dataset:
    """Add the exponents of time and memory in N, of each method, and those of N^{d+1} log N."""
    exponents = np.full((3, table.sizes["run"]), np.nan)
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, key in enumerate(zip(families(table), table["threads"].values, strict=True)):
        groups.setdefault(key, []).append(i)
    for members in groups.values():
        N = table["N"].values[members].astype(float)
        exponents[0, members] = growth_exponent(N, table["seconds"].values[members])
        if "peak_memory_mb" in table:
            memory = table["peak_memory_mb"].values[members]
            exponents[1, members] = growth_exponent(N, memory, LEAST_MEMORY_MB)
        exponents[2, members] = growth_exponent(N, N ** (table.attrs["dim"] + 1) * np.log(N))
    long_names = {
        "time_exponent": "p of seconds ~ N^p, fitted to the runs of a method",
        "memory_exponent": f"p of peak memory ~ N^p, fitted where it is above {LEAST_MEMORY_MB} MB",
        "law_exponent": "p of N^{d+1} log N ~ N^p, fitted to the same N",
    }
    for values, (name, long_name) in zip(exponents, long_names.items(), strict=True):
        table[name] = ("run", values, {"long_name": long_name, "units": "1"})
    return table


def _with_haff(table: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Add C0 fitted to each run, its standard error, and C0 of theory for a Gaussian shape."""
    fitted = []
    for run, file in rows:
        with open_runs([file]) as ds:
            time, T = ds["time"].values, ds["temperature"].values[0]
        e, kernel = run.scene.restitution, run.scene.kernel
        C0 = (
            np.nan
            if callable(e)
            else theory.haff_constant(kernel, float(e), run.scene.dim, T0=float(T[0]))
        )
        fitted.append((*fit_haff(time, T), C0))
    long_names = {
        "C0": "Haff constant, least squares of T0 (1 + C0 t)^-2",
        "C0_error": "standard error of the fitted C0",
        "C0_theory": "Haff constant of a Gaussian shape at the initial temperature",
    }
    for column, (name, long_name) in enumerate(long_names.items()):
        values = np.array([numbers[column] for numbers in fitted])
        table[name] = ("run", values, {"long_name": long_name, "units": "1"})
    return table


def _with_seconds(table: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Add how long every run took."""
    attributes = {"long_name": "wall time of the run, set-up included", "units": "s"}
    seconds = [_seconds(file) for _, file in rows]
    return table.assign(seconds=("run", seconds, attributes | {"format": ".3g"}))


def _seconds(file: str) -> float:
    return float(json.loads(Path(f"{file}.json").read_text())["duration_seconds"])


def _with_slope(table: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Add d ln T/d ln t of the last decade, its distance from Haff's law, and how long the run took."""
    found = []
    for run, file in rows:
        with open_runs([file]) as ds:
            time, T = ds["time"].values[1:], ds["temperature"].values[0, 1:]
        at, slope = local_slope(time, T)
        late = slope[at > time[-1] / 10.0]
        law = -2.0 / run.scene.kernel.exponent
        found.append((late.mean(), np.abs(late - law).max(), _seconds(file)))
    long_names = {
        "slope": ("d ln T/d ln t, mean over the last decade of t", ".6f"),
        "slope_error": ("largest |d ln T/d ln t + 2/λ| in the last decade of t", ".1e"),
        "seconds": ("wall time of the run, set-up included", ".3g"),
    }
    for column, (name, (long_name, digits)) in enumerate(long_names.items()):
        values = np.array([numbers[column] for numbers in found], dtype=float)
        table[name] = ("run", values, {"long_name": long_name, "units": "1", "format": digits})
    return table


def _averages(rows: Rows, asked: "AverageModel") -> dict[str, Any]:
    """Averages over time and their standard errors by batches, which replace the last values."""
    variables = {}
    where = f"averaged from t = {asked.start:g} on"
    for run, _ in rows:
        if run.solver.method != "dsmc":
            raise ValueError(f"table.average: only method 'dsmc' has it, not {run.path}")
    datasets = [read_dataset(file) for _, file in rows]
    for name in asked.of:
        means, errors = np.array([time_average(ds, name, asked.start) for ds in datasets]).T
        for column, values, long_name, digits in (
            (name, means, f"{name}, {where}", ".6f"),
            (f"{name}_standard_error", errors, f"standard error of {name}, {where}", ".1e"),
        ):
            attributes = {"long_name": long_name, "units": "1", "format": digits}
            variables[column] = ("run", values, attributes)
    return variables


def _with_paper(table: xr.Dataset, paper: str, quantity: str) -> xr.Dataset:
    """Add the printed number of each run and ours over it."""
    if quantity not in table:
        raise ValueError(f"paper={paper!r}: prints {quantity}, which the table does not have")
    printed = match_printed(paper, table)
    has_paper = np.isfinite(printed)
    if not has_paper.any():
        raise ValueError(f"paper={paper!r}: prints no number for any of the runs")
    units = table[quantity].attrs.get("units", "1")
    where = "NaN where has_paper is false"
    for name, values, attributes in (
        ("paper", printed, {"long_name": f"{quantity} printed in the paper; {where}"}),
        ("ratio", table[quantity].values / printed, {"long_name": f"ours / paper; {where}"}),
    ):
        table[name] = ("run", values, attributes | {"units": units if name == "paper" else "1"})
    table["has_paper"] = ("run", has_paper, {"long_name": "the paper prints a number for the run"})
    table.attrs["paper_quantity"] = quantity
    return table


def _finish(table: xr.Dataset, experiment: "Experiment") -> xr.Dataset:
    """Put the columns into reading order, and say what the table is."""
    quantity = table.attrs["quantity"]
    first = [
        quantity,
        f"{quantity}_standard_error",
        "slope",
        "slope_error",
        "C0",
        "C0_error",
        "C0_theory",
        "paper",
        "ratio",
        "has_paper",
        "order",
    ]
    beside = {
        "evolution": [
            "temperature_error",
            "temperature",
            "temperature_standard_error",
            *(["a2", "seconds"] if "slope" in table else []),
            "density_drift",
        ],
        "state": columns(table) if experiment.run == "state" else [],
        "collision": ["relative_error"],
        "benchmark": [str(name) for name in table.data_vars],
    }[experiment.run]
    if experiment.truth is not None:
        beside = [*COLUMNS, "seconds"]
    names = [name for name in (*first, *beside, "status") if name in table]
    kept = ("swept", "quantity", "refined", "paper_quantity", "dim", "state", "beside", "truth")
    attributes = {key: table.attrs[key] for key in kept if key in table.attrs}
    table = table[[*dict.fromkeys(name for name in names if name != "status"), "status"]]
    table.attrs = {
        "title": experiment.title,
        "Conventions": CONVENTIONS,
        **attributes,
    }
    return table
