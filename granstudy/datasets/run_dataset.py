"""The parts that datasets of all runs share: coordinates, status, provenance, kept densities."""

import json
import os
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from granstudy.datasets.parameters import parameter
from granstudy.model.choice import Choice
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.variables import labelled
from granstudy.trust.flags import Status, flag_variable
from granstudy.velocity.moments import COMPONENTS
from granstudy.velocity.space import VelocitySpace

CONVENTIONS = "CF-1.11"
"""Version of the CF conventions that names and attributes follow."""

LIBRARIES = ("granstudy", "numpy", "scipy", "pyfftw", "numba", "xarray")
"""Packages whose versions a dataset records."""


@dataclass(frozen=True)
class Header:
    """All that a dataset says of its run and that is known before the first step.

    Attributes
    ----------
    title : str
        What was computed, in a word or two.
    scene : Scene
    solver : Solver
        The solver that computed it; nothing is open.
    times : mapping
        Parameters of time (`granstudy.evolution.times.TimeSettings.coordinates`).
    attributes : mapping
        Attributes on the choice of solver (`granstudy.model.solver.Choice.attributes`).
    """

    title: str
    scene: Scene
    solver: Solver
    times: Mapping[str, Any] = field(default_factory=dict)
    attributes: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(
        cls, title: str, scene: Scene, choice: Choice, times: Mapping[str, Any] | None = None
    ) -> "Header":
        """The header of a run with the solver of a choice."""
        return cls(title, scene, choice.solver, times or {}, choice.attributes())

    def coordinates(self) -> dict[str, Any]:
        """Every parameter of the run, in the order of a run's path."""
        return {
            **self.scene.coordinates(),
            **self.solver.coordinates(self.scene.dim),
            **self.times,
        }


@dataclass(frozen=True)
class Ending:
    """How a run ended: its status, the reason of an early end, and its warnings."""

    status: Status = Status.OK
    reason: str = ""
    warnings: Sequence[str] = ()


@dataclass
class Record:
    """All that a simulation leaves, filled output by output.

    Attributes
    ----------
    times : list of float
        Times of the outputs reached.
    moments : list of dict
        Moments of f at each output (`granstudy.velocity.moments.moment_values`).
    snapshots : dict of ndarray
        Kept densities, by time.
    health : list of dict
        Signs of health at each output, by the names of `granstudy.trust.health.SIGNS`.
    plans : list of dict
        Quadratures chosen for a tolerance, each with the time from which it was in use.
    warnings : dict of str
        Warnings by name; the first of each name is kept.
    status : Status
        How the run ended.
    reason : str
        Why the run ended early; "" where it did not.
    """

    times: list[float] = field(default_factory=list)
    moments: list[dict[str, Any]] = field(default_factory=list)
    snapshots: dict[float, np.ndarray] = field(default_factory=dict)
    health: list[dict[str, float]] = field(default_factory=list)
    plans: list[dict[str, Any]] = field(default_factory=list)
    warnings: dict[str, str] = field(default_factory=dict)
    status: Status = Status.OK
    reason: str = ""

    def warn(self, time: float, texts: Mapping[str, str]) -> None:
        """Keep the warnings whose names are new, with the time."""
        for name, text in texts.items():
            self.warnings.setdefault(name, f"from t = {time:g}: {text}")

    @property
    def ending(self) -> Ending:
        """How the run ended, with its warnings."""
        return Ending(self.status, self.reason, tuple(self.warnings.values()))


def columns(rows: Sequence[Mapping[str, Any]]) -> dict[str, np.ndarray]:
    """Rows of values as an array a name; `rows` makes them rows again.

    Raises
    ------
    ValueError
        If names differ from row to row.
    """
    names = list(rows[0]) if rows else []
    if any(list(row) != names for row in rows):
        raise ValueError(f"rows: each must have the names {names}, in this order")
    return {name: np.array([row[name] for row in rows]) for name in names}


def rows(columns: Mapping[str, np.ndarray]) -> list[dict[str, Any]]:
    """Rows of the columns that `columns` made."""
    names = list(columns)
    return [dict(zip(names, values, strict=True)) for values in zip(*columns.values(), strict=True)]


