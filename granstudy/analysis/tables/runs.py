"""Tables of evolutions, collisions and benchmarks."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granstudy.analysis.columns import DERIVED, computed
from granstudy.analysis.source import Row, TableSource
from granstudy.analysis.tables.fits import FITS
from granstudy.datasets.netcdf import read_dataset, run_seconds
from granstudy.datasets.open_runs import final_values
from granstudy.model.identity import coordinate
from granstudy.model.methods import METHODS
from granstudy.particles.dataset import time_average
from granstudy.study.schema.experiment import AverageModel, EvolutionExperiment
from granstudy.support.errors import unknown_name
from granstudy.support.variables import Variable, labelled
from granstudy.trust.flags import Status

BESIDE = ("temperature_error", "temperature", "temperature_standard_error", "density_drift")
"""Columns of an evolution's table beside its quantity, where the runs have them."""

AVERAGE_DIGITS = {"": ".6f", "_standard_error": ".1e"}
"""Formats of averages over time, and of their standard errors, by the ending of the column's name."""


def evolution_table(source: TableSource) -> xr.Dataset:
    """Moments and errors at the final time, or averages over time where the study file asks for them.

    Columns: the quantity with its standard error, averages, `BESIDE`, variables that a fit stands beside,
    `status`. A run that ended early has NaN for its numbers.

    Raises
    ------
    ValueError
        If the runs do not have the quantity.
    """
    assert isinstance(source.experiment, EvolutionExperiment)
    asked, fit, rows = source.experiment.table, source.experiment.fit, source.rows
    averages = _averages(rows, asked.average) if asked and asked.average else {}
    last = final_values([row.file for row in rows])
    last = last[[name for name, v in last.data_vars.items() if v.dims == ("run",)]]
    check_quantity(source.quantity, last)
    ended = last["status"] == Status.OK
    last = last.map(lambda v: v.where(ended) if v.dtype.kind == "f" else v, keep_attrs=True)
    last = last.assign(averages)
    beside = (*BESIDE, *(FITS[fit.law].beside if fit else ()))
    shown = (source.quantity, f"{source.quantity}_standard_error", *averages, *beside, "status")
    return with_swept(last[[name for name in dict.fromkeys(shown) if name in last]], rows)


def collision_table(source: TableSource) -> xr.Dataset:
    """Largest difference of Q from each run's reference, on all grid points."""
    rows, files = source.rows, source.by_path
    error, scale = np.empty((2, len(rows)))
    references: dict[str, xr.DataArray] = {}
    for i, (run, file) in enumerate(rows):
        path = files[run.reference.path]
        if path not in references:
            # One at a time, so that memory does not grow with their number.
            references = {path: read_dataset(path)["Q"]}
        reference = references[path]
        error[i] = abs(read_dataset(file)["Q"] - reference).max()
        scale[i] = abs(reference).max()
    table = final_values([file for _, file in rows])[["status"]]
    for name, values in (("collision_error", error), ("relative_error", error / scale)):
        table[name] = computed(name, values)
    return with_swept(table, rows)


def benchmark_table(source: TableSource) -> xr.Dataset:
    """A benchmark's dataset, which has a row for each run and number of threads."""
    (file,) = source.files
    table = read_dataset(file)
    table.attrs["swept"] = " ".join(
        str(name) for name, c in table.coords.items() if c.dims == ("run",)
    )
    return table


def check_quantity(quantity: str, table: xr.Dataset) -> None:
    """Raise ValueError unless a table has this column of real numbers."""
    numbers = [str(name) for name, v in table.data_vars.items() if v.dtype.kind == "f"]
    if quantity not in numbers:
        raise unknown_name("quantity", quantity, numbers)


def with_swept(table: xr.Dataset, rows: Sequence[Row]) -> xr.Dataset:
    """Keep swept parameters along ``run``; one value of each other one."""
    swept = [coordinate(key) for key, _ in rows[0].run.values]
    if "M_sph" in swept and "N_theta" in table.coords and (table["N_theta"] > 0).any():
        swept[swept.index("M_sph") + 1 : swept.index("M_sph") + 1] = ["N_theta", "N_phi"]
    along = [str(name) for name, c in table.coords.items() if c.dims == ("run",)]
    others = {name: table[name].values for name in along if name not in swept}
    table = table.drop_vars(list(others)).assign_coords(
        {name: values[0] for name, values in others.items() if np.unique(values).size == 1}
    )
    table.attrs["swept"] = " ".join(swept)
    return table


def with_seconds(table: xr.Dataset, rows: Sequence[Row]) -> xr.Dataset:
    """Add the wall time of every run."""
    seconds = [run_seconds(file) for _, file in rows]
    return table.assign(seconds=computed("seconds", seconds))


def _averages(rows: Sequence[Row], asked: AverageModel) -> dict[str, Variable]:
    """Averages over time in place of last values, with their standard errors over batches."""
    for run, _ in rows:
        if not run.solver.traits.by_particles:
            names = " and ".join(repr(name) for name, m in METHODS.items() if m.by_particles)
            raise ValueError(f"table.average: only method {names} has it, not {run.path}")
    datasets = [read_dataset(file) for _, file in rows]
    variables = {}
    for name in asked.of:
        means, errors = np.array([time_average(ds, name, asked.start) for ds in datasets]).T
        long_name = f"{name}, averaged from t = {asked.start:g} on"
        for ending, values in (("", means), ("_standard_error", errors)):
            text = DERIVED[ending].long_name.format(of=long_name) if ending else long_name
            variables[name + ending] = labelled(values, text, "run", format=AVERAGE_DIGITS[ending])
    return variables
