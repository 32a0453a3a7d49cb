"""The scene, the kernel and the solver that a dataset says it was computed with."""

import ast
import hashlib
import json
import linecache
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.parameters import ABSENT
from granstudy.model.densities import INITIAL_DENSITIES, density_parameters, named_density
from granstudy.model.identity import code, coordinate
from granstudy.model.kernel import VHS
from granstudy.model.load_scene import load_scene
from granstudy.model.own_functions import own_density, own_law
from granstudy.model.restitution import LAWS, law_parameters
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.velocity.symmetry import NAMED, Symmetry


def scene_of(ds: xr.Dataset, run_code: bool = False) -> Scene:
    """The scene of a run, from its file.

    Raises
    ------
    ValueError
        If the dataset has runs of several scenes, does not say which, or holds code of the user and
        ``run_code`` is False.
    """
    if "scene" in ds.attrs:
        return described_scene(ds, json.loads(ds.attrs["scene"]), run_code)
    _check_one(ds, ("scene", "e", "restitution", "exponent", "strength", "diffusion"), "scene")
    words = {name: _one(ds, name) for name in ("exponent", "strength", "diffusion")}
    density = str(_one(ds, "scene"))
    if density not in INITIAL_DENSITIES:
        raise ValueError(
            f"scene={density!r}: is a density of one's own, and runs of several scenes keep no code; open "
            "its one file"
        )
    law = str(_one(ds, "restitution")) if "restitution" in ds.coords else ""
    if law:
        words |= {"restitution": law} | {key: _one(ds, key) for key in law_parameters(law)}
    else:
        words["e"] = _one(ds, "e")
    names = [field.name for field in density_parameters(density)]
    return load_scene(density, **words, **{key: _one(ds, coordinate(key)) for key in names})


def solver_of(ds: xr.Dataset) -> Solver:
    """The solver of a run, from its file.

    Raises
    ------
    ValueError
        If the dataset has runs of several solvers, or does not say which.
    """
    if "solver" in ds.attrs:
        return described_solver(json.loads(ds.attrs["solver"]))
    names = [n for n in Solver.__dataclass_fields__ if n in ds.coords]
    _check_one(ds, names, "solver")
    found = {name: _one(ds, name) for name in names}
    if "N_theta" in ds.coords and _one(ds, "N_theta") > 0:
        found["M_sph"] = (_one(ds, "N_theta"), _one(ds, "N_phi"))
    return Solver(**{name: value for name, value in found.items() if not _is_absent(name, value)})


def kernel_of(ds: xr.Dataset) -> VHS | xr.DataArray:
    """The kernel of a run; of runs with several kernels an array of them, over their dimensions."""
    for name in ("exponent", "strength"):
        if name not in ds.coords:
            raise ValueError(
                f"{name}: the dataset has no such coordinate, and does not say its kernel"
            )
    exponent, strength = ds["exponent"], ds["strength"]
    if exponent.ndim == strength.ndim == 0:
        return VHS(float(exponent), float(strength))
    return xr.apply_ufunc(VHS, exponent, strength, vectorize=True, output_dtypes=[object]).rename(
        "kernel"
    )


def _check_one(ds: xr.Dataset, names: Any, what: str) -> None:
    """Raise ValueError unless coordinates have one value each."""
    several = [name for name in names if name in ds.coords and np.unique(ds[name].values).size > 1]
    if several:
        raise ValueError(
            f"{what}: the runs differ in {', '.join(several)}; select one, as in ds.sel({several[0]}=..)"
        )
    if what not in ds.coords and not any(name in ds.coords for name in names):
        raise ValueError(f"{what}: the dataset does not say it; it is no run of granstudy")


def _one(ds: xr.Dataset, name: str) -> Any:
    """The one value of a coordinate, as a number or text; vectors are texts there."""
    value = np.unique(ds[name].values)[0].item()
    return (
        ast.literal_eval(value) if isinstance(value, str) and value[:1] in "([" and value else value
    )


def _is_absent(name: str, value: Any) -> bool:
    lacking = isinstance(value, float) and np.isnan(value)
    return name in ABSENT and bool(lacking or value == ABSENT[name])


def described_scene(ds: xr.Dataset, said: dict[str, Any], run_code: bool) -> Scene:
    """The scene that a run describes.

    Parameters
    ----------
    ds : xarray.Dataset
        A run; arguments of densities and laws are its coordinates.
    said : dict
        Its attribute `scene`.
    run_code : bool
        Whether the user's code that the file holds may run.

    Raises
    ------
    ValueError
        If the file holds code of the user and ``run_code`` is False.
    """
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


def described_solver(said: dict[str, Any]) -> Solver:
    """The solver that a run describes in its attribute `solver`."""
    fields: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value
        for name, value in said.items()
        if name in Solver.__dataclass_fields__
    }
    return Solver(**fields)
