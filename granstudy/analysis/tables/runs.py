"""Tables of evolutions, collisions and benchmarks."""

from contextlib import ExitStack
from typing import Any

import dask
import numpy as np
import xarray as xr

from granstudy.datasets.netcdf import read_dataset, run_seconds
from granstudy.datasets.open_runs import final_values
from granstudy.particles.dataset import time_average
from granstudy.study.run import Run
from granstudy.study.schema.experiment import AverageModel, EvolutionTableModel
from granstudy.trust.flags import Status

Rows = list[tuple[Run, str]]


def _evolution(rows: Rows, asked: EvolutionTableModel | None) -> xr.Dataset:
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


def _with_seconds(table: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Add how long every run took."""
    attributes = {"long_name": "wall time of the run, set-up included", "units": "s"}
    seconds = [run_seconds(file) for _, file in rows]
    return table.assign(seconds=("run", seconds, attributes | {"format": ".3g"}))


def _averages(rows: Rows, asked: AverageModel) -> dict[str, Any]:
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
