"""The health of a run: what is measured at every output, and the label that follows.

On a grid, the exact rates of energy and fourth moment are sums over all pairs of a density
(`granstudy.trust.pair_rates`). The difference between these rates and the moments of Q, integrated over
time, estimates the errors of T and a2 (docs/method.md §10). Further signs show a density that its grid
cannot hold. For particles, the spread of their batches gives the errors.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from granstudy.support.errors import LawRangeError
from granstudy.support.variables import Variable, labelled
from granstudy.trust.flags import Trust, flag_variable
from granstudy.velocity.space import VelocitySpace

Moments = Mapping[str, Any]
"""Moments of a density by name (`granstudy.velocity.moments`)."""

NOT_FINITE = "the density became NaN or infinite: take a smaller dt"
"""Reason of a run that stopped at values which are not finite."""

BALANCE_REMEDY = "take a larger N and R, more directions, a smaller dt"
"""Remedy for estimated errors of T and a2 on a grid."""


class Sign(NamedTuple):
    """One quantity that shows the health of a run.

    Attributes
    ----------
    marginal, untrusted : float
        Values above which a run is marginal, and untrusted.
    text : str
        The warning above ``marginal``: the value, and a remedy.
    variable, long_name : str
        The quantity as a variable of the dataset; "" where a dataset has none.
    """

    marginal: float
    untrusted: float
    text: str
    variable: str = ""
    long_name: str = ""


SIGNS = {
    # from moments of Q that do not balance the rates of all pairs, and from long steps
    "temperature": Sign(
        2e-3,
        1e-2,
        f"T may be off by {{:.1e}} of itself: {BALANCE_REMEDY}",
        "temperature_error_estimate",
        "estimated relative error of T",
    ),
    "a2": Sign(
        4e-3,
        3e-2,
        f"a2 may be off by {{:.1e}}: {BALANCE_REMEDY}",
        "a2_error_estimate",
        "estimated error of a2",
    ),
    # from the batches of particles (docs/particles.md §3)
    "temperature_noise": Sign(
        2e-3,
        1e-2,
        "T has two standard errors of {:.1e} of itself: take more particles",
        "temperature_error_estimate",
        "two standard errors of T over batches, relative",
    ),
    "a2_noise": Sign(
        4e-3,
        3e-2,
        "a2 may be off by {:.1e}, two standard errors and what the box cuts: take more particles",
        "a2_error_estimate",
        "two standard errors of a2 over batches, and the error of a2 at the start by the box",
    ),
    "a2_cut": Sign(
        4e-3,
        3e-2,
        "the box cuts the initial density, which changes a2 by {:.1e}: take a larger R",
    ),
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
        "mass_drift",
        "|ρ/ρ(0) − 1|",
    ),
    # over the thermal speed at the time
    "momentum_drift": Sign(
        1e-3,
        3e-2,
        "the bulk velocity has drifted by {:.1e} thermal speeds: take more directions, or "
        "conserve=('momentum',)",
        "momentum_drift",
        "change of the bulk velocity over the thermal speed",
    ),
    # −min f over max f; spectral ringing of a resolved density stays below 1e-4. Datasets hold min f itself.
    "negative": Sign(
        1e-3, 1e-2, "the density falls to -{:.1e} of its largest value: take a larger N"
    ),
    # |f| over max f; mass at the border wraps around
    "edge": Sign(
        1e-4,
        1e-2,
        "the density at the grid's border is {:.1e} of its largest: take a larger R",
        "edge",
        "largest |f| at the grid's border over max f",
    ),
    # part of ∫f²; about as much lies beyond the last wavenumber
    "tail": Sign(
        1e-2,
        1e-1,
        "{:.1e} of ∫f² is in the last quarter of the wavenumbers: take a larger N or a smaller R, or "
        "frame='rescaled' where the gas cools",
        "spectral_tail",
        "part of ∫f² in the upper quarter of the wavenumbers",
    ),
    # what an unstable step does shows in the other signs
    "step_ratio": Sign(
        1.0,
        np.inf,
        "the step is {:.2g} times what is stable for certain: take a smaller dt, or time_rtol in its "
        "place",
        "step_ratio",
        "step over the largest that is stable for certain",
    ),
}
"""What is measured, by name; docs/method.md §10 gives the errors that the limits were set against."""


def ran_away(error: Exception) -> str:
    """Why a run stopped at an error of `granstudy.support.errors.RAN_AWAY`."""
    return str(error) if isinstance(error, LawRangeError) else NOT_FINITE


def failure(values: Moments) -> str | None:
    """Why a run with these moments has to stop; None where it can go on."""
    if not all(np.isfinite(value).all() for value in values.values()):
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
    """Signs of a density that its grid cannot hold, by the names of `SIGNS`.

    Parameters
    ----------
    f : ndarray, shape grid.shape
        The density on the grid.
    values, first : mapping
        Moments of f, and of the density at the first output.
    grid : VelocitySpace
    """
    largest = np.abs(f).max()
    drift = values["velocity"] - first["velocity"]
    thermal = np.sqrt(values["temperature"])
    return {
        "mass_drift": abs(float(values["density"] / first["density"] - 1.0)),
        "momentum_drift": float(np.sqrt(drift @ drift) / thermal),
        "negative": max(0.0, float(-values["minimum"] / largest)),
        "edge": float(grid.edge(f) / largest),
        "tail": grid.spectral_tail(f),
    }


def warnings(output: Mapping[str, float]) -> dict[str, str]:
    """The warnings of one output, by the names of `SIGNS`; NaN warns too."""
    return {
        name: SIGNS[name].text.format(value)
        for name, value in output.items()
        if not value <= SIGNS[name].marginal
    }


def verdict(outputs: Sequence[Mapping[str, float]], stopped: str) -> tuple[Trust, list[str]]:
    """The label of a run, by the largest value of each sign over its outputs; and the reasons.

    Parameters
    ----------
    outputs : sequence of mapping
        What was measured at each output, by the names of `SIGNS`.
    stopped : str
        Why the run had to stop, "" where it did not. A run that stopped is untrusted.
    """
    names = dict.fromkeys(name for output in outputs for name in output)
    worst = {name: max(output.get(name, 0.0) for output in outputs) for name in names}
    reasons = [*([stopped] if stopped else []), *warnings(worst).values()]
    if stopped or any(not value <= SIGNS[name].untrusted for name, value in worst.items()):
        return Trust.UNTRUSTED, reasons
    return (Trust.MARGINAL if reasons else Trust.TRUSTED), reasons


def health_variables(outputs: Sequence[Mapping[str, float]], stopped: str) -> dict[str, Variable]:
    """What was measured over ``time``, and the label; parameters as of `verdict`."""
    names = outputs[-1] if outputs else ()
    measured = {name: [output[name] for output in outputs] for name in names}
    return sign_variables(measured, "time") | trust_variable(outputs, stopped)


def sign_variables(
    measured: Mapping[str, Any], dims: str | tuple[str, ...] = ()
) -> dict[str, Variable]:
    """The variables of what was measured, given by the names of `SIGNS`."""
    return {
        sign.variable: labelled(measured[name], sign.long_name, dims)
        for name, sign in SIGNS.items()
        if sign.variable and name in measured
    }


def trust_variable(outputs: Sequence[Mapping[str, float]], stopped: str) -> dict[str, Variable]:
    """The label as the variable `trust`, its reasons as an attribute; parameters as of `verdict`."""
    trust, reasons = verdict(outputs, stopped)
    long_name = "how far temperature and kurtosis can be trusted"
    return {"trust": flag_variable(trust, long_name, reasons="\n".join(reasons))}
