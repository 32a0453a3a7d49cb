"""The words of a point, given to the scene, the solver or the times that they belong to."""

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any

from granstudy.accuracy.asked import Accuracy
from granstudy.evolution.times import TimeSettings
from granstudy.model.load_scene import ONE_OF, load_scene
from granstudy.model.own_functions import OwnDensity, OwnLaw, own_density, own_law, settled
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation, Refinement
from granstudy.support.errors import unknown_name

SOLVER_WORDS = tuple(field.name for field in fields(Solver) if field.name != "threads")
"""Words that say how well a gas is modelled."""

TIME_WORDS = tuple(field.name for field in fields(TimeSettings))
"""Words that say how a run goes through time."""

KERNEL_WORDS = ("exponent", "strength")
"""Words of the kernel."""

FIELDS = ("e", "restitution", *KERNEL_WORDS, "kernel", "diffusion", "symmetry")
"""Words that every scene takes."""

SHARED = ("kernel", "restitution", "diffusion", "symmetry")
"""Fields of a scene beside its density."""


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
    if isinstance(words.get("accuracy"), Mapping):
        asked = Accuracy.of(words["accuracy"])
        words = {**words, **asked.coordinates()}
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
    if times is not None and "t_final" not in times:
        raise ValueError("t_final: must be given")
    if times is None and of_time:
        raise ValueError(f"{', '.join(of_time)}: not for a {kind}, which no time leads to")
    return Computation(kind, made, full, times, refinement=refinement)


def varied(scene: Scene, words: Mapping[str, Any]) -> Scene:
    """A scene with some of its words set otherwise, arguments of its density and its law among them.

    Raises
    ------
    ValueError
        For a word that neither the scene, nor its density, nor its law of restitution takes, and for two
        words that say the same.
    """
    for one, other in ONE_OF:
        if one in words and other in words:
            raise ValueError(f"{one}, {other}: both say the same; give one")
    initial, of_density = _with_arguments(scene.initial, words, own_density, scene.dim)
    base = _follows(scene, initial)
    law: Any = words.get("e", words.get("restitution", base["restitution"]))
    if isinstance(law, str):
        of_law = {k: v for k, v in words.items() if k not in (*FIELDS, *of_density)}
        law, taken = load_scene("bkw2d", restitution=law, **of_law).restitution, set(of_law)
    else:
        law, taken = _with_arguments(law, words, own_law)
    if unknown := [word for word in words if word not in {*FIELDS, *taken, *of_density}]:
        known = [*FIELDS, *_names(scene.initial), *_names(law), *SOLVER_WORDS, *TIME_WORDS]
        raise unknown_name("parameter", unknown[0], known)
    kernel = {name: words[name] for name in KERNEL_WORDS if name in words}
    return Scene(
        scene.dim,
        initial,
        words.get("kernel", replace(base["kernel"], **kernel)),
        restitution=law,
        diffusion=words.get("diffusion", base["diffusion"]),
        symmetry=words.get("symmetry", base["symmetry"]),
    )


def _follows(scene: Scene, initial: Any) -> dict[str, Any]:
    """Kernel, restitution, diffusion and symmetry of a scene with another density.

    What the density before gave the scene, the other one gives: its symmetry, and all that a function of the
    user which makes whole scenes says. What was declared for the scene stays.
    """
    if initial is scene.initial:
        return {name: getattr(scene, name) for name in SHARED}
    before, after = getattr(scene.initial, "scene", None), getattr(initial, "scene", None)
    found = {
        name: getattr(after if _is_given(scene, before, name) else scene, name) for name in SHARED
    }
    own = getattr(scene.initial, "symmetry", "none")
    if scene.symmetry.name == getattr(own, "name", own):
        found["symmetry"] = getattr(initial, "symmetry", "none")
    return found


def _is_given(scene: Scene, made: Scene | None, name: str) -> bool:
    """Whether a scene has a field from the scene that its density's function made."""
    return made is not None and bool(getattr(scene, name) == getattr(made, name))


def _names(function: Any) -> list[str]:
    """Names of the arguments of a density or a law that can be set; none of a constant."""
    if isinstance(function, OwnDensity | OwnLaw):
        return [name for name, _ in function.arguments]
    if is_dataclass(function):
        return [field.name for field in fields(function) if field.init and field.name != "dim"]
    return []


def _with_arguments(
    function: Any, words: Mapping[str, Any], bind: Callable[..., Any], *dim: int
) -> tuple[Any, set[str]]:
    """A density or law with the words set that it takes, and their names."""
    known = settled(function, *dim) if callable(function) else function
    given = {key: value for key, value in words.items() if key in _names(known)}
    if not given:
        return function, set()
    if isinstance(known, OwnDensity | OwnLaw):
        return bind(known.function, {**dict(known.arguments), **given}, *dim), set(given)
    return replace(known, **given), set(given)
