"""A kept density at any velocities, its marginals, its averages over directions, in thermal units."""

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.fft
import xarray as xr
from scipy.integrate import lebedev_rule

from granstudy.reading.kept import Kept
from granstudy.reading.weights import check_method, line_weights, speed_weights
from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.moments import COMPONENTS
from granstudy.velocity.radial import RadialGrid
from granstudy.velocity.sphere import sphere_area, sphere_mean

REACH, POINTS = 6.0, 121
"""Velocities where none are asked for: so many thermal speeds either way, in so many points."""

ANGLES, DEGREE = 96, 29
"""Directions of a local average: angles in 2D, degree of Lebedev's rule in 3D."""

Velocities = Any
"""Numbers, an array, or an `xarray.DataArray`."""


def along(name: str, values: Velocities, long_name: str) -> xr.DataArray:
    """Velocities as a labelled array: a list becomes a dimension of that name."""
    if isinstance(values, xr.DataArray):
        return values.astype(float)
    array = np.asarray(values, dtype=float)
    if array.ndim > 1:
        raise ValueError(
            f"{name}: has shape {array.shape}; give a number, a list, or a DataArray that names its axes"
        )
    attrs = {"long_name": long_name, "symbol": f"${name[0]}_{name[1:]}$", "units": "1"}
    found = xr.DataArray(array, dims=(name,) * array.ndim, attrs=attrs)
    return found.assign_coords({name: found}) if array.ndim else found


def default_velocities(kept: Kept, component: str) -> np.ndarray:
    """Velocities that hold all densities: `REACH` thermal speeds of the hottest about u."""
    u, reach = kept.bulk(component), REACH * float(kept.thermal.max())
    return np.linspace(float(u.min()) - reach, float(u.max()) + reach, POINTS)


def at(kept: Kept, components: dict[str, Velocities], method: str = "spectral") -> xr.DataArray:
    """f at any velocities.

    Parameters
    ----------
    kept : Kept
    components : dict
        ``vx``, ``vy``, ``vz``: numbers, lists, or DataArrays. Lists make a grid; DataArrays over common
        dimensions make points. A component that is left out is the bulk velocity's.
    method : str
        ``spectral``, the grid's own series; or ``local``, for tails (`granstudy.reading.weights`).

    Raises
    ------
    ValueError
        For an unknown component or method.
    """
    names = [f"v{c}" for c in COMPONENTS[: kept.dim]]
    unknown = [name for name in components if name not in names]
    if unknown:
        raise ValueError(f"{', '.join(unknown)}: a density in {kept.dim}D has {', '.join(names)}")
    given = {
        name: along(name, components[name], f"velocity {name[1]}")
        if name in components
        else kept.bulk(name[1])
        for name in names
    }
    c = {name: kept.component(name[1], v) for name, v in given.items()}
    values = _at(kept, list(c.values()), method) / kept.scale**kept.dim
    return kept.labelled(values, "f", "velocity density", "$f$")


def marginal(
    kept: Kept, component: str, v: Velocities | None = None, method: str = "spectral"
) -> xr.DataArray:
    """∫f over the other components of the velocity, at values of one component.

    On a radial grid the density along the other components is summed by Gauss–Legendre nodes.
    """
    if component not in COMPONENTS[: kept.dim]:
        raise ValueError(
            f"axis={component!r}: a density in {kept.dim}D has {COMPONENTS[: kept.dim]}"
        )
    name = f"v{component}"
    v = along(
        name, default_velocities(kept, component) if v is None else v, f"velocity {component}"
    )
    c = kept.component(component, v)
    grid = kept.grid
    if isinstance(grid, VelocityGrid):
        axis = COMPONENTS.index(component)
        others = [a for i, a in enumerate(kept.axes) if i != axis]
        weights = _weights(lambda x: line_weights(grid, x, method), c, kept.axes[axis])
        g = kept.g.sum(others) * grid.spacing ** (kept.dim - 1)
        values = xr.dot(g, weights, dim=kept.axes[axis])
    else:
        weights = _weights(lambda x: _marginal_weights(grid, x, method), c, kept.axes[0])
        values = xr.dot(kept.g, weights, dim=kept.axes[0])
    text = f"density of the velocity component {component}"
    return kept.labelled(values / kept.scale, f"f_{component}", text, f"$f_{component}$")


