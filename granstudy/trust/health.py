"""Whether a run can be trusted: what is measured while it runs, and the label that comes of it.

Of particles that is what their batches differ by. On a grid, collisions change energy and fourth moment at
rates that all pairs of a density give without truncation, modes or directions
(`granstudy.trust.pair_rates`). What Q's own moments differ by, over time, is what T and a2 are off by
(docs/method.md §10). Beside it stand the signs of a density that its grid cannot hold.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from granstudy.trust.flags import Trust
from granstudy.velocity.space import VelocitySpace

Moments = Mapping[str, Any]
"""Moments of a density by name (`granstudy.velocity.moments`)."""


class Sign(NamedTuple):
    """A quantity, above what value a run is marginal, above what untrusted, and what is said then."""

    marginal: float
    untrusted: float
    text: str


BALANCE_REMEDY = "take a larger N and R, more directions, a smaller dt"

SIGNS = {
    # of the moments of Q that do not balance those of all pairs, and of long steps
    "temperature": Sign(2e-3, 1e-2, f"T may be off by {{:.1e}} of itself: {BALANCE_REMEDY}"),
    "a2": Sign(4e-3, 3e-2, f"a2 may be off by {{:.1e}}: {BALANCE_REMEDY}"),
    # of particles, by their batches (docs/particles.md §3)
    "temperature_noise": Sign(
        2e-3, 1e-2, "T has two standard errors of {:.1e} of itself: take more particles"
    ),
    "a2_noise": Sign(4e-3, 3e-2, "a2 has two standard errors of {:.1e}: take more particles"),
    "a2_bias": Sign(
        4e-3,
        3e-2,
        "a2 has a bias of about {:.1e} from the finite number of particles in a batch: take fewer "
        "batches or more particles",
    ),
    # relative; the `full` variant keeps mass to 1e-12
    "mass_drift": Sign(
        1e-3,
        1e-2,
        "mass has drifted by {:.1e} of its start: take more directions or variant 'full'",
    ),
    # over the thermal speed at the time
    "momentum_drift": Sign(
        1e-3,
        3e-2,
        "the bulk velocity has drifted by {:.1e} thermal speeds: take more directions, or "
        "conserve=('momentum',)",
    ),
    # −min f over max f; spectral ringing of a resolved density stays under 1e-4
    "negative": Sign(
        1e-3, 1e-2, "the density falls to -{:.1e} of its largest value: take a larger N"
    ),
    # |f| over max f; what lies there wraps around
    "edge": Sign(
        1e-4, 1e-2, "the density at the grid's border is {:.1e} of its largest: take a larger R"
    ),
    # part of ∫f²; much of what is beyond the last wavenumber is as large
    "tail": Sign(
        1e-2,
        1e-1,
        "{:.1e} of ∫f² is in the last quarter of the wavenumbers: take a larger N or a smaller R, or "
        "frame='rescaled' where the gas cools",
    ),
    "step_ratio": Sign(
        1.0,
        2.0,
        "the step is {:.2g} times what is stable for certain: take a smaller dt, or time_rtol in its "
        "place",
    ),
}
"""What is measured at every output; docs/method.md §10 says against which errors."""

NOT_FINITE = "the density became NaN or infinite: take a smaller dt"


def failure(values: Moments) -> str | None:
    """Why a run with these moments has to stop, or None."""
    if not all(np.all(np.isfinite(value)) for value in values.values()):
        return NOT_FINITE
    if values["density"] <= 0.0:
        return f"the density ρ fell to {values['density']:.3g}: take a smaller dt or variant 'full'"
    if values["temperature"] <= 0.0:
        return (
            f"the temperature fell to {values['temperature']:.3g}: the grid has lost the gas; "
            "take a larger N, or frame='rescaled'"
        )
    return None


def state_of_health(
    f: np.ndarray, values: Moments, first: Moments, grid: VelocitySpace
) -> dict[str, float]:
    """What one output says, by the names of `SIGNS`.

    ``values`` and ``first`` are moments of f as the grid holds it, now and at the first output.
    """
    largest = np.max(np.abs(f))
    thermal = np.sqrt(values["temperature"])
    return {
        "mass_drift": abs(float(values["density"] / first["density"] - 1.0)),
        "momentum_drift": float(np.linalg.norm(values["velocity"] - first["velocity"]) / thermal),
        "negative": max(0.0, float(-values["minimum"] / largest)),
        "edge": float(grid.edge(f) / largest),
        "tail": grid.spectral_tail(f),
    }


def warnings(output: dict[str, float]) -> dict[str, str]:
    """What there is to say of one output, by name: the number and the remedy."""
    return {
        name: SIGNS[name].text.format(value)
        for name, value in output.items()
        if not value <= SIGNS[name].marginal
    }


def verdict(outputs: Sequence[dict[str, float]], stopped: str) -> tuple[Trust, list[str]]:
    """The label of a run by the largest values that its outputs came to, and the reasons.

    A run that had to stop is untrusted; ``stopped`` says why.
    """
    names = dict.fromkeys(name for output in outputs for name in output)
    worst = {name: max(output.get(name, 0.0) for output in outputs) for name in names}
    reasons = [*([stopped] if stopped else []), *warnings(worst).values()]
    if stopped or any(not value <= SIGNS[name].untrusted for name, value in worst.items()):
        return Trust.UNTRUSTED, reasons
    return (Trust.MARGINAL if reasons else Trust.TRUSTED), reasons


def health_variables(outputs: Sequence[dict[str, float]], stopped: str) -> dict[str, Any]:
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
    return variables | trust_variable(outputs, stopped)


def trust_variable(outputs: Sequence[dict[str, float]], stopped: str) -> dict[str, Any]:
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
