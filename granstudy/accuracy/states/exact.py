"""Maxwell molecules, of whose states the moments are known exactly."""

from dataclasses import dataclass

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.accuracy.states.ladder import UNKNOWN, Found
from granstudy.model.scene import Scene
from granstudy.trust.flags import Status
from granstudy.velocity.sphere import sphere_area

EXACT_UP_TO = 88
"""N of the largest grid for a density whose moments are exact: a larger R gains slowly on a power law."""

EXACT_TO = 1e-12
"""Error that is stated of exact moments: their round-off."""

NAMES = ("cooling_coefficient", "cooling_rate", "temperature", "velocity_scale", "a2", "a3")
"""What is known exactly."""

MOMENTS = {"cooling": theory.maxwell_cooling_moments, "heated": theory.maxwell_heated_moments}
"""Exact even moments by the state."""


@dataclass(frozen=True)
class ExactState:
    """The numbers of a state of Maxwell molecules, by `NAMES`; NaN for an a3 that is infinite."""

    values: dict[str, float]

    @classmethod
    def of(cls, scene: Scene, state: str, ds: xr.Dataset) -> "ExactState":
        """The exact numbers of a state, at the density and the temperature that it has on a grid.

        K = (1−e²)/4 |S|C_0. In the heated state 2ε = ρKT.
        """
        assert not callable(scene.restitution)
        e = float(scene.restitution)
        K = (1.0 - e**2) / 4.0 * sphere_area(scene.dim) * scene.kernel.strength
        rate = float(ds["density"]) * K
        T, theta = float(ds["temperature"]), float(ds["velocity_scale"])
        if state == "heated":
            T, theta = (
                2.0 * scene.diffusion / rate,
                theta * float(np.sqrt(2.0 * scene.diffusion / rate / T)),
            )
        a2, a3 = theory.sonine_coefficients(MOMENTS[state](3, e, scene.dim))
        found = (K, rate, T, theta, a2, a3 if np.isfinite(a3) else np.nan)
        return cls(dict(zip(NAMES, found, strict=True)))

    def on_grid(self, ds: xr.Dataset) -> Found:
        """A grid's state, with the errors that its numbers have."""
        if int(ds["status"]) != Status.OK:
            return Found(ds, UNKNOWN, UNKNOWN, np.nan)
        relative = [
            abs(float(ds[name]) / self.values[name] - 1.0)
            for name in ("cooling_coefficient", "temperature")
        ]
        a2, a3 = (abs(float(ds[name]) - self.values[name]) for name in ("a2", "a3"))
        return Found(ds, max(relative), a2, a3)

    def in_place(self, ds: xr.Dataset) -> Found:
        """A grid's state, with exact numbers in place of the grid's own."""
        if int(ds["status"]) != Status.OK:
            return Found(ds, UNKNOWN, UNKNOWN, np.nan)
        exact = {
            name: ds[name].copy(data=value).assign_attrs(source="exact moments")
            for name, value in self.values.items()
        }
        a3 = EXACT_TO if np.isfinite(self.values["a3"]) else np.nan
        return Found(ds.assign(exact), EXACT_TO, EXACT_TO, a3)


def has_exact_moments(scene: Scene) -> bool:
    """Whether a gas is of Maxwell molecules."""
    return scene.kernel.exponent == 0.0
