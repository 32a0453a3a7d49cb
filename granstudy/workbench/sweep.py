"""A sweep in Python: every point a run in the store, the answer one labelled dataset."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from granstudy.datasets.collected import gather
from granstudy.datasets.open_runs import open_runs
from granstudy.datasets.parameters import parameter
from granstudy.datasets.unstack import unstack_runs
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.estimates import estimate_run
from granstudy.runs.run_key import run_keys
from granstudy.runs.store import Store
from granstudy.study.checks import check_computation
from granstudy.study.schema.sections import RangeModel
from granstudy.study.schema.words import coordinate
from granstudy.trust.flags import Status
from granstudy.workbench.calls import call_dataset, call_tasks
from granstudy.workbench.compute import Failure, compute
from granstudy.workbench.roots import write_root
from granstudy.workbench.tasks import RunTask
from granstudy.workbench.words import computation_at

if TYPE_CHECKING:
    from distributed import Client

Values = Sequence[Any] | np.ndarray | Mapping[str, Any]
"""Values of a swept parameter; or a range, ``{"start": .., "stop": .., "count": ..}``, as in study files."""


def sweep(
    scene: Scene | str | Callable[..., xr.Dataset],
    solver: Solver | None = None,
    *,
    over: Mapping[str, Values],
    state: str | None = None,
    refine: Mapping[str, Any] | None = None,
    results: str | Path = "results",
    name: str | None = None,
    densities: bool = False,
    client: "Client | None" = None,
    workers: int | None = None,
    progress: bool | None = None,
    **fixed: Any,
) -> xr.Dataset:
    """Compute a scene, or call a function, at every point of a product of parameters.

    Every point is a run in the store beside the results of studies: what was computed before, by a sweep, a
    study or another notebook, is not computed again, and `snakemake` does not compute again what a sweep
    did. So a sweep that was stopped goes on with the same call, and further values extend it.

    Parameters
    ----------
    scene : Scene, str or callable
        The scene; its name or a reference to a density of one's own (`granstudy.load_scene`); or a function
        that is called with the values of a point, by name, and returns an `xarray.Dataset`.
    solver : Solver, optional
        The solver; without one, words of solvers say it. Functions take none.
    over : mapping
        Values of each swept parameter: any field of the scene (e, exponent, diffusion, arguments of its
        density and law, the scene itself), of the solver (N, R, rtol, method, ...), of times (t_final, ...).
    state : str, optional
        ``cooling`` or ``heated``: solve for that state in place of a run through time.
    refine : mapping, optional
        ``{"N": [16, 24, 32], "temperature": 1e-4, "a2": 1e-3}``: each point goes up N (or R) until T and a2
        change by less than that.
    results : str or Path
        Folder of results, in which the store lies.
    name : str, optional
        Name of the sweep. `granstudy prune` keeps its runs until the name is given up.
    densities : bool
        Whether kept densities are in the answer, read when they are used.
    client : distributed.Client, optional
        Cluster that computes. Default: the client of this process if it has one, else processes of this
        machine.
    workers : int, optional
        How many processes of this machine; 1 computes in this one.
    progress : bool, optional
        Show a bar with the time left. Default: where a person watches.
    fixed
        Words that all points share: ``t_final``, ``dt``, ``exponent``, ...

    Returns
    -------
    xarray.Dataset
        An array over the swept parameters, as of `granstudy.unstack_runs`. A point that failed has the status
        failed, with its cause in `reason`; the others stay.

    Raises
    ------
    ValueError
        For a parameter that nothing takes, or a point that cannot be computed, before any work starts.
    KeyboardInterrupt
        If a person stops it: what was computed by then is kept, and the same call goes on.

    Examples
    --------
    >>> gs.sweep("maxwellian3d", gs.Solver(N=32, R=8.0, method="radial"),
    ...          over={"e": [0.5, 0.7, 0.9]}, t_final=3.0, dt=0.02, exponent=1.0)  # doctest: +SKIP
    """
    points = _points(over)
    store = Store.beside(results)
    if callable(scene) and not isinstance(scene, Scene | str):
        if solver is not None or state is not None or refine is not None:
            raise ValueError("solver, state, refine: a function takes its own arguments alone")
        calls = call_tasks(scene, points, fixed)
        write_root(results, name, [call.key for call in calls])
        found = compute(calls, store, client=client, workers=workers, progress=progress)
        return call_dataset(calls, points, store, _failures(found))
    kind = "evolution" if state is None else f"{state} state"
    ladder = None if refine is None else _ladder(refine)
    computations = [_checked(kind, scene, solver, {**fixed, **point}, ladder) for point in points]
    tasks = [
        RunTask(one, key, estimate_run(one).cost.seconds)
        for one, key in zip(computations, run_keys(computations), strict=True)
    ]
    write_root(results, name, [task.key for task in tasks])
    found = compute(tasks, store, client=client, workers=workers, progress=progress)
    return _dataset(tasks, points, store, _failures(found), densities)


def _points(over: Mapping[str, Values]) -> list[dict[str, Any]]:
    """All points of the product; ValueError for a parameter without values."""
    if not over:
        raise ValueError("over={}: give at least one parameter and its values")
    lists = {name: _listed(name, values) for name, values in over.items()}
    return [dict(zip(lists, point, strict=True)) for point in itertools.product(*lists.values())]


def _listed(name: str, values: Values) -> list[Any]:
    if isinstance(values, Mapping):
        found: list[Any] = list(RangeModel.model_validate(dict(values)).values())
    elif isinstance(values, str) or not isinstance(values, Sequence | np.ndarray | xr.DataArray):
        raise ValueError(f"over[{name!r}]={values!r}: must be a list of values, or a range")
    else:
        found = [_plain(value) for value in np.asarray(values, dtype=object).tolist()]
    if not found:
        raise ValueError(f"over[{name!r}]: is empty; give at least one value")
    real = parameter(coordinate(name)).real
    found = [float(value) if real and type(value) is int else value for value in found]
    if len(set(map(repr, found))) < len(found):
        raise ValueError(f"over[{name!r}]={found}: has a value twice")
    return found


def _plain(value: Any) -> Any:
    """A number of NumPy as one of Python."""
    return value.item() if isinstance(value, np.generic) else value


def _ladder(refine: Mapping[str, Any]) -> Refinement:
    """The ladder of ``refine``."""
    limits = {key: refine[key] for key in ("temperature", "a2") if key in refine}
    ladders = {key: value for key, value in refine.items() if key not in limits}
    if len(ladders) != 1:
        raise ValueError(f"refine={dict(refine)}: give N or R with its values, temperature, a2")
    ((over, values),) = ladders.items()
    return Refinement(over, tuple(values), **limits)


def _checked(
    kind: str,
    scene: Scene | str,
    solver: Solver | None,
    words: Mapping[str, Any],
    ladder: Refinement | None,
) -> Computation:
    """The run of a point, which can be computed; the message of an error names the point."""
    try:
        computation = computation_at(kind, scene, solver, words, ladder)
        check_computation(computation)
    except ValueError as error:
        raise ValueError(f"{_named(words)}: {error}") from None
    return computation


def _named(point: Mapping[str, Any]) -> str:
    return ", ".join(f"{name}={value!r}" for name, value in point.items())


def _failures(found: Mapping[str, Any]) -> dict[str, str]:
    """Causes of points that could not be computed, by key."""
    return {key: one.cause for key, one in found.items() if isinstance(one, Failure)}


def _dataset(
    tasks: Sequence[RunTask],
    points: Sequence[dict[str, Any]],
    store: Store,
    failures: Mapping[str, str],
    densities: bool,
) -> xr.Dataset:
    """The runs over the swept parameters; a point without a run has its cause as `reason`."""
    there = {task.key: store.path(task.key) for task in tasks if task.key not in failures}
    if not there:
        raise RuntimeError(
            f"no point could be computed; the first: {next(iter(failures.values()))}"
        )
    runs = open_runs(list(there.values()), densities=True) if densities else gather(there)
    runs = at_points(runs, [task.key for task in tasks], points)
    for row, task in enumerate(tasks):
        if task.key in failures:
            runs["status"][row] = Status.FAILED
            runs["reason"] = runs["reason"].astype(object)
            runs["reason"][row] = failures[task.key]
    return unstack_runs(runs, [coordinate(name) for name in points[0]])


def at_points(
    runs: xr.Dataset, keys: Sequence[str], points: Sequence[dict[str, Any]]
) -> xr.Dataset:
    """The run of each point, in their order, with the point's values as coordinates; holes where none is."""
    row = {key: i for i, key in enumerate(runs["run_key"].values.tolist())}
    places = [row.get(key, -1) for key in keys]
    found = runs.isel(run=[max(place, 0) for place in places])
    if -1 in places:
        there = xr.DataArray([place >= 0 for place in places], dims="run")
        found = found.where(there)
        found["status"] = found["status"].fillna(int(Status.MISSING)).astype(np.int8)
    for word in points[0]:
        name, values = coordinate(word), [point[word] for point in points]
        plain = all(isinstance(value, bool | int | float | str) for value in values)
        labels = values if plain else [_label(value) for value in values]
        attributes = parameter(name).attributes
        found = found.assign_coords({name: ("run", np.array(labels), attributes)})
    return found


def _label(value: Any) -> str:
    """A value that is no number or text, as a label."""
    return str(tuple(value)) if isinstance(value, list | tuple) else str(value)
