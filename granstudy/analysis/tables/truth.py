"""Runs beside their truth: errors of T and a2, what the runs themselves said of them, and their labels."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.open_runs import final_values
from granstudy.study.run import Run
from granstudy.study.schema.experiment import EvolutionExperiment
from granstudy.trust.truth import Truth, errors, maxwell_truth, truth_of_dataset

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


def truth_table(rows: list[tuple[Run, str]], files: dict[str, str]) -> xr.Dataset:
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


def truth_of(run: Run, files: Mapping[str, str], times: np.ndarray) -> Truth:
    """The truth that a run is held against.

    Parameters
    ----------
    run : Run
        Of an experiment with a truth.
    files : dict of str
        Files of the experiment's runs, its truths among them, by path.
    times : ndarray
        Where an exact law is evaluated; a run that serves as truth has its own.
    """
    assert isinstance(run.model, EvolutionExperiment) and run.model.truth is not None
    if run.model.truth.law is not None:
        return maxwell_truth(run.scene, times)
    return truth_of_dataset(read_dataset(files[run.truth.path]))
