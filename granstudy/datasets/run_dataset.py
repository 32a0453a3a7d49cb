"""Labelled datasets of runs, and NetCDF files that appear whole or not at all."""

import hashlib
import json
import platform
import subprocess
from collections.abc import Hashable, Sequence
from datetime import UTC, datetime
from enum import IntEnum
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.evolution.times import TimeSettings
from granstudy.model.kernel import sphere_area
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.files import write_whole
from granstudy.trust.health import Trust, verdict
from granstudy.velocity.moments import COMPONENTS, DIMENSIONS, FRAME_LONG_NAMES, LONG_NAMES
from granstudy.velocity.space import VelocitySpace

CONVENTIONS = "CF-1.11"
LIBRARIES = ("granstudy", "numpy", "scipy", "pyfftw", "numba", "xarray")

BY_BATCH = ("temperature", "a2")
"""Moments of which a simulation by particles keeps every batch's value."""


class Status(IntEnum):
    """How a run ended; MISSING stands in arrays over parameters where there is no run."""

    MISSING = -1
    OK = 0
    FAILED = 1
    DIVERGED = 2


FLAGS: dict[str, type[IntEnum]] = {"status": Status, "trust": Trust}
"""What the numbers of a flag variable mean."""


def flag_word(name: str, value: Any) -> str:
    """What a flag says, ``ok`` or ``trusted``."""
    return FLAGS[name](int(value)).name.lower()


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


def evolution_dataset(
    scene: Scene,
    solver: Solver,
    settings: TimeSettings,
    grid: VelocitySpace,
    times: list[float],
    history: list[dict[str, Any]],
    snapshots: dict[float, np.ndarray],
    status: Status,
    reason: str,
    warnings: list[str],
    plans: Sequence[dict[str, Any]] = (),
    health_outputs: Sequence[dict[str, float]] = (),
) -> xr.Dataset:
    """Dataset of a simulation: moments over ``time``, densities over ``snapshot``, status.

    ``times`` are those of ``history``. A rescaled run has the frame's θ, u and τ over ``time``, too, and
    keeps g over the scaled velocities in place of f.

    Where an exact temperature law is known (Maxwell molecules, constant e) it holds two references and
    two errors: `temperature_error`, of the temperature divided by the density, against the law with that
    density; and `paper_temperature_error`, the paper's measure, of 2E/d against the law of unit density.
    Both laws start from the discrete initial value. ``plans`` are the quadratures that a tolerance came to,
    each with the time it was in use from; they become the attribute `quadrature`. ``health_outputs``, those
    of the run's `granstudy.trust.error_estimate.Examination`, become variables over ``time`` and the label `trust`.
    """
    rescaled = settings.frame == "rescaled"
    time = np.array(times)
    components = list(COMPONENTS[: grid.dim])
    data: dict[str, Any] = {
        name: (
            ("time", *DIMENSIONS.get(name, ())),
            np.array([values[name] for values in history]),
            {"long_name": long_name, "units": "1"},
        )
        for name, long_name in (LONG_NAMES | (FRAME_LONG_NAMES if rescaled else {})).items()
    }
    ds = xr.Dataset(
        data,
        coords={
            "time": ("time", time, {"long_name": "time t", "units": "1"}),
            "component": components,
            "component_": components,
        },
    )
    _add_exact_law(ds, scene)
    if snapshots:
        ds = ds.assign(_densities(grid, snapshots, rescaled))
    ds = ds.assign(_health(health_outputs, reason))
    return _finish(ds, scene, solver, settings, status, reason, warnings, "evolution", plans)


def _health(outputs: Sequence[dict[str, float]], stopped: str) -> dict[str, Any]:
    """What was measured at every output, and the label that comes of it."""
    variables: dict[str, Any] = {
        variable: (
            "time",
            [output[name] for output in outputs],
            {"long_name": long_name, "units": "1"},
        )
        for name, (variable, long_name) in HEALTH_NAMES.items()
        if outputs and name in outputs[-1]
    }
    return variables | _trust(outputs, stopped)


