"""Exact temperature and kurtosis of Maxwell molecules at constant restitution (docs/theory.md §1)."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from granstudy import theory
from granstudy.model.scene import Scene
from granstudy.support.variables import Variable, labelled
from granstudy.velocity.sphere import sphere_area


def exact_laws(
    scene: Scene, times: np.ndarray | Sequence[float], moments: Mapping[str, np.ndarray]
) -> dict[str, Variable]:
    """Exact laws of T over ``time``, and distances of a run from them; nothing where no law is known.

    Each law starts from the discrete initial value. The law of `temperature` has the run's initial density,
    the law of `paper_temperature` unit density, as the paper has it.

    Parameters
    ----------
    scene : Scene
    times : sequence of float, length n
        Times of the run's outputs.
    moments : mapping
        The run's `density`, `temperature` and `paper_temperature`, each of shape (n,).
    """
    if not has_exact_law(scene):
        return {}
    assert not callable(scene.restitution)
    law: dict[str, Any] = {
        "t": np.asarray(times),
        "restitution": float(scene.restitution),
        "diffusion": scene.diffusion,
        "cross_section": sphere_area(scene.dim) * scene.kernel.strength,
    }
    found: dict[str, Variable] = {}
    density0 = float(moments["density"][0])
    for name, density in (("temperature", density0), ("paper_temperature", 1.0)):
        exact = theory.maxwell_temperature(T0=float(moments[name][0]), density=density, **law)
        long_name = f"exact law of {name} from its discrete initial value"
        found[f"{name}_exact"] = labelled(exact, long_name, "time")
        error = np.abs(moments[name] - exact)
        found[f"{name}_error"] = labelled(error, f"|{name} − {name}_exact|", "time")
    return found


def has_exact_law(scene: Scene) -> bool:
    """Whether exact laws of T are known: for Maxwell molecules at constant restitution."""
    return scene.kernel.exponent == 0.0 and not callable(scene.restitution)


def check_maxwell_law(scene: Scene) -> None:
    """Raise ValueError unless T and a2 of the scene are known exactly.

    Exact laws hold for Maxwell molecules at constant restitution, and start from the moments that the
    initial density states.
    """
    if scene.kernel.exponent != 0.0:
        raise ValueError(
            f"truth.law='maxwell': holds at exponent 0, not at {scene.kernel.exponent!r}; give a solver"
        )
    if callable(scene.restitution):
        raise ValueError(
            f"truth.law='maxwell': holds at constant e, not with {scene.restitution!r}; give a solver"
        )
    if scene.moments is None:
        raise ValueError(
            f"truth.law='maxwell': initial={scene.initial!r} does not state its moments; give a solver"
        )
