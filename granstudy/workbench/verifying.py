"""A dataset against its own provenance: the run is computed anew from what the file says."""

import ast
import hashlib
import json
import linecache
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.netcdf import read_dataset
from granstudy.model.densities import density_parameters, named_density
from granstudy.model.identity import code, coordinate
from granstudy.model.kernel import VHS
from granstudy.model.own_functions import own_density, own_law
from granstudy.model.restitution import LAWS, law_parameters
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.execute import execute, failed_dataset, made
from granstudy.runs.refinement import refined
from granstudy.runs.run_key import run_key
from granstudy.velocity.symmetry import NAMED, Symmetry

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
    scene = _scene(ds, json.loads(ds.attrs["scene"]), run_code)
    ladder = parameters.get("refinement")
    return Computation(
        parameters["run"],
        scene,
        _solver(parameters["solver"]),
        parameters["time"],
        refinement=None if ladder is None else _refinement(ladder),
    )


def _solver(said: dict[str, Any]) -> Solver:
    fields: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in said.items()
        if name in Solver.__dataclass_fields__
    }
    return Solver(**fields)


def _refinement(said: dict[str, Any]) -> Refinement:
    over = next(name for name in ("N", "R") if name in said)
    return Refinement(over, tuple(said[over]), said["temperature"], said["a2"])


def _scene(ds: xr.Dataset, said: dict[str, Any], run_code: bool) -> Scene:
    """The scene that a dataset describes."""
    initial, law = said["initial"], said["restitution"]
    own: dict[str, Any] = {}
    if isinstance(initial, dict) or isinstance(law, dict):
        if not run_code:
            raise ValueError(
                "the dataset holds code of its user (attribute 'source'); it runs only when told to: "
                "run_code=True, or --run-code"
            )
        own = _run(ds.attrs["source"])
    if isinstance(initial, dict):
        density: Any = _rebuilt(own, initial, partial(own_density, dim=said["dim"]), said["dim"])
    else:
        name = str(ds["scene"].values)
        fields = [field.name for field in density_parameters(name)]
        density = named_density(name)(**{key: _value(ds, coordinate(key)) for key in fields})
    if isinstance(law, dict):
        law = _rebuilt(own, law, own_law)
    elif isinstance(law, str):
        name = str(ds["restitution"].values)
        law = LAWS[name](**{key: _value(ds, coordinate(key)) for key in law_parameters(name)})
    kernel, symmetry = VHS(**said["kernel"]), _symmetry(said["dim"], said["symmetry"])
    return Scene(said["dim"], density, kernel, law, said["diffusion"], symmetry)


def _symmetry(dim: int, name: str) -> Symmetry:
    """A group by its name, or by its generators."""
    if name in NAMED:
        return Symmetry.named(dim, name)
    return Symmetry.generated(dim, *name.split("; "))


def _run(source: str) -> dict[str, Any]:
    """Run the source that a dataset holds; its names. Its functions are known by their content."""
    name = f"<source {hashlib.sha256(source.encode()).hexdigest()[:16]}>"
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    own = {"__name__": "__main__"}
    exec(compile(source, name, "exec"), own)
    return own


def _rebuilt(
    own: dict[str, Any], said: dict[str, Any], bind: Callable[..., Any], dim: int | None = None
) -> Any:
    """A density or law of the user: its function with the arguments, or an object of its class."""
    name = said["function"].rpartition(":")[2]
    name = "function" if name == "lambda" else name
    if name not in own:
        raise ValueError(f"{said['function']}: is not in the source that the dataset holds")
    arguments = {key: _tuples(value) for key, value in said["arguments"].items()}
    found = own[name]
    if isinstance(found, type):
        instance: Any = object.__new__(found)
        instance.__dict__.update(arguments)
        if code(instance, dim).digest == said.get("digest"):
            return instance
    return bind(found, arguments)


def _tuples(value: Any) -> Any:
    """A value as it was before it was JSON, which knows no tuples."""
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def _value(ds: xr.Dataset, name: str) -> Any:
    """An argument that a dataset has as a coordinate; vectors are texts there."""
    value = ds[name].values.item()
    return ast.literal_eval(value) if isinstance(value, str) else value


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