def _trust(outputs: Sequence[dict[str, float]], stopped: str) -> dict[str, Any]:
    """The label that health comes to, and why."""
    trust, reasons = verdict(outputs, stopped)
    return {
        "trust": (
            (),
            np.int8(trust),
            {
                "long_name": "how far temperature and kurtosis can be trusted",
                "flag_values": np.array([t.value for t in Trust], dtype=np.int8),
                "flag_meanings": " ".join(t.name.lower() for t in Trust),
                "reasons": "\n".join(reasons),
            },
        )
    }


HEALTH_NAMES = {
    "temperature": ("temperature_error_estimate", "estimated relative error of T"),
    "a2": ("a2_error_estimate", "estimated error of a2"),
    "temperature_noise": (
        "temperature_error_estimate",
        "two standard errors of T over batches, relative",
    ),
    "a2_noise": ("a2_error_estimate", "two standard errors of a2 over batches"),
    "mass_drift": ("mass_drift", "|ρ/ρ(0) − 1|"),
    "momentum_drift": ("momentum_drift", "change of the bulk velocity over the thermal speed"),
    "edge": ("edge", "largest |f| at the grid's border over max f"),
    "tail": ("spectral_tail", "part of ∫f² in the upper quarter of the wavenumbers"),
    "step_ratio": ("step_ratio", "step over the largest that is stable for certain"),
}
"""Variable and long name of what is measured of a run's health; the least density is `minimum`."""


