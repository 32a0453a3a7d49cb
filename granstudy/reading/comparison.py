"""Distances of runs from theory: exact laws where they are known, else Haff's law and linear theory."""

from collections.abc import Callable

import numpy as np
import xarray as xr

from granstudy.reading.cooling import slopes, time_axis
from granstudy.reading.theories import theories
from granstudy.support.errors import unknown_name
from granstudy.theory import haff_temperature


def distance(runs: xr.Dataset, quantity: str, dim: int) -> xr.DataArray:
    """How far a quantity of every run is from what theory says of its gas.

    Parameters
    ----------
    runs : xarray.Dataset
    quantity : str
        =============  ========================================================================
        `temperature`  T/T_theory − 1: the exact law of Maxwell molecules; Haff's law of a
                       Gaussian shape; the steady temperature of a heated gas
        `a2`           a2 less that of the cooling or the heated state, by linear theory
        `slope`        d ln T/d ln t + 2/λ
        =============  ========================================================================
    dim : int
        Velocity dimension.

    Returns
    -------
    xarray.DataArray
        NaN for gases of which theory says nothing.

    Raises
    ------
    ValueError
        For another quantity, or runs without it.
    """
    if quantity not in DISTANCES:
        raise unknown_name("quantity", quantity, list(DISTANCES))
    return DISTANCES[quantity](runs, dim).rename(f"{quantity}_distance")


def _temperature(runs: xr.Dataset, dim: int) -> xr.DataArray:
    said = theories(runs, dim)
    T = runs["temperature"]
    law = xr.full_like(T, np.nan)
    if "temperature_exact" in runs:
        law = runs["temperature_exact"]
    if "time" in runs.coords and time_axis(runs) in T.dims:
        T0 = T.isel({time_axis(runs): 0}, drop=True)
        exponent = runs["exponent"].where(runs["exponent"] > 0.0)
        haff = haff_temperature(runs["time"], T0, said["haff_constant"], exponent)
        law = law.fillna(haff.transpose(*T.dims))
    law = law.fillna(said["heated_temperature"])
    return (T / law - 1.0).assign_attrs(
        long_name="distance of T from theory", symbol=r"$T/T_\mathrm{theory} - 1$", units="1"
    )


def _a2(runs: xr.Dataset, dim: int) -> xr.DataArray:
    said = theories(runs, dim)
    law = said["cooling_state_a2"].fillna(said["heated_state_a2"])
    return (runs["a2"] - law).assign_attrs(
        long_name="distance of a2 from linear theory",
        symbol=r"$a_2 - a_{2,\mathrm{theory}}$",
        units="1",
    )


def _slope(runs: xr.Dataset, dim: int) -> xr.DataArray:
    exponent = runs["exponent"].where(runs["exponent"] > 0.0)
    return (slopes(runs) + 2.0 / exponent).assign_attrs(
        long_name="distance of the local slope from Haff's law",
        symbol=r"$\mathrm{d}\,\ln T/\mathrm{d}\,\ln t + 2/\lambda$",
        units="1",
    )


DISTANCES: dict[str, Callable[[xr.Dataset, int], xr.DataArray]] = {
    "temperature": _temperature,
    "a2": _a2,
    "slope": _slope,
}
"""Quantities that theory says something of."""
