"""The dataset of a state to an accuracy."""

import json
from collections.abc import Sequence

import xarray as xr

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.dataset import trust_as_asked
from granstudy.accuracy.states.ladder import Found
from granstudy.accuracy.states.tails import far_slope, tail_power, tail_rate
from granstudy.datasets.parameters import parameter
from granstudy.model.scene import Scene
from granstudy.support.variables import labelled
from granstudy.trust.flags import Status

TAILS = {
    "cooling": (
        "A of the tail exp(−A c^λ); at λ = 0, s of c^−s",
        "−d ln f/d c^λ; at λ = 0, −d ln f/d ln c;",
    ),
    "heated": ("A of the tail exp(−A c^(1+λ/2))", "−d ln f/d c^(1+λ/2)"),
}
"""What the rate and the slope of a state's tail are."""


def described(
    scene: Scene, asked: Accuracy, state: str, answer: Found, grids: Sequence[Found], unit: float
) -> xr.Dataset:
    """The dataset of an answer: the last grid's state, its errors, its tail, and what was tried.

    Parameters
    ----------
    answer : Found
        The last state with the numbers and errors that it is given.
    grids : sequence of Found
        The state on each grid that was tried.
    unit : float
        √T on the grids' velocities.
    """
    ds = answer.ds.assign(_numbers(scene, state, answer, grids, unit))
    ds = ds.assign_coords(
        {
            name: ((), value, parameter(name).attributes)
            for name, value in asked.coordinates().items()
        }
    )
    choices = [
        {
            "N": int(one.ds["N"]),
            "R": float(one.ds["R"]),
            "a2": float(one.ds["a2"]),
            "error": one.a2,
        }
        for one in grids
    ]
    attrs = {
        "asked": json.dumps(asked.describe(), sort_keys=True),
        "reached": json.dumps({"temperature": answer.temperature, "a2": answer.a2}, sort_keys=True),
        "choices": json.dumps(choices, sort_keys=True),
    }
    off = answer.off(asked)
    if off > 1.0:
        attrs["needed"] = _missing(asked, state, answer)
    status = Status(int(ds["status"]))
    ds["trust"] = trust_as_asked(off, status, attrs.get("needed", ""))
    return ds.assign_attrs(attrs)


def _numbers(
    scene: Scene, state: str, answer: Found, grids: Sequence[Found], unit: float
) -> dict[str, tuple]:
    """Errors of a state, and its tail, by the names of variables."""
    K, power = float(answer.ds["cooling_coefficient"]), tail_power(scene, state)
    rate, rate_error = tail_rate(scene, state, K, answer.temperature)
    seen = far_slope(grids[-2].ds, grids[-1].ds, scene.dim, unit, power)
    law, against = TAILS[state]
    return {
        "cooling_coefficient_error": labelled(
            answer.temperature, "estimated relative error of K and T"
        ),
        "a2_error": labelled(answer.a2, "estimated error of a2"),
        "a3_error": labelled(answer.a3, "estimated error of a3"),
        "tail_rate": labelled(rate, f"{law}, c = |v−u|/√T"),
        "tail_rate_error": labelled(rate_error, "estimated error of tail_rate, by that of K"),
        "far_slope": labelled(seen.value, f"{against} at far_speed"),
        "far_slope_error": labelled(seen.error, "estimated error of far_slope"),
        "far_speed": labelled(
            seen.speed, "largest speed |v−u|/√T at which two grids agree on the tail's slope"
        ),
    }


def _missing(asked: Accuracy, state: str, answer: Found) -> str:
    """Why a state missed its accuracy."""
    N, R = int(answer.ds["N"]), float(answer.ds["R"])
    text = (
        f"K and T were asked to {asked.temperature:.1e} and reached to {answer.temperature:.1e}, a2 to "
        f"{asked.a2:.1e} and {answer.a2:.1e}, with N={N} and R={R:g}"
    )
    if state == "cooling":
        return f"{text}; the tail falls slowly: a larger R gains little, and adds round-off"
    return text