def _densities(
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


def particle_dataset(
    scene: Scene,
    solver: Solver,
    grid: VelocitySpace,
    times: np.ndarray,
    by_batch: dict[str, np.ndarray],
    snapshots: dict[float, np.ndarray],
    status: Status,
    reason: str,
    warnings: list[str],
    health_outputs: list[dict[str, float]],
) -> xr.Dataset:
    """Dataset of a simulation by particles: as `evolution_dataset`, with standard errors.

    ``by_batch`` holds every moment of every batch, shape (batches, times, ...). Each becomes its mean over
    batches and a `<name>_standard_error`; of `BY_BATCH` the batches' own values are kept, too, as
    `<name>_by_batch`. The exact temperature law and `temperature_error`, the distance from it, are those of
    `evolution_dataset`.
    """
    components = list(COMPONENTS[: grid.dim])
    long_names = LONG_NAMES | {"collisions": "collisions that a particle has had"}
    data: dict[str, Any] = {}
    for name, values in by_batch.items():
        dims = ("time", *DIMENSIONS.get(name, ()))
        attributes = {"long_name": long_names[name], "units": "1"}
        data[name] = (dims, values.mean(axis=0), attributes)
        attributes = {"long_name": f"standard error of {name} over batches", "units": "1"}
        data[f"{name}_standard_error"] = (dims, standard_error(values), attributes)
        if name in BY_BATCH:
            attributes = {"long_name": f"{long_names[name]}, of each batch", "units": "1"}
            data[f"{name}_by_batch"] = (("time", "batch"), values.T, attributes)
    ds = xr.Dataset(
        data,
        coords={
            "time": ("time", times, {"long_name": "time t", "units": "1"}),
            "component": components,
            "component_": components,
            "batch": np.arange(solver.batches),
        },
    )
    _add_exact_law(ds, scene)
    if snapshots:
        ds = ds.assign(_densities(grid, snapshots, rescaled=False))
    ds = ds.assign(_health(health_outputs, reason))
    return _finish(ds, scene, solver, None, status, reason, warnings, "particles", ())


def standard_error(by_batch: np.ndarray) -> np.ndarray:
    """Standard error of the mean over the first axis, from independent batches."""
    return np.asarray(np.std(by_batch, axis=0, ddof=1) / np.sqrt(len(by_batch)))


def _add_exact_law(ds: xr.Dataset, scene: Scene) -> None:
    """Add the exact temperature law and the distances from it where one is known."""
    if scene.kernel.exponent != 0.0 or callable(scene.restitution):
        return
    law: dict[str, Any] = {
        "t": ds["time"].values,
        "restitution": float(scene.restitution),
        "diffusion": scene.diffusion,
        "cross_section": sphere_area(scene.dim) * scene.kernel.strength,
    }
    density0 = float(ds["density"][0])
    for name, density in (("temperature", density0), ("paper_temperature", 1.0)):
        exact = theory.maxwell_temperature(T0=float(ds[name][0]), density=density, **law)
        long_name = f"exact law of {name} from its discrete initial value"
        ds[f"{name}_exact"] = ("time", exact, {"long_name": long_name, "units": "1"})
        error = np.abs(ds[name].values - exact)
        long_name = f"|{name} − {name}_exact|"
        ds[f"{name}_error"] = ("time", error, {"long_name": long_name, "units": "1"})


def collision_dataset(
    scene: Scene,
    solver: Solver,
    grid: VelocitySpace,
    Q: np.ndarray,
    plans: Sequence[dict[str, Any]] = (),
) -> xr.Dataset:
    """Dataset of one evaluation Q(f0,f0) on the initial density, shape ``grid.shape``."""
    attributes = {"long_name": "collision operator Q(f0,f0)", "units": "1"}
    ds = xr.Dataset({"Q": (grid.axes, Q, attributes)}, coords=grid.coordinates())
    finite = bool(np.all(np.isfinite(Q)))
    status, reason = (Status.OK, "") if finite else (Status.DIVERGED, "Q is not finite")
    return _finish(ds, scene, solver, None, status, reason, [], "collision", plans)


def state_dataset(
    ds: xr.Dataset,
    scene: Scene,
    solver: Solver,
    reason: str,
    health: dict[str, float],
    title: str,
) -> xr.Dataset:
    """The variables of a state that was solved for, with a run's coordinates, health and attributes.

    ``reason``: why it is no state, empty where it is one. ``health`` by the names of `HEALTH_NAMES`.
    """
    status = Status.FAILED if reason else Status.OK
    measured = {
        variable: ((), health[name], {"long_name": long_name, "units": "1"})
        for name, (variable, long_name) in HEALTH_NAMES.items()
        if name in health
    }
    _, warnings = verdict([health], "")
    ds = ds.assign(measured | _trust([health], reason))
    return _finish(ds, scene, solver, None, status, reason, warnings, title, ())


def _finish(
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


def payload_checksum(ds: xr.Dataset) -> str:
    """SHA-256 over names, dimensions and bytes of all variables."""
    digest = hashlib.sha256()
    for name in sorted(map(str, ds.variables)):
        variable = ds.variables[name]
        values = np.ascontiguousarray(variable.values)
        if values.dtype.kind in "OUST":
            content = json.dumps(values.tolist()).encode()
        else:
            content = values.tobytes()
        digest.update(f"{name}{variable.dims}".encode())
        digest.update(content)
    return digest.hexdigest()


def write_dataset(
    ds: xr.Dataset, path: str | Path, duration: float | None = None, sidecar: bool = True
) -> None:
    """Write a dataset to NetCDF, whole or not at all, with a checksum of its payload.

    The file is written beside the target, synchronised and renamed. What varies from run to run (time,
    host, ``duration`` in seconds) goes to ``<path>.json``, so that the same run gives the same bytes;
    ``sidecar=False`` leaves that out.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    ds = ds.assign_attrs(payload_sha256=payload_checksum(ds))
    encoding: dict[Hashable, Any] = {
        name: {"zlib": True, "complevel": 1, "shuffle": True, "_FillValue": None}
        for name, variable in ds.variables.items()
        if variable.dtype.kind == "f" and variable.ndim > 0
    }
    if sidecar:
        _write_sidecar(path.with_name(path.name + ".json"), duration)
    write_whole(path, lambda partial: ds.to_netcdf(partial, engine="netcdf4", encoding=encoding))


def _write_sidecar(path: Path, duration: float | None) -> None:
    content = {
        "written": datetime.now(UTC).isoformat(timespec="seconds"),
        "host": platform.node(),
        "duration_seconds": duration,
    }
    write_whole(path, lambda partial: partial.write_text(json.dumps(content, indent=1) + "\n"))


def read_dataset(path: str | Path) -> xr.Dataset:
    """Read a dataset into memory and verify its checksum.

    Raises
    ------
    ValueError
        If the file has no checksum or holds another payload than was written.
    """
    with xr.open_dataset(path, engine="netcdf4") as stored:
        ds = stored.load()
    expected = ds.attrs.get("payload_sha256")
    if expected is None:
        raise ValueError(f"{path}: has no payload_sha256; granstudy did not write it")
    if payload_checksum(ds) != expected:
        raise ValueError(f"{path}: its payload does not match its checksum; the file is damaged")
    return ds
