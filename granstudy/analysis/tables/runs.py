"""Tables of evolutions, collisions and benchmarks."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from granstudy.analysis.columns import DERIVED, computed
from granstudy.analysis.source import Row, TableSource
from granstudy.analysis.tables.fits import FITS
from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.open_runs import final_values
from granstudy.datasets.parameters import ABSENT
from granstudy.model.identity import coordinate
from granstudy.model.methods import METHODS
from granstudy.particles.dataset import BY_BATCH, time_average
from granstudy.study.run import Run, canonical, swept_words
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
    asked, rows = source.experiment.table, source.rows
    averages = _averages(rows, asked.average) if asked and asked.average else {}
    return evolution_columns(source, final_values([row.file for row in rows]), averages)


def evolution_columns(
    source: TableSource, last: xr.Dataset, averages: Mapping[str, Variable]
) -> xr.Dataset:
    """The table of an evolution, from the values of its runs at their ends; parts as of `evolution_table`."""
    fit, rows = source.experiment.fit, source.rows
    last = last[[name for name, v in last.data_vars.items() if v.dims == ("run",)]]
    check_quantity(source.quantity, last)
    ended = last["status"] == Status.OK
    last = last.map(lambda v: v.where(ended) if v.dtype.kind == "f" else v, keep_attrs=True)
    last = last.assign(averages)
    beside = (*BESIDE, *(FITS[fit.law].beside if fit and fit.law in FITS else ()))
    own = (source.quantity, f"{source.quantity}_standard_error")
    shown = (*own, *averages, *beside, "trust", "status")
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
    return collision_columns(source, final_values([file for _, file in rows]), error, scale)


def collision_columns(
    source: TableSource, last: xr.Dataset, error: np.ndarray, scale: np.ndarray
) -> xr.Dataset:
    """The table of collisions, from largest differences of Q and largest Q; as of `collision_table`."""
    rows, table = source.rows, last[["status"]]
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
    words = swept_words(run for run, _ in rows)
    swept = [coordinate(word) for word in words]
    if "M_sph" in swept and "N_theta" in table.coords and (table["N_theta"] > 0).any():
        swept[swept.index("M_sph") + 1 : swept.index("M_sph") + 1] = ["N_theta", "N_phi"]
    table = table.assign_coords(
        {
            coordinate(word): ("run", _as_coordinate([_swept_value(run, word) for run, _ in rows]))
            for word in words
            if coordinate(word) not in table.coords
        }
    )
    along = [str(name) for name, c in table.coords.items() if c.dims == ("run",)]
    others = {name: table[name].values for name in along if name not in swept}
    table = table.drop_vars(list(others)).assign_coords(
        {name: values[0] for name, values in others.items() if np.unique(values).size == 1}
    )
    table.attrs["swept"] = " ".join(swept)
    return table


def _swept_value(run: Run, word: str) -> Any:
    """A run's value of a swept word; where its block does not sweep it, what stands for none."""
    return dict(run.values).get(word, ABSENT.get(coordinate(word), ""))


def _as_coordinate(values: Sequence[Any]) -> np.ndarray:
    """Values of a word that datasets have no coordinate of: numbers, or texts where one is none."""
    if all(isinstance(value, int | float) for value in values):
        return np.array(values)
    return np.array([canonical(value) for value in values], dtype=object)


def check_average(rows: Sequence[Row], asked: AverageModel) -> None:
    """Raise ValueError unless the runs have batches to average, of what is asked for, up to late enough."""
    for run, _ in rows:
        if not run.solver.traits.by_particles:
            names = " and ".join(repr(name) for name, m in METHODS.items() if m.by_particles)
            raise ValueError(f"table.average: only method {names} has it, not {run.path}")
        assert run.time is not None
        if asked.start > run.time.t_final:
            raise ValueError(
                f"table.average.start={asked.start!r}: must be t_final={run.time.t_final!r} at most"
            )
    for name in asked.of:
        if name not in BY_BATCH:
            raise ValueError(f"table.average.of: {unknown_name('moment', name, BY_BATCH)}")


def _averages(rows: Sequence[Row], asked: AverageModel) -> dict[str, Variable]:
    """Averages over time in place of last values, with their standard errors over batches."""
    check_average(rows, asked)
    datasets = [read_dataset(file) for _, file in rows]
    variables = {}
    for name in asked.of:
        means, errors = np.array([time_average(ds, name, asked.start) for ds in datasets]).T
        long_name = f"{name}, averaged from t = {asked.start:g} on"
        for ending, values in (("", means), ("_standard_error", errors)):
            text = DERIVED[ending].long_name.format(of=long_name) if ending else long_name
            variables[name + ending] = labelled(values, text, "run", format=AVERAGE_DIGITS[ending])
    return variables
