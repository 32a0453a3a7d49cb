"""A dataset against its own provenance: the run is computed anew from what the file says."""

import ast
import hashlib
import json
import linecache
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.parameters import PARAMETERS
from granstudy.model.densities import INITIAL_DENSITIES, density_parameters
from granstudy.model.identity import coordinate
from granstudy.model.load_scene import load_scene
from granstudy.model.restitution import law_parameters
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.execute import execute
from granstudy.runs.refinement import refined
from granstudy.runs.run_key import run_key


@dataclass(frozen=True)
class Verdict:
    """What came of computing a run anew.

    Attributes
    ----------
    same_code : bool
        Whether the code is still that which computed the file.
    differences : dict of float
        Of variables that are not equal bit for bit: the largest difference over the largest value.
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
    anew = (
        execute(computation, threads)
        if computation.refinement is None
        else refined(computation, lambda rung: execute(rung, threads))
    )
    key = ds.attrs.get("run_key")
    return Verdict(run_key(computation) == key, _differences(ds, anew))


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
    own: dict[str, Any] = {}
    if any(isinstance(said[part], dict) for part in ("initial", "restitution")):
        if not run_code:
            raise ValueError(
                "the dataset holds code of its user (attribute 'source'); it runs only when told to: "
                "run_code=True, or --run-code"
            )
        _run(ds.attrs["source"], own)
    kernel = said["kernel"]
    words: dict[str, Any] = {
        "exponent": kernel["exponent"],
        "strength": kernel["strength"],
        "diffusion": said["diffusion"],
    }
    name: Any = str(ds["scene"].values)
    if isinstance(said["initial"], dict):
        name = _function(own, said["initial"]["function"])
        words |= {"dim": said["dim"], **_given(said["initial"]["arguments"])}
    elif name in INITIAL_DENSITIES:
        parameters = [field.name for field in density_parameters(name)]
        words |= {key: _value(ds, coordinate(key)) for key in parameters}
    law = said["restitution"]
    if isinstance(law, dict):
        words["restitution"] = _function(own, law["function"])
        words |= _given(law["arguments"])
    elif isinstance(law, str):
        words["restitution"] = str(ds["restitution"].values)
        words |= {key: _value(ds, key) for key in law_parameters(words["restitution"])}
    else:
        words["e"] = law
    scene = load_scene(name, **words)
    return scene if scene.symmetry.name == said["symmetry"] else _with_symmetry(scene, said)


def _with_symmetry(scene: Scene, said: dict[str, Any]) -> Scene:
    """The scene with the symmetry that was declared for it."""
    return Scene(
        scene.dim,
        scene.initial,
        scene.kernel,
        scene.restitution,
        scene.diffusion,
        symmetry=said["symmetry"],
    )


def _run(source: str, own: dict[str, Any]) -> None:
    """Run a dataset's source; its lines are known as a file's are, so that the code has its digest."""
    name = f"<source {hashlib.sha256(source.encode()).hexdigest()[:16]}>"
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    exec(compile(source, name, "exec"), own)


def _function(own: dict[str, Any], reference: str) -> Any:
    """A function of the user's code by its name, with or without the file's."""
    name = reference.rpartition(":")[2]
    if name not in own:
        raise ValueError(f"{reference}: is not in the source that the dataset holds")
    return own[name]


def _given(arguments: dict[str, Any]) -> dict[str, Any]:
    return {key: tuple(v) if isinstance(v, list) else v for key, v in arguments.items()}


def _value(ds: xr.Dataset, name: str) -> Any:
    """An argument that a dataset has as a coordinate; vectors are texts there."""
    value = ds[name].values.item()
    return ast.literal_eval(value) if isinstance(value, str) else value


def _differences(ds: xr.Dataset, anew: xr.Dataset) -> dict[str, float]:
    """Largest relative difference of each variable that is not equal bit for bit; 1 where shapes differ."""
    found = {}
    for name in sorted({*map(str, ds.variables), *map(str, anew.variables)} - PARAMETERS.keys()):
        if name not in ds or name not in anew or ds[name].shape != anew[name].shape:
            found[name] = 1.0
            continue
        a, b = ds[name].values, anew[name].values
        if a.dtype.kind not in "fiu":
            found |= {} if np.array_equal(a, b) else {name: 1.0}
        elif a.tobytes() != b.tobytes():
            scale = float(np.nanmax(np.abs(a), initial=0.0)) or 1.0
            found[name] = float(np.nanmax(np.abs(a - b), initial=0.0)) / scale
    return found