def radial(kept: Kept, speeds: Velocities | None = None, method: str = "spectral") -> xr.DataArray:
    """Average of f over the directions of v − u, at speeds |v − u|."""
    if speeds is None:
        speeds = np.linspace(0.0, REACH * float(kept.thermal.max()), POINTS)
    s = _with_symbol(along("speed", speeds, "speed |v − u|"), "$|v-u|$")
    values = _mean(kept, s / kept.scale, method) / kept.scale**kept.dim
    return kept.labelled(values, "f", "velocity density, mean over directions", r"$\bar f$")


def scaled(
    kept: Kept,
    c: Velocities | None = None,
    component: str | None = None,
    method: str = "local",
) -> xr.DataArray:
    """T^{d/2} f/ρ over c = (v − u)/√T, which is (2π)^{−d/2} e^{−c²/2} of a Gaussian.

    Parameters
    ----------
    c : numbers, optional
        Thermal velocities; by default up to `REACH`.
    component : str, optional
        The axis through the bulk velocity along which c is taken; by default c is the speed, and the density
        is averaged over directions.
    method : str
        As of `at`; ``local`` keeps small values of the tail.
    """
    if c is None:
        c = np.linspace(0.0 if component is None else -REACH, REACH, POINTS)
    text = r"thermal velocity (v − u)/√T" if component else r"thermal speed |v − u|/√T"
    symbol = rf"$(v_{component}-u_{component})/\sqrt{{T}}$" if component else r"$|v-u|/\sqrt{T}$"
    c = _with_symbol(along("c", c, text), symbol)
    if component is None:
        values = _mean(kept, c * kept.thermal / kept.scale, method)
    else:
        if component not in COMPONENTS[: kept.dim]:
            raise ValueError(f"axis={component!r}: allowed are {', '.join(COMPONENTS[: kept.dim])}")
        v = {
            k: kept.bulk(k) + (c * kept.thermal if k == component else 0.0)
            for k in COMPONENTS[: kept.dim]
        }
        values = _at(kept, [kept.component(k, one) for k, one in v.items()], method)
    found = values * (kept.thermal / kept.scale) ** kept.dim / kept.density
    text = "density in thermal units"
    return kept.labelled(found, "scaled_density", text, r"$T^{d/2} f/\rho$")


def over_maxwellian(density: xr.DataArray, dim: int) -> xr.DataArray:
    """A density of `scaled` over that of the Gaussian of the same ρ, u and T."""
    gaussian = np.exp(-(density["c"] ** 2) / 2) / (2 * np.pi) ** (dim / 2)
    found = (density / gaussian).rename("over_maxwellian")
    return found.assign_attrs(
        long_name="density over the Maxwellian of the same density, velocity and temperature",
        symbol=r"$f/f_\mathrm{M}$",
        units="1",
    )


def _with_symbol(values: xr.DataArray, symbol: str) -> xr.DataArray:
    """Velocities with another symbol, also where they are a coordinate."""
    for coordinate in values.coords.values():
        if coordinate.dims == values.dims:
            coordinate.attrs["symbol"] = symbol
    return values.assign_attrs(symbol=symbol)


def _weights(
    weights: Callable[[np.ndarray], np.ndarray], x: xr.DataArray, axis: str
) -> xr.DataArray:
    """Weights at labelled points, over their dimensions and a grid's axis."""
    return xr.DataArray(weights(x.values), dims=(*x.dims, axis), coords=dict(x.coords))


def _at(kept: Kept, c: list[xr.DataArray], method: str) -> xr.DataArray:
    """g at velocities in the frame's units."""
    grid = kept.grid
    if isinstance(grid, VelocityGrid):
        values = kept.g
        for axis, x in zip(kept.axes, c, strict=True):
            # One axis at a time: points of a grid then cost little more than points of a line.
            weights = _weights(lambda x: line_weights(grid, x, method), x, axis)
            values = xr.dot(values, weights, dim=axis)
        return values
    speed = xr.concat([x**2 for x in c], "component").sum("component") ** 0.5
    weights = _weights(lambda x: speed_weights(grid, x, method), speed, kept.axes[0])
    return xr.dot(kept.g, weights, dim=kept.axes[0])


