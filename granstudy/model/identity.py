"""How the density and the restitution of a scene are named, described and told apart."""

from collections.abc import Callable
from functools import partial
from typing import Any

from granstudy.model.densities import INITIAL_DENSITIES, density_parameters
from granstudy.model.own_functions import OwnFunction, is_granstudys, settled
from granstudy.model.restitution import LAWS, law_parameters
from granstudy.support.own_code.code import Code, code_of, name_of
from granstudy.support.own_code.values import canonical

VARIABLES = frozenset(
    (
        *(
            "time",
            "temperature",
            "velocity",
            "density",
            "energy",
            "pressure",
            "a2",
            "a3",
            "minimum",
        ),
        *("f", "g", "Q", "edge", "residual", "status", "trust", "reason", "warnings", "threads"),
        *("paper_temperature", "cooling_rate", "cooling_coefficient", "collisions", "batch", "run"),
        *("collision_time", "frame_velocity", "velocity_scale", "density_drift", "mass_drift"),
        *("momentum_drift", "mass_loss", "spectral_tail", "step_ratio", "tail_slope", "tail_speed"),
        *("snapshot", "component", "component_", "vx", "vy", "vz", "r", "r_weight", "iteration"),
        *("c", "cx", "cy", "cz", "c_weight"),
    )
)
"""Names of variables and axes of datasets: an argument of such a name becomes ``initial_<name>`` there."""


def label(function: Any) -> str:
    """Name of a density or law: of granstudy's the one that `load_scene` knows, else the function's."""
    if not is_granstudys(function):
        return name_of(getattr(function, "function", function))
    for name, made in INITIAL_DENSITIES.items():
        cls = made.func if isinstance(made, partial) else made
        dims = made.args if isinstance(made, partial) else (getattr(cls, "dim", None),)
        if type(function) is cls and dims == (function.dim,):
            return name
    laws = {law: name for name, law in LAWS.items()}
    return laws.get(type(function), type(function).__name__)


def arguments(function: Any, dim: int | None = None) -> dict[str, Any]:
    """Arguments of a density or law by the names of coordinates: numbers and texts."""
    if is_granstudys(function):
        name = label(function)
        names = (
            [field.name for field in density_parameters(name)] if name in INITIAL_DENSITIES else []
        )
        names += law_parameters(name) if name in LAWS else []
        values = {name: getattr(function, name) for name in names}
    else:
        found = settled(function, dim)
        values = dict(found.arguments) if isinstance(found, OwnFunction) else _bound(found)
    return {coordinate(name): _as_coordinate(canonical(value)) for name, value in values.items()}


def coordinate(name: str) -> str:
    """Name of an argument's coordinate; ``initial_<name>`` where a dataset has such a variable."""
    return f"initial_{name}" if name in VARIABLES else name


def _as_coordinate(value: Any) -> Any:
    return value if isinstance(value, bool | int | float | str) else str(value)


def _bound(function: Callable[..., Any]) -> dict[str, Any]:
    try:
        return dict(code_of(function).arguments)
    except ValueError:
        return {}


def code(function: Any, dim: int | None = None) -> Code:
    """The content of a density or law of the user; ValueError where there is none to be known by."""
    found = settled(function, dim)
    return found.code if isinstance(found, OwnFunction) else code_of(found)


def described(function: Any, dim: int | None, content: Code | None) -> Any:
    """A density or law as plain data: of granstudy's its ``repr``; else name, arguments and digest.

    A function that cannot be known by its content has ``unidentified``, the reason, in place of the digest.

    Parameters
    ----------
    content : Code or None
        The content, where it is known already.
    """
    if is_granstudys(function):
        return repr(function)
    found = settled(function, dim)
    own = dict(found.arguments) if isinstance(found, OwnFunction) else _bound(found)
    values = {name: canonical(value) for name, value in own.items()}
    description = {"function": label(function), "arguments": values}
    try:
        return description | {"digest": (content or code(function, dim)).digest}
    except ValueError as error:
        return description | {"unidentified": str(error)}


def known(function: Any, dim: int | None = None) -> Code | None:
    """The content of a density or law of the user; None for granstudy's, and where it cannot be known."""
    if is_granstudys(function) or not callable(function):
        return None
    try:
        return code(function, dim)
    except ValueError:
        return None
