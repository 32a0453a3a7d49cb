"""A sweep in Python: every point a run in the store, the answer one labelled dataset."""

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from granstudy.collision.choice.cost import one_after_the_other
from granstudy.datasets.collected import gather
from granstudy.datasets.open_runs import open_runs
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation, Refinement
from granstudy.runs.estimates import estimate_run
from granstudy.runs.execute import Outcome
from granstudy.runs.kinds import KINDS
from granstudy.runs.run_key import run_keys, rung_keys
from granstudy.runs.store import Store
from granstudy.study.checks import check_computation
from granstudy.support.checks import plain
from granstudy.support.errors import unknown_name
from granstudy.support.own_code.code import name_of
from granstudy.trust.notice import warn_of_trust
from granstudy.workbench.calls import call_runs, call_tasks
from granstudy.workbench.compute import Failure, compute
from granstudy.workbench.points import Point, Values, at_points, labels, listed, product, shown
from granstudy.workbench.roots import write_root
from granstudy.workbench.tasks import RunTask
from granstudy.workbench.words import computation_at

if TYPE_CHECKING:
    from distributed import Client


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
    lists = listed(over, fixed)
    points = product(lists)
    store = Store.beside(results)
    how: dict[str, Any] = {"client": client, "workers": workers, "progress": progress}
    if callable(scene) and not isinstance(scene, Scene):
        if solver is not None or state is not None or refine is not None:
            raise ValueError(
                f"solver, state, refine: {name_of(scene)} is called, and takes its own arguments alone; a "
                "density of one's own becomes a scene by load_scene"
            )
        labelled = labels(lists, points)
        calls = call_tasks(scene, points, fixed)
        keys = [call.key for call in calls]
        write_root(results, name, keys)
        failures = _failures(compute(calls, store, **how))
        runs = call_runs(_there(keys, failures), store)
        return at_points(runs, keys, labelled, failures)
    kind = "evolution" if state is None else f"{state} state"
    if kind not in KINDS:
        raise unknown_name("state", state, ["cooling", "heated"])
    ladder = None if refine is None else _ladder(refine, {*lists, *fixed})
    computations = [_checked(kind, scene, solver, point, fixed, ladder) for point in points]
    labelled = labels(lists, points, lambda place: _coordinates(computations[place]))
    keys = run_keys(computations)
    tasks = [
        RunTask(one, key, seconds)
        for one, key, seconds in zip(
            computations,
            keys,
            one_after_the_other(estimate_run(one).cost for one in computations),
            strict=True,
        )
    ]
    write_root(results, name, [*keys, *rung_keys(computations)])
    failures = _failures(compute(tasks, store, **how))
    if store.heal(keys):  # a file was damaged since
        failures |= _failures(compute(tasks, store, **how))
    files = {key: store.path(key) for key in _there(keys, failures)}
    runs = open_runs(list(files.values()), densities=True) if densities else gather(files)
    found = at_points(runs, keys, labelled, failures)
    warn_of_trust(found)
    return found


def _ladder(refine: Mapping[str, Any], others: Collection[str]) -> Refinement:
    """The ladder of ``refine``; ``others`` are words that the sweep sets beside it."""
    if not isinstance(refine, Mapping):
        raise ValueError(f"refine={refine!r}: give a mapping of N or R with its values")
    limits = {key: refine[key] for key in ("temperature", "a2") if key in refine}
    ladders = {key: value for key, value in refine.items() if key not in limits}
    if len(ladders) != 1:
        raise ValueError(f"refine={dict(refine)}: give N or R with its values, temperature, a2")
    ((over, values),) = ladders.items()
    if over in others:
        raise ValueError(f"{over}: refine goes up its values; leave it out elsewhere")
    if isinstance(values, str) or not isinstance(values, Sequence | np.ndarray):
        raise ValueError(f"refine={dict(refine)}: {over} must be a list of increasing values")
    return Refinement(over, tuple(map(plain, values)), **limits)


def _checked(
    kind: str,
    scene: Scene | str,
    solver: Solver | None,
    point: Point,
    fixed: Mapping[str, Any],
    ladder: Refinement | None,
) -> Computation:
    """The run of a point, which can be computed; the message of an error names the point."""
    try:
        computation = computation_at(kind, scene, solver, {**fixed, **point}, ladder)
        check_computation(computation)
    except ValueError as error:
        raise ValueError(f"{shown(point)}: {error}") from None
    return computation


def _coordinates(computation: Computation) -> dict[str, Any]:
    """Coordinates that a run has, before it is computed."""
    scene, times = computation.scene, computation.time
    own = {} if times is None else times.coordinates()
    return {**scene.coordinates(), **computation.solver.coordinates(scene.dim), **own}


def _failures(found: Mapping[str, Outcome | Failure]) -> dict[str, str]:
    """Causes of points that could not be computed, by key."""
    return {key: one.cause for key, one in found.items() if isinstance(one, Failure)}


def _there(keys: Sequence[str], failures: Mapping[str, str]) -> list[str]:
    """Keys of the runs that are there, each once.

    Raises
    ------
    RuntimeError
        If there are none.
    """
    there = [key for key in dict.fromkeys(keys) if key not in failures]
    if not there:
        raise RuntimeError(
            f"no point could be computed; the first: {next(iter(failures.values()))}"
        )
    return there
