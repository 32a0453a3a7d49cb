"""The accessor `ds.granular` of runs, studies, sweeps and states, over whatever dimensions they have."""

from collections.abc import Callable
from typing import Any

import xarray as xr

from granstudy.accessor.plots import Plots
from granstudy.model.kernel import VHS
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.reading import comparison, cooling, densities, integrals, provenance
from granstudy.reading.kept import Kept, kept
from granstudy.reading.theories import theories
from granstudy.trust.flags import Trust


class Granular:
    """What one reads off a dataset of granstudy; xarray makes it as ``ds.granular``.

    Every answer is an `xarray.DataArray` or `xarray.Dataset` over the dataset's own dimensions (`snapshot`,
    `e`, `N`, `run`, ..), with long name, symbol and units. It is lazy where the densities are.

    Parameters
    ----------
    ds : xarray.Dataset
        A run, a study's or a sweep's runs, or a state.
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds
        self._held: Kept | None = None

    @property
    def plot(self) -> Plots:
        """Figures: ``ds.granular.plot.temperature()``, ``.cooling()``, ``.map("a2", "e", "N")``, .."""
        return Plots(self._ds)

    # What was computed.

    @property
    def scene(self) -> Scene:
        """The scene of the run.

        Raises
        ------
        ValueError
            If the runs have several scenes, or the file holds code of its user (`load_scene` runs it).
        """
        return provenance.scene_of(self._ds)

    def load_scene(self, run_code: bool = False) -> Scene:
        """The scene of the run; with ``run_code``, code of the user that the file holds may run."""
        return provenance.scene_of(self._ds, run_code)

    @property
    def solver(self) -> Solver:
        """The solver of the run; ValueError if the runs have several."""
        return provenance.solver_of(self._ds)

    @property
    def kernel(self) -> VHS | xr.DataArray:
        """The kernel of the run; an array of kernels where the runs have several."""
        return provenance.kernel_of(self._ds)

    @property
    def trusted(self) -> xr.DataArray:
        """Whether each run's label is trusted; True for what has no label."""
        if "trust" not in self._ds:
            return xr.DataArray(True)
        return (self._ds["trust"] == Trust.TRUSTED).rename("trusted")

    @property
    def dim(self) -> int:
        """Velocity dimension.

        Raises
        ------
        ValueError
            If the dataset does not say it.
        """
        if "component" not in self._ds.sizes:
            raise ValueError("component: the dataset has no such axis; it is no run of granstudy")
        return self._ds.sizes["component"]

    # Densities.

    @property
    def _kept(self) -> Kept:
        if self._held is None:
            self._held = kept(self._ds)
        return self._held

    def at(self, *, method: str = "spectral", **velocity: Any) -> xr.DataArray:
        """f at any velocities, on any grid and in any frame.

        Parameters
        ----------
        method : str
            ============  =========================================================================
            ``spectral``  the grid's own trigonometric or Bessel series; error a part of max f
            ``local``     polynomials through 16 neighbours; error a part of f there, for tails
            ============  =========================================================================
        velocity
            ``vx``, ``vy``, ``vz``: numbers, lists, or DataArrays. Lists make a grid; DataArrays over common
            dimensions make points. A component that is left out is the bulk velocity's: one alone cuts f
            along an axis, two cut it by a plane.
        """
        return densities.at(self._kept, velocity, method)

    def marginal(
        self, axis: str = "x", v: Any | None = None, *, method: str = "spectral"
    ) -> xr.DataArray:
        """∫f over the other components, at values of one; default: six thermal speeds either way."""
        return densities.marginal(self._kept, axis, v, method)

    def radial(self, speed: Any | None = None, *, method: str = "spectral") -> xr.DataArray:
        """Average of f over directions about the bulk velocity, at speeds |v − u|."""
        return densities.radial(self._kept, speed, method)

    def scaled(
        self, c: Any | None = None, *, axis: str | None = None, method: str = "local"
    ) -> xr.DataArray:
        """T^{d/2} f/ρ over thermal velocities c = (v − u)/√T.

        Parameters
        ----------
        c : numbers, optional
            Thermal speeds, or components along an ``axis``; default up to 6.
        axis : str, optional
            ``x``, ``y``, ``z``: along an axis through the bulk velocity; default the average over directions.
        method : str
            As of `at`.
        """
        return densities.scaled(self._kept, c, axis, method)

    def over_maxwellian(
        self, c: Any | None = None, *, axis: str | None = None, method: str = "local"
    ) -> xr.DataArray:
        """f over the Maxwellian of the same ρ, u and T, over c = (v − u)/√T; arguments as of `scaled`."""
        return densities.over_maxwellian(self.scaled(c, axis=axis, method=method), self.dim)

    def moments(self) -> xr.Dataset:
        """All moments of every kept density, a3 among them."""
        return integrals.density_moments(self._kept)

    def cumulants(self) -> xr.Dataset:
        """The Sonine coefficients a2 and a3 of every kept density."""
        return self.moments()[["a2", "a3"]]

    def average(self, function: Callable[..., Any]) -> xr.DataArray:
        """⟨φ⟩ over the velocity for any φ(vx, vy, ..); on a radial grid φ(speed)."""
        return integrals.average(self._kept, function)

    # Cooling, and theory.

    def haff(
        self,
        start: float = 0.0,
        *,
        heating: str = "refused",
        free: bool | None = None,
        relative: bool = False,
    ) -> xr.Dataset:
        """Haff's law T = T0 (1 + C0 (t − start))^{−2/λ} fitted to every run, λ that of its kernel.

        Parameters
        ----------
        start : float
            Time from which on outputs count, for shapes that still change before it.
        heating : str
            ``refused``: heated runs have NaN; ``modelled``: the law that is fitted has the heating in it.
        free : bool, optional
            Whether T0 is fitted too; default only after a ``start``.
        relative : bool
            Whether errors relative to T weigh alike, for decades of cooling.

        Returns
        -------
        xarray.Dataset
            `T0`, `C0`, `T0_standard_error`, `C0_standard_error`, `residual`, `power`; and `reason`, why a run
            has NaN.
        """
        return cooling.haff(self._ds, start, heating, free, relative)

    def slope(self, quantity: str = "temperature") -> xr.DataArray:
        """d ln T/d ln t between neighbouring outputs, or that of another positive quantity."""
        return cooling.slopes(self._ds, quantity)

    def theory(self) -> xr.Dataset:
        """What theory says of each gas: `haff_constant`, `cooling_state_a2`, `heated_state_a2`, .."""
        return theories(self._ds, self.dim)

    def distance(self, quantity: str = "a2") -> xr.DataArray:
        """How far `temperature`, `a2` or `slope` is from what theory says."""
        return comparison.distance(self._ds, quantity, self.dim)
