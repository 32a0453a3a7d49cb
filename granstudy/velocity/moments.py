"""Velocity moments of a density: density, bulk velocity, temperature, pressure tensor, kurtosis."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from granstudy.support.variables import Variable, labelled
from granstudy.velocity.space import VelocityMoments, VelocitySpace, check_shape

COMPONENTS = ("x", "y", "z")
"""Labels of the components of a velocity."""


@dataclass(frozen=True)
class Quantity:
    """A dimensionless quantity that a run records.

    Attributes
    ----------
    long_name : str
        What it is, in a few words: a label of an axis.
    dimensions : tuple of str
        Dimensions of a vector or a tensor.
    definition : str
        Its formula; "" where the long name says it.
    symbol : str
        On an axis, as Matplotlib's mathematics.
    """

    long_name: str
    dimensions: tuple[str, ...] = ()
    definition: str = ""
    symbol: str = ""

    def labelled(self, values: Any, dims: Sequence[str] = ()) -> Variable:
        """Values of it as a variable: over ``dims``, and its own dimensions after them."""
        more = {"definition": self.definition, "symbol": self.symbol}
        return labelled(
            values,
            self.long_name,
            (*dims, *self.dimensions),
            **{name: text for name, text in more.items() if text},
        )


@dataclass(frozen=True, kw_only=True)
class Moment(Quantity):
    """One moment of a density on a grid.

    Attributes
    ----------
    value : callable
        (integrals over velocity, f, grid) ↦ the moment.
    scaled : callable or None
        (the moment of g, θ, d) ↦ the moment of f(v) = θ^{−d} g((v−u)/θ), which keeps ρ. None where the bulk
        velocity counts too (`granstudy.evolution.frames.physical`).
    """

    value: Callable[[VelocityMoments, np.ndarray, VelocitySpace], Any]
    scaled: Callable[[Any, float, int], Any] | None = lambda value, theta, d: value


def temperature(m: VelocityMoments, d: int) -> Any:
    """T = ∫|v−u|² f dv / (dρ)."""
    return m.pressure.trace() / (d * m.density)


MOMENTS: dict[str, Moment] = {
    "density": Moment(
        "density",
        definition="ρ = ∫f dv",
        symbol=r"$\rho$",
        value=lambda m, f, grid: m.density,
    ),
    "velocity": Moment(
        "bulk velocity",
        ("component",),
        definition="u = ∫v f dv / ρ",
        symbol="$u$",
        value=lambda m, f, grid: m.momentum / m.density,
        scaled=None,
    ),
    "energy": Moment(
        "energy",
        definition="E = ½∫|v|² f dv",
        symbol="$E$",
        value=lambda m, f, grid: m.energy,
        scaled=None,
    ),
    "temperature": Moment(
        "temperature",
        definition="T = ∫|v−u|² f dv / (dρ)",
        symbol="$T$",
        value=lambda m, f, grid: temperature(m, grid.dim),
        scaled=lambda T, theta, d: theta**2 * T,
    ),
    "paper_temperature": Moment(
        "the paper's temperature",
        definition="2E/d: not divided by density, u taken as 0",
        symbol="$2E/d$",
        value=lambda m, f, grid: 2.0 * m.energy / grid.dim,
        scaled=None,
    ),
    "pressure": Moment(
        "pressure tensor",
        ("component", "component_"),
        definition="P = ∫(v−u)(v−u) f dv",
        symbol="$P$",
        value=lambda m, f, grid: m.pressure,
        scaled=lambda P, theta, d: theta**2 * P,
    ),
    "a2": Moment(
        "kurtosis excess",
        definition="a2 = d/(d+2) ⟨|v−u|⁴⟩/⟨|v−u|²⟩² − 1",
        symbol="$a_2$",
        value=lambda m, f, grid: (
            m.fourth / m.density / (grid.dim * (grid.dim + 2) * temperature(m, grid.dim) ** 2) - 1.0
        ),
    ),
    "minimum": Moment(
        "smallest value of the density on the grid",
        symbol=r"$\min f$",
        value=lambda m, f, grid: f.min(),
        scaled=lambda minimum, theta, d: minimum / theta**d,
    ),
}
"""All moments that a run records (paper eqs. 19 to 21), in the order of a dataset; a new one is a new row."""

A3 = Quantity(
    "sixth-order Sonine coefficient",
    definition="a3 = 1 + 3a2 − ⟨|v−u|⁶⟩/(d(d+2)(d+4)T³)",
    symbol="$a_3$",
)
"""A coefficient that states have, and that kept densities give."""

FRAME = {
    "velocity_scale": Quantity(
        "velocity scale of the rescaled frame", definition="θ in v = u + θc", symbol=r"$\theta$"
    ),
    "frame_velocity": Quantity("velocity u of the rescaled frame", ("component",)),
    "collision_time": Quantity("collision time", definition="τ = ∫θ^λ dt", symbol=r"$\tau$"),
}
"""Position of a rescaled frame (docs/method.md §5)."""


def moments(f: np.ndarray, grid: VelocitySpace) -> xr.Dataset:
    """Moments of a density by the grid's quadrature.

    Parameters
    ----------
    f : ndarray, shape grid.shape
        Density. A complex array, as method `literal` advances it, counts by its real part.
    grid : VelocityGrid or RadialGrid

    Returns
    -------
    xarray.Dataset
        The variables of `MOMENTS`, all dimensionless: `velocity` over ``component``, `pressure` over
        ``component`` × ``component_``.

    Raises
    ------
    ValueError
        If ``f`` has another shape than the grid.
    """
    check_shape(f, grid)
    values = moment_values(np.real(f), grid)
    components = list(COMPONENTS[: grid.dim])
    return xr.Dataset(
        {name: moment.labelled(values[name]) for name, moment in MOMENTS.items()},
        coords={"component": components, "component_": components},
    )


def moment_values(f: np.ndarray, grid: VelocitySpace) -> dict[str, Any]:
    """The moments of `MOMENTS` as plain arrays, for use at every step."""
    m = grid.velocity_moments(f)
    return {name: moment.value(m, f, grid) for name, moment in MOMENTS.items()}
