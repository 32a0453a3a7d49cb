"""Runs beside their truth: errors of T and a2, what the runs themselves said of them, and their labels."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from granstudy.datasets.open_runs import final_values
from granstudy.datasets.run_dataset import read_dataset
from granstudy.trust.truth import errors, truth_of

if TYPE_CHECKING:  # a table does not depend on the solvers that the study module imports
    from granstudy.study.run import Run

COLUMNS = (
    "largest_temperature_error",
    "temperature_error_estimate",
    "largest_a2_error",
    "a2_error_estimate",
    "trust",
    "temperature",
    "a2",
)
"""What the table says of a run, beside its status."""

LONG_NAMES = {
    "largest_temperature_error": "largest |T/T_truth − 1| over the output times reached",
    "largest_a2_error": "largest |a2 − a2_truth| over the output times reached",
    "temperature_error_estimate": "largest relative error of T that the run itself estimated",
    "a2_error_estimate": "largest error of a2 that the run itself estimated",
    "temperature": "T at the last time reached",
    "a2": "kurtosis excess at the last time reached",
}


SAYS_LEAST = ("time_rtol", "sphere_rule")
"""Parameters that a label leaves out where runs can be told apart without."""


def telling_apart(table: xr.Dataset) -> list[str]:
    """The swept parameters that tell a table's runs apart."""
    swept = table.attrs["swept"].split()
    names = [name for name in swept if np.unique(table[name].values).size > 1]
    for name in SAYS_LEAST:
        fewer = [other for other in names if other != name]
        rows = {tuple(table[other].values[i] for other in fewer) for i in range(table.sizes["run"])}
        if len(rows) == table.sizes["run"]:
            names = fewer
    return names


def parameter_text(name: str, value: object, symbol: str = "") -> str:
    """A parameter as a label says it: ``N = 32``, ``rescaled``, ``conserve mass``."""
    if isinstance(value, str):
        return f"{name} {value}" if name == "conserve" else value
    return f"{symbol or name} = {value:g}"


def run_text(parameters: Mapping[str, object], symbols: Mapping[str, str] = {}) -> str:
    """Parameters of a run as a label says them; "" stands for one that the run does not have."""
    return ", ".join(
        parameter_text(name, value, symbols.get(name, ""))
        for name, value in parameters.items()
        if value != ""
    )


def truth_table(rows: "list[tuple[Run, str]]", files: dict[str, str]) -> xr.Dataset:
    """A row for each run, all parameters along ``run``; the columns are `COLUMNS` and `status`.

    Parameters
    ----------
    rows : list of (Run, str)
        Runs of an experiment with a truth, and their files.
    files : dict of str
        Files of all its runs, truths among them, by path.
    """
    with final_values([file for _, file in rows]) as final:
        table = final[["temperature", "a2", "trust", "status"]].load()
    columns: dict[str, list[float]] = {name: [] for name in COLUMNS[:4]}
    sources: dict[str, None] = {}
    for run, file in rows:
        ds = read_dataset(file)
        truth = truth_of(run, files, ds["time"].values)
        found = errors(ds, truth)
        columns["largest_temperature_error"].append(found.temperature)
        columns["largest_a2_error"].append(found.a2)
        for name in ("temperature_error_estimate", "a2_error_estimate"):
            columns[name].append(float(ds[name].max()) if ds.sizes["time"] else np.nan)
        known = (
            f" (T known to {truth.temperature_uncertainty:.1e}, a2 to {truth.a2_uncertainty:.1e})"
            if truth.temperature_uncertainty
            else ""
        )
        sources[truth.source + known] = None
    table = table.assign({name: ("run", values) for name, values in columns.items()})
    for name, long_name in LONG_NAMES.items():
        table[name].attrs = {"long_name": long_name, "units": "1"}
    table.attrs["truth"] = "; ".join(sources)
    return table
