"""Tables of runs beside their truth: errors of T and a2, the runs' own estimates, their labels."""

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from granstudy.analysis.columns import computed
from granstudy.analysis.source import TableSource
from granstudy.analysis.tables.runs import with_swept
from granstudy.datasets.netcdf import read_dataset, run_seconds
from granstudy.datasets.open_runs import final_values
from granstudy.study.run import Run
from granstudy.study.schema.experiment import EvolutionExperiment, TruthModel
from granstudy.support.variables import attributes
from granstudy.trust.truth import Truth, errors, maxwell_truth, truth_of_dataset

MEASURES = (
    "largest_temperature_error",
    "temperature_error_estimate",
    "largest_a2_error",
    "a2_error_estimate",
)
"""Errors of T and of a2, each with the run's own estimate of it."""

AT_THE_END = {
    "temperature": "T at the last time reached",
    "a2": "kurtosis excess at the last time reached",
}
"""Long names of moments; a run that diverged has them up to there."""


KNOWN_TO = ("temperature_known_to", "a2_known_to")
"""Attributes of the table: how well T, relative, and a2 are known by the worst of its truths."""


def truth_table(source: TableSource) -> xr.Dataset:
    """A row for each run: `MEASURES`, label, T and a2 at the end, `status`, seconds if asked for.

    The attribute `truth` names the truths, and how well T and a2 are known by them, of which `KNOWN_TO` are
    the numbers.
    """
    rows, files = source.rows, source.by_path
    table = final_values([row.file for row in rows])[[*AT_THE_END, "trust", "status"]]
    columns: dict[str, list[float]] = {name: [] for name in MEASURES}
    truths: list[Truth] = []
    for run, file in rows:
        ds = read_dataset(file)
        if "time" not in ds:  # it failed before its first output
            for values in columns.values():
                values.append(np.nan)
            continue
        truth = truth_of(run, files, ds["time"].values)
        found = errors(ds, truth)
        columns["largest_temperature_error"].append(found.temperature)
        columns["largest_a2_error"].append(found.a2)
        for name in ("temperature_error_estimate", "a2_error_estimate"):
            columns[name].append(float(ds[name].max()) if ds.sizes["time"] else np.nan)
        truths.append(truth)
    if wants_seconds(source):
        columns["seconds"] = [run_seconds(file) for _, file in rows]
    known = list(dict.fromkeys(map(_known, truths)))
    table = truth_columns(source, table, columns, known)
    uncertain = [(truth.temperature_uncertainty, truth.a2_uncertainty) for truth in truths]
    worst = np.max(np.reshape(uncertain, (-1, 2)), axis=0, initial=0.0)
    table.attrs |= dict(zip(KNOWN_TO, worst.tolist(), strict=True))
    return table


def wants_seconds(source: TableSource) -> bool:
    """Whether the table has the wall time of every run."""
    assert isinstance(source.experiment, EvolutionExperiment)
    asked = source.experiment.table
    return asked is not None and asked.seconds


def truth_columns(
    source: TableSource,
    table: xr.Dataset,
    measures: Mapping[str, Sequence[float]],
    truths: Sequence[str],
) -> xr.Dataset:
    """The table of runs beside a truth, from last values, `MEASURES` and the truths; as of `truth_table`."""
    for name, values in measures.items():
        table[name] = computed(name, values)
    for name, long_name in AT_THE_END.items():
        table[name].attrs = attributes(long_name)
    table = with_swept(table, source.rows)
    table.attrs["truth"] = "; ".join(truths)
    return table


def truth_model(run: Run) -> TruthModel:
    """The study file's section on a run's truth."""
    assert isinstance(run.model, EvolutionExperiment) and run.model.truth is not None
    return run.model.truth


def truth_of(run: Run, files: Mapping[str, str], times: np.ndarray) -> Truth:
    """The truth that a run is held against.

    Parameters
    ----------
    run : Run
        A run of an experiment with a truth.
    files : dict of str
        Files of the experiment's runs, its truths among them, by path.
    times : ndarray
        Times at which an exact law is evaluated; a run that serves as truth has its own.
    """
    if truth_model(run).law is not None:
        return maxwell_truth(run.scene, times)
    return truth_of_dataset(read_dataset(files[run.truth.path]))


def _known(truth: Truth) -> str:
    """Write a truth's source, and how well T and a2 are known by it."""
    if not truth.temperature_uncertainty:
        return truth.source
    T, a2 = truth.temperature_uncertainty, truth.a2_uncertainty
    return f"{truth.source} (T known to {T:.1e}, a2 to {a2:.1e})"
