"""A dataset against its own provenance: the run is computed anew from what the file says."""

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.netcdf import read_dataset
from granstudy.reading.provenance import described_scene, described_solver
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.execute import execute, failed_dataset, made
from granstudy.runs.refinement import refined
from granstudy.runs.run_key import run_key

NAMES = {"scene", "restitution"}
"""Coordinates that name functions: by the file of the user, which the dataset does not need."""


@dataclass(frozen=True)
class Verdict:
    """What came of computing a run anew.

    Attributes
    ----------
    same_code : bool
        Whether the code is still that which computed the file.
    differences : dict of float
        Of variables that are not equal bit for bit: the largest difference over the largest value; infinite
        where they cannot be compared.
    """

    same_code: bool
    differences: dict[str, float]

    @property
    def largest(self) -> float:
        """The largest of the differences, 0 where all is equal."""
        return max(self.differences.values(), default=0.0)


def verify_dataset(path: str | Path, run_code: bool = False, threads: int = 1) -> Verdict:
    """Compute a run's dataset anew from its own provenance, and compare.

    Parameters
    ----------
    path : str or Path
        The file of a run.
    run_code : bool
        Whether the user's code that the file holds may run.
    threads : int
        Threads of the computation.

    Raises
    ------
    DamagedFileError
        If the file is damaged.
    ValueError
        If the file does not say what computed it, or holds code of the user and ``run_code`` is False.
    """
    ds = read_dataset(path)
    computation = computation_of(ds, run_code)
    anew = made(
        lambda: (
            execute(computation, threads)
            if computation.refinement is None
            else refined(computation, lambda rung: execute(rung, threads))
        ),
        lambda reason: failed_dataset(computation, reason),
    )
    return Verdict(run_key(computation) == ds.attrs.get("run_key"), _differences(ds, anew))


def computation_of(ds: xr.Dataset, run_code: bool = False) -> Computation:
    """The run that a dataset says that it is.

    Raises
    ------
    ValueError
        If the dataset does not say it, or holds code of the user and ``run_code`` is False.
    """
    said = ds.attrs.get("parameters")
    if said is None:
        raise ValueError(
            "the dataset has no attribute 'parameters', and does not say what computed it"
        )
    parameters = json.loads(said)
    scene = described_scene(ds, json.loads(ds.attrs["scene"]), run_code)
    ladder = parameters.get("refinement")
    return Computation(
        parameters["run"],
        scene,
        described_solver(parameters["solver"]),
        parameters["time"],
        refinement=None if ladder is None else _refinement(ladder),
    )


def _refinement(said: dict[str, Any]) -> Refinement:
    over = next(name for name in ("N", "R") if name in said)
    return Refinement(over, tuple(said[over]), said["temperature"], said["a2"])


def _differences(ds: xr.Dataset, anew: xr.Dataset) -> dict[str, float]:
    """Largest relative difference of each variable that is not equal bit for bit.

    Infinite where shapes, texts, or the places of NaN differ.
    """
    found = {}
    for name in sorted({*map(str, ds.variables), *map(str, anew.variables)} - NAMES):
        difference = _difference(ds.get(name), anew.get(name))
        if difference is not None:
            found[name] = difference
    if ds["status"].attrs.get("reason", "") != anew["status"].attrs.get("reason", ""):
        found["status"] = math.inf
    return found


def _difference(one: xr.DataArray | None, other: xr.DataArray | None) -> float | None:
    """Largest difference over the largest value; None where both are equal bit for bit."""
    if one is None or other is None or one.shape != other.shape:
        return math.inf
    a, b = one.values, other.values
    if a.dtype.kind not in "fiu":
        return None if np.array_equal(a, b) else math.inf
    if a.dtype == b.dtype and a.tobytes() == b.tobytes():
        return None
    finite = np.isfinite(a)
    if (
        not np.array_equal(a[~finite], b[~finite], equal_nan=True)
        or not np.isfinite(b[finite]).all()
    ):
        return math.inf
    scale = float(np.max(np.abs(a[finite]), initial=0.0)) or 1.0
    return float(np.max(np.abs(a[finite] - b[finite]), initial=0.0)) / scale
