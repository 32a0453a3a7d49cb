"""One labelled table of an experiment's runs: our numbers, the paper's, their ratio, fits."""

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.analysis.paper.printed import _with_paper, printed_quantity
from granstudy.analysis.tables.fits import (
    _with_fit,
)
from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.runs import (
    Rows,
    _benchmark,
    _collision,
    _evolution,
    _with_seconds,
    _with_swept,
)
from granstudy.analysis.tables.states import columns, state_table, with_beside
from granstudy.analysis.tables.truth import COLUMNS, truth_table
from granstudy.datasets.netcdf import write_dataset
from granstudy.datasets.run_dataset import CONVENTIONS
from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment
from granstudy.support.errors import unknown_name
from granstudy.support.files import write_whole
from granstudy.trust.flags import FLAGS, flag_word

DEFAULT_QUANTITY = {
    "evolution": "temperature",
    "collision": "collision_error",
    "benchmark": "seconds",
    "state": "a2",
}


def experiment_table(
    experiment: Experiment,
    runs: dict[str, Run],
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
        if experiment.run == "evolution" and experiment.truth is not None:
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


def _finish(table: xr.Dataset, experiment: Experiment) -> xr.Dataset:
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
    if experiment.has_truth:
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
