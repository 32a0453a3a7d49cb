"""Moments and averages of kept densities, over all dimensions of a dataset."""

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from granstudy.evolution.frames.physical import physical_moments
from granstudy.reading.kept import Kept
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.moments import A3, COMPONENTS, MOMENTS, Quantity, moment_values
from granstudy.velocity.space import VelocitySpace


def density_moments(kept: Kept) -> xr.Dataset:
    """The moments of `granstudy.velocity.moments.MOMENTS` and a3 of every kept density.

    Lazy where the densities are.
    """
    quantities: dict[str, Quantity] = {**MOMENTS, "a3": A3}
    grid, d = kept.grid, kept.dim
    values = xr.apply_ufunc(
        lambda g, theta, u: _moments(grid, g, float(theta), u),
        kept.g,
        kept.scale,
        kept.velocity,
        input_core_dims=[list(kept.axes), [], ["component"]],
        output_core_dims=[list(quantity.dimensions) for quantity in quantities.values()],
        vectorize=True,
        dask="parallelized",
        output_dtypes=[float] * len(quantities),
        dask_gufunc_kwargs={"output_sizes": {"component": d, "component_": d}},
    )
    components = list(COMPONENTS[:d])
    found = xr.Dataset(
        {
            name: value.assign_attrs(quantity.labelled(0.0)[2])
            for (name, quantity), value in zip(quantities.items(), values, strict=True)
        }
    )
    return found.assign_coords(component=components, component_=components)


def average(kept: Kept, function: Callable[..., Any]) -> xr.DataArray:
    """⟨φ⟩ = ∫φ f dv/∫f dv for any function of the velocity.

    Parameters
    ----------
    function : callable
        φ of the velocity's components, arrays that broadcast; on a radial grid of the speed.
    """
    grid = kept.grid
    if isinstance(grid, VelocityGrid):
        v = [
            kept.frame.sel(component=c, drop=True)
            + kept.scale * xr.DataArray(grid.nodes, dims=axis)
            for c, axis in zip(COMPONENTS, kept.axes, strict=False)
        ]
        weighted = kept.g
    else:
        v = [kept.scale * xr.DataArray(grid.nodes, dims=kept.axes)]
        weighted = kept.g * xr.DataArray(grid.weights, dims=kept.axes)
    found = (weighted * function(*v)).sum(kept.axes) / weighted.sum(kept.axes)
    return kept.labelled(found, "average", "average over the velocity", r"$\langle\varphi\rangle$")


def _moments(grid: VelocitySpace, g: np.ndarray, theta: float, u: np.ndarray) -> tuple[Any, ...]:
    """Moments of f = θ^{−d} g((v − w)/θ) in the order of `MOMENTS`, then a3; NaN of a density that is NaN."""
    if not np.isfinite(g).all():
        empty = [np.full((grid.dim,) * len(m.dimensions), np.nan) for m in MOMENTS.values()]
        return (*empty, np.nan)
    values = moment_values(g, grid)
    found = physical_moments(values, theta, u)
    return (*(found[name] for name in MOMENTS), sonine_a3(g, grid, values))


def sonine_a3(g: np.ndarray, grid: VelocitySpace, values: dict[str, Any]) -> float:
    """a3 of a density whose moments are known."""
    d, T = grid.dim, values["temperature"]
    speed2 = sum((v - u) ** 2 for v, u in zip(grid.velocities(), values["velocity"], strict=True))
    sixth = float((np.asarray(speed2) ** 3 * g * grid.measure).sum() / values["density"])
    return float(1.0 + 3.0 * values["a2"] - sixth / (d * (d + 2) * (d + 4) * T**3))