def time_axes(dim: int, times: Sequence[float] | np.ndarray) -> dict[str, Any]:
    """Coordinates of moments: the times, and the components of vectors and tensors."""
    components = list(COMPONENTS[:dim])
    return {
        "time": labelled(np.array(times), "time t", "time"),
        "component": components,
        "component_": components,
    }


def kept_densities(
    grid: VelocitySpace, snapshots: Mapping[float, np.ndarray], rescaled: bool
) -> xr.Dataset:
    """Kept densities over ``snapshot``: f over velocities v, of a rescaled run g over c = (v−u)/θ."""
    name, long_name = (
        ("g", "density g = θ^d f over c = (v−u)/θ") if rescaled else ("f", "velocity density f")
    )
    values = np.array(list(snapshots.values()))
    ds = xr.Dataset(
        {name: labelled(values, long_name, ("snapshot", *grid.axes))},
        coords=grid.coordinates() | {"snapshot": labelled(list(snapshots), "time t", "snapshot")},
    )
    return on_scaled_velocities(ds, grid.axes) if rescaled else ds


def on_scaled_velocities(ds: xr.Dataset, axes: tuple[str, ...]) -> xr.Dataset:
    """The dataset with the ``axes`` of its grid renamed from v to the scaled velocities c = (v−u)/θ."""
    scaled = {axis: f"c{axis[1:]}" for axis in axes}
    ds = ds.rename(scaled | ({"r_weight": "c_weight"} if "r_weight" in ds else {}))
    for axis in scaled.values():
        ds[axis].attrs["long_name"] = f"scaled velocity {axis} of c = (v−u)/θ"
    return ds


def stamped(
    ds: xr.Dataset, header: Header, ending: Ending, plans: Sequence[dict[str, Any]] = ()
) -> xr.Dataset:
    """The dataset with its status, every parameter as a coordinate, and its provenance.

    Parameters
    ----------
    plans : sequence of dict
        Quadratures chosen for a tolerance; they become the attribute `quadrature`.
    """
    ds["status"] = flag_variable(
        ending.status,
        "how the run ended",
        reason=ending.reason,
        warnings="\n".join(ending.warnings),
    )
    coordinates = header.coordinates()
    ds = ds.assign_coords(
        {name: ((), value, parameter(name).attributes) for name, value in coordinates.items()}
    )
    ds.attrs = {
        "title": f"granstudy {header.title}",
        "Conventions": CONVENTIONS,
        "history": f"granstudy {versions()['granstudy']}",
        "scene": json.dumps(header.scene.describe(), sort_keys=True),
        "solver": json.dumps(header.solver.describe(), sort_keys=True),
        "versions": json.dumps(versions(), sort_keys=True),
        "git_commit": git_commit(),
    }
    if source := header.scene.source:
        ds.attrs["source"] = source
    if plans:
        ds.attrs["quadrature"] = json.dumps(list(plans), sort_keys=True)
    return ds.assign_attrs(header.attributes)


@cache
def versions() -> dict[str, str]:
    """Versions of `LIBRARIES`, read once: they stay as they are while the process runs."""
    return {name: version(name) for name in LIBRARIES}


@cache
def git_commit() -> str:
    """Commit of the checkout that the package runs from; "" outside a checkout."""
    return commit_of(Path(__file__).parents[2])


def commit_of(folder: Path) -> str:
    """Commit of the git repository whose top is a folder; "" for any other folder.

    An installed package may lie inside a repository that is not its own. Variables such as GIT_DIR, which
    git sets for hooks, name another repository.
    """
    environment = {k: v for k, v in os.environ.items() if not k.startswith("GIT_")}
    try:
        answer = subprocess.run(
            ["git", "rev-parse", "--show-toplevel", "HEAD"],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        top, commit = answer.stdout.splitlines()
        return commit if Path(top).samefile(folder) else ""
    except (OSError, ValueError, subprocess.CalledProcessError):
        return ""
