"""The words of a point, given to the scene, the solver or the times that they belong to."""

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from granstudy.evolution.times import TimeSettings
from granstudy.model.kernel import VHS
from granstudy.model.load_scene import load_scene
from granstudy.model.own_functions import OwnDensity, OwnLaw, own_density, own_law
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation, Refinement
from granstudy.support.errors import unknown_name

SOLVER_WORDS = tuple(field.name for field in fields(Solver) if field.name != "threads")
"""Words that say how well a gas is modelled."""

TIME_WORDS = tuple(field.name for field in fields(TimeSettings))
"""Words that say how a run goes through time."""

KERNEL_WORDS = ("exponent", "strength")

SCENE_FIELDS = ("diffusion", "symmetry", "kernel")


def computation_at(
    kind: str,
    scene: Scene | str,
    solver: Solver | None,
    words: Mapping[str, Any],
    refinement: Refinement | None = None,
    beside: Path | None = None,
) -> Computation:
    """The run of a point.

    Parameters
    ----------
    kind : str
        A row of `granstudy.runs.kinds.KINDS`.
    scene : Scene or str
        The scene, or its name or reference (`granstudy.load_scene`); the word ``scene`` goes before it.
    solver : Solver, optional
        The solver; without one, words say it.
    words : mapping
        Words of scene, solver and times with their values.
    refinement : Refinement, optional
        A ladder of N or R.
    beside : Path, optional
        Folder that references start from; by default the working folder.

    Raises
    ------
    ValueError
        For a word that nothing takes, or a value that its field does not allow.
    """
    of_solver = {key: value for key, value in words.items() if key in SOLVER_WORDS}
    of_time = {key: value for key, value in words.items() if key in TIME_WORDS}
    of_scene = {k: v for k, v in words.items() if k not in of_solver and k not in of_time}
    base = of_scene.pop("scene", scene)
    made = (
        varied(base, of_scene)
        if isinstance(base, Scene)
        else load_scene(base, beside=beside, **of_scene)
    )
    if refinement is not None:
        of_solver[refinement.over] = refinement.values[0]
    if solver is None and not of_solver:
        raise ValueError("solver: give one, or words of one (method, N, R, rtol, ...)")
    full = Solver(**of_solver) if solver is None else replace(solver, **of_solver)
    times = of_time if kind == "evolution" else None
    if times is None and of_time:
        raise ValueError(f"{', '.join(of_time)}: are of times, which a {kind} does not have")
    return Computation(kind, made, full, times, refinement=refinement)


def varied(scene: Scene, words: Mapping[str, Any]) -> Scene:
    """A scene with some of its words set otherwise, arguments of its density and its law among them.

    Raises
    ------
    ValueError
        For a word that neither the scene, nor its density, nor its law of restitution takes.
    """
    changed: dict[str, Any] = {key: words[key] for key in SCENE_FIELDS if key in words}
    kernel = changed.get("kernel", scene.kernel)
    own = {key: words[key] for key in KERNEL_WORDS if key in words}
    changed["kernel"] = replace(kernel, **own) if own else kernel
    assert isinstance(kernel, VHS)
    if "e" in words and "restitution" in words:
        raise ValueError("e, restitution: both say the same; give one")
    law = words.get("e", words.get("restitution", scene.restitution))
    if isinstance(law, str):
        law = load_scene(
            "bkw2d", restitution=law, **_taken_by_law(law, words, scene)
        ).restitution  # the law alone counts
    rest = {
        key: value
        for key, value in words.items()
        if key not in changed and key not in (*KERNEL_WORDS, "e", "restitution")
    }
    initial, rest = _set(scene.initial, rest, own_density, scene.dim)
    if not isinstance(words.get("restitution"), str) and callable(law):
        law, rest = _set(law, rest, own_law)
    if rest and not isinstance(words.get("restitution"), str):
        known = [*SCENE_FIELDS, *KERNEL_WORDS, "e", "restitution", *SOLVER_WORDS, *TIME_WORDS]
        raise unknown_name("parameter", next(iter(rest)), known + _arguments(scene))
    symmetry = changed.pop("symmetry", None if initial is not scene.initial else scene.symmetry)
    return Scene(
        scene.dim,
        initial,
        changed["kernel"],
        restitution=law,
        diffusion=changed.get("diffusion", scene.diffusion),
        symmetry=symmetry,
    )


def _taken_by_law(law: str, words: Mapping[str, Any], scene: Scene) -> dict[str, Any]:
    """Words that are no others' and so the law's."""
    others = {*SCENE_FIELDS, *KERNEL_WORDS, "e", "restitution", *_names(scene.initial)}
    return {key: value for key, value in words.items() if key not in others}


def _names(function: Any) -> list[str]:
    """Names of the arguments of a density or a law that can be set."""
    if isinstance(function, OwnDensity | OwnLaw):
        return [name for name, _ in function.arguments]
    if is_dataclass(function):
        return [field.name for field in fields(function) if field.init and field.name != "dim"]
    return []


def _arguments(scene: Scene) -> list[str]:
    law = scene.restitution
    return [*_names(scene.initial), *(_names(law) if callable(law) else [])]


def _set(
    function: Any, words: dict[str, Any], bind: Callable[..., Any], *more: Any
) -> tuple[Any, dict[str, Any]]:
    """A density or law with the words set that it takes, and the words that are left."""
    mine = {key: value for key, value in words.items() if key in _names(function)}
    left = {key: value for key, value in words.items() if key not in mine}
    if not mine:
        return function, left
    if isinstance(function, OwnDensity | OwnLaw):
        return bind(function.function, {**dict(function.arguments), **mine}, *more), left
    return replace(function, **mine), left
