"""Velocity moments of a density: density, bulk velocity, temperature, pressure tensor, kurtosis."""

import numpy as np
import xarray as xr

from granstudy.velocity.space import VelocitySpace, check_shape

COMPONENTS = ("x", "y", "z")
"""Labels of the components of a velocity."""

LONG_NAMES = {
    "density": "density ρ = ∫f dv",
    "velocity": "bulk velocity u = ∫v f dv / ρ",
    "energy": "energy E = ½∫|v|² f dv",
    "temperature": "temperature T = ∫|v−u|² f dv / (dρ)",
    "paper_temperature": "2E/d, the paper's temperature: not divided by density, u taken as 0",
    "pressure": "pressure tensor P = ∫(v−u)(v−u) f dv",
    "a2": "kurtosis excess a2 = d/(d+2) ⟨|v−u|⁴⟩/⟨|v−u|²⟩² − 1",
    "minimum": "smallest value of the density on the grid",
}
"""The moments of a density, with the long name of each in a dataset."""

FRAME_LONG_NAMES = {
    "velocity_scale": "velocity scale θ of the rescaled frame, v = u + θc",
    "frame_velocity": "velocity u of the rescaled frame",
    "collision_time": "collision time τ = ∫θ^λ dt",
}
"""Position of a rescaled frame, with long names in a dataset (docs/method.md §5)."""

DIMENSIONS: dict[str, tuple[str, ...]] = {
    "velocity": ("component",),
    "frame_velocity": ("component",),
    "pressure": ("component", "component_"),
}
"""Dimensions of the moments that are not scalars."""


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
        The variables of `LONG_NAMES`, all dimensionless: `velocity` over ``component``, `pressure` over
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
        {
            name: (DIMENSIONS.get(name, ()), value, {"long_name": LONG_NAMES[name], "units": "1"})
            for name, value in values.items()
        },
        coords={"component": components, "component_": components},
    )


def moment_values(f: np.ndarray, grid: VelocitySpace) -> dict[str, np.ndarray]:
    """The moments of `LONG_NAMES` as plain arrays, for use at every step (paper eqs. 19 to 21)."""
    d = grid.dim
    m = grid.velocity_moments(f)
    temperature = np.trace(m.pressure) / (d * m.density)
    return {
        "density": m.density,
        "velocity": m.momentum / m.density,
        "energy": m.energy,
        "temperature": temperature,
        "paper_temperature": 2.0 * m.energy / d,
        "pressure": m.pressure,
        "a2": m.fourth / m.density / (d * (d + 2) * temperature**2) - 1.0,
        "minimum": f.min(),
    }
