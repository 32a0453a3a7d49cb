"""One labelled table of an experiment's runs: our numbers, the paper's, their ratio, fits."""

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.analysis.columns import reading_order
from granstudy.analysis.paper.printed import printed_quantity, with_paper
from granstudy.analysis.source import TableSource
from granstudy.analysis.tables.fits import FITS, check_fit
from granstudy.analysis.tables.labels import labels_table, markdown_labels
from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.runs import (
    benchmark_table,
    check_quantity,
    collision_table,
    evolution_table,
)
from granstudy.analysis.tables.states import state_table
from granstudy.analysis.tables.truth import KNOWN_TO, truth_table
from granstudy.datasets.netcdf import write_dataset
from granstudy.datasets.run_dataset import CONVENTIONS
from granstudy.study.run import Run
from granstudy.study.schema.experiment import Experiment
from granstudy.support.files import write_text
from granstudy.trust.flags import FLAGS, flag_word


@dataclass(frozen=True)
class Kind:
    """How runs of one kind become a table.

    Attributes
    ----------
    table : callable
        Source ↦ the table's columns, with the attribute `swept`.
    quantity : str
        Quantity where the study file asks for no table.
    as_built : bool
        Whether `table` gives the columns in reading order; by default they get the order of
        `granstudy.analysis.columns.COLUMNS`.
    one_file : bool
        Whether all runs share one file; by default each has its own.
    markdown : callable
        Table ↦ its Markdown.
    """

    table: Callable[[TableSource], xr.Dataset]
    quantity: str
    as_built: bool = False
    one_file: bool = False
    markdown: Callable[[xr.Dataset], str] = markdown_table


def _evolution(source: TableSource) -> xr.Dataset:
    """Table of evolutions, beside a truth where they have one."""
    return truth_table(source) if source.experiment.has_truth else evolution_table(source)


KINDS: dict[str, Kind] = {
    "evolution": Kind(_evolution, "temperature"),
    "collision": Kind(collision_table, "collision_error"),
    "benchmark": Kind(benchmark_table, "seconds", one_file=True),
    "state": Kind(state_table, "a2", as_built=True),
    "labels": Kind(
        labels_table, "largest_temperature_error", as_built=True, markdown=markdown_labels
    ),
}
"""Kinds of runs, as a study file's ``run`` names them."""

KEPT = (
    "swept",
    "quantity",
    "refined",
    "paper_quantity",
    "dim",
    "state",
    "beside",
    "truth",
    *KNOWN_TO,
)
"""Attributes of a table that its file keeps, beside title and conventions."""


def experiment_table(
    experiment: Experiment,
    runs: Mapping[str, Run],
    files: Sequence[str],
    beside: Sequence[xr.Dataset] = (),
) -> xr.Dataset:
    """Table of an experiment, a row (dimension ``run``) for each run.

    Parameters
    ----------
    experiment : Experiment
        The study file's section: which quantity, which of the paper's tables, which fit.
    runs : dict of Run
        The experiment's runs by path, references among them.
    files : sequence of str
        Their files in the same order; of a benchmark its one file.
    beside : sequence of Dataset
        Tables of the experiments that stand beside states, in the study file's order.

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
        For a quantity, fit or printed table that the runs do not fit; for a column that has no row in
        `granstudy.analysis.columns.COLUMNS`.
    """
    kind, asked = KINDS[experiment.run], experiment.table
    source = TableSource(
        experiment=experiment,
        runs=runs,
        files=files,
        beside=beside,
        quantity=asked.quantity if asked else kind.quantity,
    )
    if not kind.one_file:
        _check_files(source)
    table = kind.table(source)
    check_quantity(source.quantity, table)
    table.attrs["quantity"] = source.quantity
    check_fit(table, source)
    if experiment.fit is not None:
        table = FITS[experiment.fit.law].add(table, source)
    if asked and asked.paper:
        table = with_paper(table, asked.paper, printed_quantity(asked.paper, source.quantity))
    return _titled(_ordered(table, kind), experiment.title)


def _check_files(source: TableSource) -> None:
    """Raise ValueError unless every run has its own file."""
    for path, file in source.by_path.items():
        if not file.endswith(f"{path}.nc"):
            raise ValueError(f"{file}: is not the file of run {path}")


def _ordered(table: xr.Dataset, kind: Kind) -> xr.Dataset:
    """The table with its columns in reading order."""
    names = [str(name) for name in table.data_vars]
    beside = table.attrs.get("beside", "").split()
    return table[reading_order(names, table.attrs["quantity"], beside, kind.as_built)]


def _titled(table: xr.Dataset, title: str) -> xr.Dataset:
    """The table with its title, the conventions and `KEPT` as attributes."""
    kept = {key: table.attrs[key] for key in KEPT if key in table.attrs}
    table.attrs = {"title": title, "Conventions": CONVENTIONS, **kept}
    return table


def write_table(
    table: xr.Dataset,
    nc: str | Path,
    csv: str | Path,
    md: str | Path,
    markdown: Callable[[xr.Dataset], str] = markdown_table,
) -> None:
    """Write a table as NetCDF, CSV and Markdown, each whole or not at all."""
    write_dataset(table, nc, sidecar=False)
    write_text(Path(csv), csv_table(table))
    write_text(Path(md), markdown(table))


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
