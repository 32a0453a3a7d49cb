"""`ds.granular.plot`: what a kineticist draws of runs, in one line each."""

from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from granstudy.analysis.figures.cooling import cooling_figure, slope_figure
from granstudy.analysis.figures.front import benchmark_front
from granstudy.analysis.figures.plots.data import (
    at_end,
    default_abscissa,
    over_parameters,
    profile,
    quantity_over,
    snapshots,
)
from granstudy.analysis.figures.plots.labels import symbol_of
from granstudy.analysis.figures.plots.profiles import profile_figure
from granstudy.analysis.figures.plots.quantity import lines_figure, map_figure
from granstudy.analysis.figures.plots.whole_runs import run_front
from granstudy.reading.cooling import haff, slopes

Quantity = str | xr.DataArray


class Plots:
    """Figures of a dataset; a study file asks for the same as ``figure: {kind: ..}``.

    Lines differ by colour in one parameter and by style in the others; more than six numbers have a colour
    bar. Markers are filled for trusted runs, hollow for marginal and pale for untrusted ones.
    Every method takes ``title``, and returns a `matplotlib.figure.Figure`.

    Parameters
    ----------
    ds : xarray.Dataset
        As of `granstudy.Granular`.
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._given, self._ds = ds, over_parameters(ds)

    def __call__(self, quantity: Quantity, x: str | None = None, **look: Any) -> Figure:
        """Draw a quantity over time or over a parameter.

        Parameters
        ----------
        quantity : str or DataArray
            A variable of the dataset, or what ``ds.granular`` gives: ``ds.granular.haff()["C0"]``.
        x : str, optional
            ``time``, or a parameter: values at the end of each run. Default: time, or the longest dimension.
        look
            ``xscale``, ``yscale`` (``linear``, ``log``, ``symlog``), ``title``.
        """
        return self.quantity(quantity, x, **look)

    def quantity(self, quantity: Quantity, x: str | None = None, **look: Any) -> Figure:
        """Draw a quantity over time or over a parameter, as calling ``plot`` does."""
        chosen = default_abscissa(self._ds, quantity) if x is None else x
        y = quantity_over(self._ds, quantity, chosen)
        return lines_figure(y, chosen, self._trust, **look)

    def temperature(self, x: str | None = None, **look: Any) -> Figure:
        """Draw T over time, or over a parameter."""
        return self.quantity("temperature", x, **look)

    def a2(self, x: str | None = None, **look: Any) -> Figure:
        """Draw the kurtosis excess over time, or over a parameter."""
        return self.quantity("a2", x, **look)

    def map(self, quantity: Quantity, x: str, y: str, *, title: str | None = None) -> Figure:
        """Draw a quantity at the end of each run over two parameters."""
        z = quantity_over(self._ds, quantity, x)
        return map_figure(z, x, y, self._trust, title=title)

    def cooling(
        self, *, fit: bool = True, scale: str | None = None, title: str | None = None, **how: Any
    ) -> Figure:
        """Draw T(t) with fitted Haff laws, on logarithmic axes where outputs span decades.

        Parameters
        ----------
        fit : bool
            Whether laws are fitted; gases without one have none (`Granular.haff` says why).
        scale : str, optional
            ``log`` or ``linear``.
        how
            As of `Granular.haff`.
        """
        runs = self._ds
        if fit:
            runs = runs.assign(C0=haff(runs, **how)["C0"])
        return cooling_figure(runs, scale=scale, title=title)

    def slope(self, *, title: str | None = None) -> Figure:
        """Draw T(t) over decades, and how far d ln T/d ln t is from Haff's −2/λ."""
        return slope_figure(self._ds, title=title)

    def over_maxwellian(self, axis: str | None = None, **which: Any) -> Figure:
        """Draw f over the Maxwellian of the same ρ, u and T against c = |v − u|/√T, or along an axis.

        Parameters
        ----------
        axis : str, optional
            ``x``, ``y``, ``z``; by default f is averaged over directions.
        which
            ``snapshot``: ``all`` or an index; by default all of one run, the last of many runs. ``title``.
        """
        return self._profile("over_maxwellian", axis, **which)

    def tail(self, power: float = 1.0, axis: str | None = None, **which: Any) -> Figure:
        """Draw T^{d/2} f/ρ on a logarithmic axis; exp(−A c^power) is a line over c^power."""
        return self._profile("tail", axis, power=power, **which)

    def marginal(self, axis: str = "x", **which: Any) -> Figure:
        """Draw the density of one component of the velocity, in thermal units."""
        return self._profile("marginal", axis, **which)

    def convergence(self, quantity: str = "a2", x: str = "N", **look: Any) -> Figure:
        """Draw how far a quantity at the end is from its value at the finest ``x``: largest N, smallest dt.

        A quantity that is an error itself is drawn as it is.
        """
        y = at_end(quantity_over(self._ds, quantity, x), self._ds)
        if x not in y.dims:
            raise ValueError(f"x={x!r}: must be one of {', '.join(map(str, y.dims))}")
        if "error" not in quantity.split("_"):
            finest = y[x].min() if x == "dt" else y[x].max()
            long_name = f"|{quantity} − {quantity} at {x} = {float(finest):g}|"
            y = abs(y - y.sel({x: finest})).where(y[x] != finest).rename(quantity)
            y = y.assign_attrs(
                long_name=long_name, symbol=rf"$|\Delta\,${symbol_of(y)}$|$", units="1"
            )
        return lines_figure(y, x, self._trust, **{"yscale": "log"} | look)

    def front(self) -> Figure:
        """Draw a front: of a benchmark's dataset, or of a table of runs with a truth and their seconds."""
        if "truth" in self._given.attrs:
            return run_front([self._given])
        return benchmark_front([self._given])

    def local_slope(self, quantity: str = "temperature", **look: Any) -> Figure:
        """Draw d ln T/d ln t over time, or that of another positive quantity."""
        return lines_figure(slopes(self._ds, quantity), "time", self._trust, **look)

    @property
    def _trust(self) -> xr.DataArray | None:
        return self._ds.get("trust")

    def _profile(
        self,
        kind: str,
        axis: str | None,
        *,
        snapshot: str | int | None = None,
        title: str | None = None,
        power: float = 1.0,
    ) -> Figure:
        chosen = snapshots(self._ds, snapshot)
        return profile_figure(
            profile(chosen, kind, axis),
            kind,
            self._trust,
            dim=self._ds.sizes["component"],
            power=power,
            title=title,
        )
