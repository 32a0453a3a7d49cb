"""Kept densities of many runs as arrays whose values stay on disk until they are used."""

import numpy as np
import xarray as xr

from granstudy.datasets.gathering import Axis, place
from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.storage.encoding import DENSITY_AXES, VELOCITY_AXES, Contents, Density


class Densities:
    """Densities of the runs met so far, in the order of their rows."""

    def __init__(self) -> None:
        self.files: list[str] = []
        self.found: list[dict[str, Density]] = []
        self.axes: dict[str, Axis] = {}
        self.labels: dict[str, xr.Variable] = {}
        self.equal = True

    def add(self, file: str, run: Contents) -> None:
        """Take where the densities of the next run lie, and their axes."""
        row = len(self.files)
        self.files.append(file)
        self.found.append(run.densities)
        for name, (dims, values, attrs) in run.variables.items():
            if not DENSITY_AXES.intersection(dims):
                continue
            known = self.labels.setdefault(name, xr.Variable(dims, values, attrs))
            if dims == (name,):
                self.axes.setdefault(name, Axis()).add(row, values)
            if VELOCITY_AXES.intersection(dims):
                self.equal = self.equal and np.array_equal(known.values, values)

    def added_to(self, runs: xr.Dataset) -> xr.Dataset:
        """The runs with their densities; NaN where a run has no density, or ended early.

        Raises
        ------
        ValueError
            If runs differ in their velocity grid.
        """
        if not self.equal:
            pairs = zip(runs["N"].values.tolist(), runs["R"].values.tolist(), strict=True)
            raise ValueError(
                f"N, R: the runs have velocity grids {sorted(set(pairs))}; open one grid at a time, "
                "or with densities=False"
            )
        labels = dict(self.labels)
        renamed = {name: place(name) for name, axis in self.axes.items() if not axis.is_shared}
        for name, axis in self.axes.items():
            if name in renamed:
                values = axis.values(len(self.files))
                labels[name] = xr.Variable(("run", renamed[name]), values, labels[name].attrs)
            else:
                labels[name] = xr.Variable((name,), axis.longest, labels[name].attrs)
        names = dict.fromkeys(name for found in self.found for name in found)
        densities = {name: self._lazy(name, renamed) for name in names}
        return runs.assign_coords(labels).assign(densities)

    def _lazy(self, name: str, renamed: dict[str, str]) -> xr.Variable:
        """A density of all runs; a file is read when its density is used."""
        # Dask takes a tenth of a second to import, which most users of this module do not need.
        import dask.array as da
        from dask.delayed import delayed

        one = next(found[name] for found in self.found if name in found)
        sizes = {dim: axis.longest.size for dim, axis in self.axes.items()}
        shape = tuple(sizes.get(dim, n) for dim, n in zip(one.dims, one.shape, strict=True))
        rows = [
            da.from_delayed(delayed(_density)(file, name, shape), shape, one.dtype)
            if name in found
            else da.full(shape, np.nan, dtype=one.dtype)
            for file, found in zip(self.files, self.found, strict=True)
        ]
        dims = ("run", *(renamed.get(dim, dim) for dim in one.dims))
        return xr.Variable(dims, da.stack(rows), one.attrs)


def _density(file: str, name: str, shape: tuple[int, ...]) -> np.ndarray:
    """A density from its file, whose checksum is verified; NaN behind an early end."""
    values = read_dataset(file)[name].values
    found = np.full(shape, np.nan, values.dtype)
    found[tuple(map(slice, values.shape))] = values
    return found
