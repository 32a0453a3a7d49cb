"""Labelled datasets of runs, and NetCDF files that appear whole or not at all."""

import json
import subprocess
from collections.abc import Sequence
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granstudy.evolution.times import TimeSettings
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.trust.flags import Status
from granstudy.velocity.space import VelocitySpace

CONVENTIONS = "CF-1.11"
LIBRARIES = ("granstudy", "numpy", "scipy", "pyfftw", "numba", "xarray")


def run_coordinates(
    scene: Scene, solver: Solver, settings: TimeSettings | None = None
) -> dict[str, Any]:
    """Every parameter of a run as a scalar coordinate under the paper's symbol, in a path's order."""
    coordinates: dict[str, Any] = {}
    if callable(scene.restitution):
        coordinates["restitution"] = repr(scene.restitution)
    else:
        coordinates["e"] = float(scene.restitution)
    coordinates |= {
        "exponent": scene.kernel.exponent,
        "epsilon": float(scene.diffusion),
        "N": solver.N,
        "R": solver.R,
    }
    if solver.method == "dsmc":
        return coordinates | {
            "particles": solver.particles,
            "batches": solver.batches,
            "seed": solver.seed,
            "method": solver.method,
        }
    coordinates |= _quadrature_coordinates(scene, solver)
    coordinates |= {"variant": solver.variant, "method": solver.method}
    if solver.rtol is None:
        if scene.dim == 3:
            coordinates["sphere_rule"] = solver.sphere_rule
        coordinates["radial_rule"] = solver.radial_rule
    coordinates |= {"dealias": solver.dealias, "precision": solver.precision}
    if solver.device != "cpu":
        coordinates["device"] = solver.device
    if settings is not None:
        coordinates |= settings.coordinates()
    return coordinates


def _quadrature_coordinates(scene: Scene, solver: Solver) -> dict[str, Any]:
    """The tolerance, or the sizes that it takes the place of."""
    if solver.rtol is not None:
        return {"rtol": float(solver.rtol)}
    coordinates: dict[str, Any] = {"N_rho": -1 if solver.N_rho is None else solver.N_rho}
    if scene.dim == 3:
        coordinates["M_sph"] = int(np.prod(solver.M_sph))
        if isinstance(solver.M_sph, (tuple, list)):
            coordinates["N_theta"], coordinates["N_phi"] = solver.M_sph
    else:
        coordinates["M_cir"] = solver.M_cir
    return coordinates


def kept_densities(
    grid: VelocitySpace, snapshots: dict[float, np.ndarray], rescaled: bool
) -> xr.Dataset:
    """The densities f kept, or g over c in place of v."""
    name, long_name = (
        ("g", "density g = θ^d f over c = (v−u)/θ") if rescaled else ("f", "velocity density f")
    )
    values = np.array(list(snapshots.values()))
    attributes = {"long_name": long_name, "units": "1"}
    times = ("snapshot", list(snapshots), {"long_name": "time t", "units": "1"})
    ds = xr.Dataset(
        {name: (("snapshot", *grid.axes), values, attributes)},
        coords=grid.coordinates() | {"snapshot": times},
    )
    return on_scaled_velocities(ds, grid.axes) if rescaled else ds


def on_scaled_velocities(ds: xr.Dataset, axes: tuple[str, ...]) -> xr.Dataset:
    """The dataset with a grid's ``axes`` named as velocities c = (v−u)/θ, not v."""
    scaled = {axis: f"c{axis[1:]}" for axis in axes}
    ds = ds.rename(scaled | ({"r_weight": "c_weight"} if "r_weight" in ds else {}))
    for axis in scaled.values():
        ds[axis].attrs["long_name"] = f"scaled velocity {axis} of c = (v−u)/θ"
    return ds


def stamped(
    ds: xr.Dataset,
    scene: Scene,
    solver: Solver,
    settings: TimeSettings | None,
    status: Status,
    reason: str,
    warnings: list[str],
    title: str,
    plans: Sequence[dict[str, Any]],
) -> xr.Dataset:
    """The dataset with its status, every parameter as a coordinate, and what made it as attributes."""
    ds["status"] = (
        (),
        np.int8(status),
        {
            "long_name": "how the run ended",
            "flag_values": np.array([s.value for s in Status], dtype=np.int8),
            "flag_meanings": " ".join(s.name.lower() for s in Status),
            "reason": reason,
            "warnings": "\n".join(warnings),
        },
    )
    ds = ds.assign_coords(run_coordinates(scene, solver, settings))
    ds.attrs = {
        "title": f"granstudy {title}",
        "Conventions": CONVENTIONS,
        "history": f"granstudy {version('granstudy')}",
        "scene": json.dumps(scene.describe(), sort_keys=True),
        "solver": json.dumps(solver.describe(), sort_keys=True),
        "versions": json.dumps({name: version(name) for name in LIBRARIES}, sort_keys=True),
        "git_commit": git_commit(),
    }
    if plans:
        ds.attrs["quadrature"] = json.dumps(list(plans), sort_keys=True)
    return ds


@cache
def git_commit() -> str:
    """Commit of the checkout that the package runs from, or "" outside one."""
    try:
        answer = subprocess.run(
            ["git", "rev-parse", "HEAD"],
            cwd=Path(__file__).parents[1],
            capture_output=True,
            text=True,
            check=True,
        )
    except (OSError, subprocess.CalledProcessError):
        return ""
    return answer.stdout.strip()
