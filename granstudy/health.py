"""Signs that a run cannot be trusted, looked for while it runs."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.velocity_space import VelocitySpace


@dataclass(frozen=True)
class HealthLimits:
    """Where a quantity becomes worth a warning.

    Attributes
    ----------
    mass_drift : float
        Relative change of the density ρ; the `full` variant keeps it to 1e-12.
    negative : float
        −min f / max f. Spectral ringing of a resolved density stays under 1e-4.
    edge : float
        Largest |f| at the grid's border over max f: what lies there wraps around.
    width : float
        Thermal speed √T in grid spacings; a Gaussian narrower than 1.25 spacings has more than 1e-3
        of its spectrum beyond the last wavenumber.
    """

    mass_drift: float = 1e-2
    negative: float = 1e-2
    edge: float = 1e-3
    width: float = 1.25


LIMITS = HealthLimits()
NOT_FINITE = "the density became NaN or infinite: take a smaller dt"


def failure(values: dict[str, Any]) -> str | None:
    """Why a run with these moments has to stop, or None."""
    if not all(np.all(np.isfinite(value)) for value in values.values()):
        return NOT_FINITE
    if values["density"] <= 0.0:
        return f"the density ρ fell to {values['density']:.3g}"
    if values["temperature"] <= 0.0:
        return f"the temperature fell to {values['temperature']:.3g}: the grid has lost the gas"
    return None


def warnings(
    f: np.ndarray, values: dict[str, Any], density0: float, grid: VelocitySpace
) -> dict[str, str]:
    """Warnings by name for one state, with the measured number and the remedy."""
    found = {}
    drift = abs(values["density"] / density0 - 1.0)
    if drift > LIMITS.mass_drift:
        found["mass_drift"] = (
            f"mass has drifted by {drift:.2g} of its start: take more directions or variant 'full'"
        )
    largest = np.max(np.abs(f))
    if -values["minimum"] > LIMITS.negative * largest:
        found["negative"] = (
            f"the density falls to {values['minimum']:.2g} (largest value {largest:.2g}): "
            "take a larger N"
        )
    edge = grid.edge(f)
    if edge > LIMITS.edge * largest:
        found["edge"] = (
            f"the density at the box's faces is {edge / largest:.2g} of its largest: "
            "take a larger R"
        )
    width = np.sqrt(values["temperature"]) / grid.spacing
    if width < LIMITS.width:
        found["width"] = (
            f"the thermal speed is {width:.2f} grid spacings: take a larger N or a smaller R"
        )
    return found