def _mean(kept: Kept, speed: xr.DataArray, method: str) -> xr.DataArray:
    """Mean of g over directions about the bulk velocity, at speeds in the frame's units."""
    check_method(method)
    grid = kept.grid
    if not isinstance(grid, VelocityGrid):
        weights = _weights(lambda x: speed_weights(grid, x, method), speed, kept.axes[0])
        return xr.dot(kept.g, weights, dim=kept.axes[0])
    centre = xr.concat(
        [kept.component(k, kept.bulk(k)) for k in COMPONENTS[: kept.dim]], "component_of_centre"
    )
    if method == "spectral":
        points = [dim for dim in speed.dims if dim not in kept.g.dims]
        return xr.apply_ufunc(
            lambda g, u, s: _spectral_mean(grid, g, u, s),
            kept.g,
            centre,
            speed,
            input_core_dims=[list(kept.axes), ["component_of_centre"], points],
            output_core_dims=[points],
            vectorize=True,
            dask="parallelized",
            output_dtypes=[float],
        )
    directions, rule_weights = _directions(kept.dim)
    rule = xr.DataArray(directions, dims=("component_of_centre", "direction"))
    c = [
        centre.isel(component_of_centre=i) + speed * rule.isel(component_of_centre=i)
        for i in range(kept.dim)
    ]
    return xr.dot(
        _at(kept, c, method), xr.DataArray(rule_weights, dims="direction"), dim="direction"
    )


def _directions(dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors, shape (d, n), and their weights, which sum to 1."""
    if dim == 2:
        angle = 2 * np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
        return np.array([np.cos(angle), np.sin(angle)]), np.full(ANGLES, 1.0 / ANGLES)
    points, weights = lebedev_rule(DEGREE)
    return points, weights / weights.sum()


def _spectral_mean(
    grid: VelocityGrid, g: np.ndarray, centre: np.ndarray, speeds: np.ndarray
) -> np.ndarray:
    """Mean of g's trigonometric series over spheres about a centre; 0 for spheres that leave the box.

    The mean of Σ_k ĝ_k e^{iπk·v/L} over |v − u| = s is Σ_k ĝ_k e^{iπk·u/L} M(π|k|s/L).
    """
    spectrum = scipy.fft.fftn(g) / g.size
    for axis, u in enumerate(centre):
        phase = np.exp(1j * np.pi / grid.L * grid.wavenumbers * (u - grid.nodes[0]))
        spectrum *= phase.reshape([-1 if i == axis else 1 for i in range(grid.dim)])
    shells, place = np.unique(grid.wavenumber_squared(), return_inverse=True)
    c = np.bincount(place.ravel(), weights=spectrum.real.ravel())
    k = np.pi / grid.L * np.sqrt(shells)
    values = sphere_mean(grid.dim, np.multiply.outer(speeds, k)) @ c
    return np.where(speeds + np.max(np.abs(centre)) <= grid.L, values, 0.0)


def _marginal_weights(grid: RadialGrid, x: np.ndarray, method: str) -> np.ndarray:
    """Weights of radial nodes for ∫ f over the other components, |S^{d−2}| ∫ f(√(x² + s²)) s^{d−2} ds."""
    nodes, weights = np.polynomial.legendre.leggauss(4 * grid.N)
    most = np.sqrt(np.maximum(grid.L**2 - x**2, 0.0))
    s = 0.5 * most[..., None] * (nodes + 1.0)
    w = 0.5 * most[..., None] * weights * s ** (grid.dim - 2)
    area = 2.0 if grid.dim == 2 else sphere_area(2)
    values = speed_weights(grid, np.hypot(x[..., None], s), method)
    return area * np.einsum("...s,...sj->...j", w, values)
