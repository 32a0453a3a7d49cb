"""Kept densities of one or many runs, in whatever frame and on whatever grid."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from granstudy.velocity.cartesian import VelocityGrid
from granstudy.velocity.moments import COMPONENTS
from granstudy.velocity.radial import RadialGrid

NODE = "node_"
"""Names of the grid's axes begin so while a density is worked on: ``vx`` may be an axis of the answer."""


@dataclass(frozen=True)
class Kept:
    """Densities f(v) = θ^{−d} g((v − w)/θ), over all dimensions that the dataset has.

    Attributes
    ----------
    g : xarray.DataArray
        The density as it was kept, over ``axes`` and the dataset's other dimensions; Dask's where the
        dataset's is.
    axes : tuple of str
        Names of the grid's axes in ``g``.
    grid : VelocityGrid or RadialGrid
    scale, frame : xarray.DataArray
        θ, and w over ``component``; 1 and 0 in the fixed frame.
    density, temperature, velocity : xarray.DataArray
        ρ, T and u (over ``component``) of each density, as the run recorded them.
    """

    g: xr.DataArray
    axes: tuple[str, ...]
    grid: VelocityGrid | RadialGrid
    scale: xr.DataArray
    frame: xr.DataArray
    density: xr.DataArray
    temperature: xr.DataArray
    velocity: xr.DataArray

    @property
    def dim(self) -> int:
        """Velocity dimension."""
        return self.grid.dim

    @property
    def thermal(self) -> xr.DataArray:
        """The thermal speed √T of each density."""
        return self.temperature**0.5

    def bulk(self, component: str) -> xr.DataArray:
        """A component of the bulk velocity."""
        return self.velocity.sel(component=component, drop=True)

    def component(self, component: str, v: xr.DataArray) -> xr.DataArray:
        """A component of velocities in the frame's own units, (v − w)/θ."""
        return (v - self.frame.sel(component=component, drop=True)) / self.scale

    def labelled(
        self, values: xr.DataArray, name: str, long_name: str, symbol: str
    ) -> xr.DataArray:
        """An answer with its name and attributes, without what is over the grid's axes."""
        values = values.drop_vars([n for n, c in values.coords.items() if _on(self.axes, c.dims)])
        return values.rename(name).assign_attrs(long_name=long_name, symbol=symbol, units="1")


def kept(ds: xr.Dataset) -> Kept:
    """The densities that a dataset holds.

    Raises
    ------
    ValueError
        If it holds none, or not all values of a density, or not the outputs at which they were kept.
    """
    name = next((name for name in ("f", "g") if name in ds), None)
    if name is None:
        raise ValueError(
            "the dataset holds no density: give simulate or time.save_every, and open runs with "
            "densities=True"
        )
    letter = "c" if name == "g" else "v"
    radial = {"f": "r", "g": "c"}[name]
    components = [c for c in COMPONENTS if f"{letter}{c}" in ds.dims]
    dim = ds.sizes.get("component", len(components))
    own = (radial,) if radial in ds.dims else tuple(f"{letter}{c}" for c in COMPONENTS[:dim])
    grid = _grid(ds, dim, own)
    density = ds[name].rename({axis: NODE + axis for axis in own})
    density = density.drop_vars([n for n, c in density.coords.items() if _on(own, c.dims)])
    density = density.drop_vars([NODE + axis for axis in own if NODE + axis in density.coords])
    scale, frame = xr.DataArray(1.0), xr.zeros_like(_kept(ds, "velocity"))
    if name == "g":
        scale = _kept(ds, "velocity_scale")
        frame = _kept(ds, "frame_velocity" if "frame_velocity" in ds else "velocity")
    return Kept(
        g=density,
        axes=tuple(NODE + axis for axis in own),
        grid=grid,
        scale=scale,
        frame=frame,
        density=_kept(ds, "density"),
        temperature=_kept(ds, "temperature"),
        velocity=_kept(ds, "velocity"),
    )


def _on(axes: tuple[str, ...], dims: tuple[Hashable, ...]) -> bool:
    return bool(set(axes) & set(dims))


def _grid(ds: xr.Dataset, dim: int, axes: tuple[str, ...]) -> VelocityGrid | RadialGrid:
    """The grid of a dataset's densities."""
    sizes = {ds.sizes.get(axis, 0) for axis in axes}
    numbers = {"N": np.unique(ds["N"].values), "R": np.unique(ds["R"].values)}
    for key, found in numbers.items():
        if found.size != 1:
            raise ValueError(
                f"{key}: the runs have {found.tolist()}; select one, as in ds.sel({key}=..)"
            )
    N, R = int(numbers["N"][0]), float(numbers["R"][0])
    if sizes != {N}:
        raise ValueError(
            f"{', '.join(axes)}: the density has {sorted(sizes)} values of N={N}; leave its axes whole, "
            "and take parts of the answer"
        )
    return VelocityGrid(dim, N, R) if len(axes) > 1 else RadialGrid(dim, N, R)


def _kept(ds: xr.Dataset, name: str) -> xr.DataArray:
    """A moment at the times of the kept densities; NaN where a run ended earlier."""
    values = ds[name]
    if "snapshot" not in ds.coords or "time" not in ds.coords:
        return _plain(values)
    snapshot, time = ds["snapshot"], ds["time"]
    output = [dim for dim in time.dims if dim in ("time", "output")]
    keeping = [dim for dim in snapshot.dims if dim in ("snapshot", "kept")]
    place = xr.apply_ufunc(
        _places,
        _plain(snapshot),
        _plain(time),
        input_core_dims=[keeping, output],
        output_core_dims=[keeping],
        vectorize=True,
        output_dtypes=[np.int64],
    )
    there = np.isfinite(_plain(snapshot))
    if bool(((place < 0) & there).any()):
        raise ValueError(
            "time: lacks outputs at which densities were kept; leave time whole, and select by snapshot"
        )
    values = _plain(values)
    if output and output[0] in values.dims:
        values = values.isel({output[0]: place.clip(min=0)})
    elif output:
        raise ValueError(f"{name}: is not over {output[0]}")
    return values.where(there)


def _places(snapshots: np.ndarray, times: np.ndarray) -> Any:
    """Places of snapshots among times; −1 where there is none."""
    equal = np.asarray(snapshots)[..., None] == np.atleast_1d(times)
    return np.where(equal.any(axis=-1), equal.argmax(axis=-1), -1)


def _plain(values: xr.DataArray) -> xr.DataArray:
    """Values without coordinates but those of their own dimensions that are no times."""
    kept_coords = [
        dim for dim in values.dims if dim in values.coords and dim not in ("time", "snapshot")
    ]
    return values.reset_coords(drop=True).drop_vars(
        [name for name in values.coords if name not in kept_coords and name in values.dims]
    )
