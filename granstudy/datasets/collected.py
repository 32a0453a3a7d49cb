"""Runs gathered in one file, so that they open in a second: a cache, made anew from the runs' files."""

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from granstudy.datasets.gathering import OUTPUTS, Gathered, axis_at
from granstudy.datasets.netcdf import heads, read_dataset, write_dataset
from granstudy.datasets.storage.encoding import Contents, Values, contents_of

SOURCES = ("source_size", "source_mtime_ns")
"""Variables of a collected file: size of each run's file in bytes, and its time of change in nanoseconds."""


def gather(files: Mapping[str, str | Path], collected: str | Path | None = None) -> xr.Dataset:
    """Open runs by their keys, as `open_runs` does; only files that are new or changed are read.

    Parameters
    ----------
    files : mapping
        File of each run by its run key.
    collected : str or Path, optional
        File that holds what was gathered before. It is written anew unless it holds the same runs, none of
        them changed. A damaged or foreign file is replaced: it is a cache.

    Returns
    -------
    xarray.Dataset
        The runs in the order of ``files``, with `run_key` as a coordinate along ``run``.

    Raises
    ------
    FileNotFoundError
        If there are no files, or one is missing.
    DamagedFileError
        If files of runs are damaged; the error names all of them.
    ValueError
        If a file holds the run of another key.
    """
    if not files:
        raise FileNotFoundError("no runs to gather")
    stamps = {key: _stamp(path) for key, path in files.items()}
    held = None if collected is None else read_collected(collected)
    known: dict[str, int] = {}
    if held is not None:
        sources = zip(*(held[name].values.tolist() for name in SOURCES), strict=True)
        old = dict(zip(held["run_key"].values.tolist(), enumerate(sources), strict=True))
        known = {k: old[k][0] for k, stamp in stamps.items() if k in old and old[k][1] == stamp}
        if list(known) == list(old) == list(files):
            return held.drop_vars(SOURCES)
    gathered = Gathered(len(files))
    if held is not None:
        for run in _rows(held.drop_vars(SOURCES), list(known.values())):
            gathered.add(run)
    new = {str(path): key for key, path in files.items() if key not in known}
    others = []
    for path, run in heads(new):
        key = new[path]
        if run.attrs.get("run_key", key) != key:
            others.append(f"{path} (of {run.attrs['run_key']}, not {key})")
        gathered.add(Contents({**run.attrs, "run_key": key}, run.labels, run.variables))
    if others:
        raise ValueError(
            f"files hold the runs of other keys: {', '.join(others)}; compute them again"
        )
    order = {key: row for row, key in enumerate((*known, *new.values()))}
    runs = gathered.dataset().set_coords("run_key")
    if list(order) != list(files):
        runs = runs.isel(run=[order[key] for key in files])
    if collected is not None:
        write_collected(runs, collected, [stamps[key] for key in files])
    return runs


def write_collected(runs: xr.Dataset, path: str | Path, sources: Sequence[tuple[int, int]]) -> None:
    """Write gathered runs into one file, whole or not at all, with size and time of change of their files.

    Parameters
    ----------
    runs : xarray.Dataset
        The dataset of `gather`.
    path : str or Path
    sources : sequence of (int, int)
        Size in bytes and time of change in nanoseconds of each run's file, from before it was read.
    """
    stamps = np.array(sources, dtype=np.int64).reshape(-1, len(SOURCES))
    named = {name: ("run", stamps[:, i]) for i, name in enumerate(SOURCES)}
    write_dataset(runs.assign(named), path, sidecar=False)


def read_collected(path: str | Path) -> xr.Dataset | None:
    """The runs of a collected file with `SOURCES`; None where there is none, or it cannot be used."""
    try:
        held = read_dataset(path)
    except (OSError, ValueError):
        return None
    return held if {"run_key", *SOURCES} <= set(held.variables) else None


def _stamp(path: str | Path) -> tuple[int, int]:
    """Size and time of change of a file."""
    found = os.stat(path)
    return found.st_size, found.st_mtime_ns


def _rows(runs: xr.Dataset, rows: Sequence[int]) -> Iterator[Contents]:
    """Runs of a gathered dataset one by one, as if they were read from their files."""
    held = contents_of(runs)
    outputs = runs[OUTPUTS].values if OUTPUTS in runs else np.full(runs.sizes["run"], np.nan)
    for row in rows:
        count = 0 if np.isnan(outputs[row]) else int(outputs[row])
        found = {name: _row(v, row, count) for name, v in held.variables.items() if name != OUTPUTS}
        if np.isnan(outputs[row]):
            found = {name: v for name, v in found.items() if "time" not in v[0]}
        yield Contents(held.attrs, held.labels, found)


def _row(variable: Values, row: int, outputs: int) -> Values:
    """One run's part of a variable, its times up to the last output."""
    dims, values, attrs = variable
    if "run" in dims:
        values, dims = values[row], tuple(axis_at(dim) for dim in dims if dim != "run")
    if "time" in dims:
        cut = tuple(slice(outputs) if dim == "time" else slice(None) for dim in dims)
        values = values[cut]
    return dims, np.asarray(values), attrs
