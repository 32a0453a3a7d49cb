"""Execute runs of a study and write their datasets."""

import shutil
import time
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import xarray as xr

from granstudy.datasets.netcdf import read_dataset, write_dataset
from granstudy.study.kinds import KINDS
from granstudy.study.run import Run
from granstudy.study.run_key import run_key
from granstudy.support.files import write_whole


def execute(run: Run, threads: int) -> xr.Dataset:
    """Compute a run with so many threads.

    A run that ends early is a dataset too, with its status: nothing computed is lost.

    Raises
    ------
    ValueError
        For a benchmark's run: those are computed together (`granstudy.study.benchmark.benchmark`).
    """
    compute = KINDS[run.model.run].compute
    if compute is None:
        raise ValueError(f"run={run.model.run!r}: all runs of an experiment are computed together")
    return compute(run, replace(run.solver, threads=threads))


def execute_job(
    runs: Sequence[Run],
    keys: Sequence[str],
    paths: Sequence[str | Path],
    threads: int,
    unfinished: str | Path,
) -> None:
    """Execute the runs of a job one after the other and write each dataset to its path.

    A path that already holds the dataset of its key is left alone. Until all are done, a copy of each
    lies in the folder ``unfinished``, as Snakemake deletes the outputs of a job that fails: the next
    attempt goes on where this one stopped.

    Parameters
    ----------
    keys : sequence of str
        `granstudy.study.run_key.run_key` of every run, stored as the dataset's attribute.

    Raises
    ------
    ValueError
        If the key of a run to compute is another one: what it depends on changed since the workflow started.
    """
    copies = [Path(unfinished) / f"{key}.nc" for key in keys]
    for run, key, path, copy in zip(runs, keys, map(Path, paths), copies, strict=True):
        if _holds(path, key):
            continue
        if _holds(copy, key):
            write_whole(path, partial(shutil.copyfile, copy))
            continue
        if run_key(run) != key:
            raise ValueError(
                f"{run.path}: the study or the code changed since the workflow started; start it again"
            )
        start = time.perf_counter()
        ds = execute(run, threads).assign_attrs(run_key=key)
        write_dataset(ds, path, duration=time.perf_counter() - start)
        if len(runs) > 1:
            write_whole(copy, partial(shutil.copyfile, path))
    for copy in copies:
        copy.unlink(missing_ok=True)


def _holds(path: Path, key: str) -> bool:
    """Whether ``path`` is the whole, undamaged dataset of that key."""
    try:
        return bool(read_dataset(path).attrs.get("run_key") == key)
    except (OSError, ValueError):
        return False
