"""Theory beside runs: cooling laws and states of their gases."""

import math
from collections.abc import Callable

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.model.kernel import VHS
from granstudy.support.variables import attributes

LONG_NAMES = {
    "haff_constant": "C0 of Haff's law for a Gaussian shape",
    "cooling_state_a2": "a2 of the cooling state, linear theory",
    "heated_state_a2": "a2 of the heated state, linear theory",
    "heated_temperature": "temperature of the heated state, linear theory",
}
"""Long names of what `theories` gives."""


def theories(runs: xr.Dataset, dim: int) -> xr.Dataset:
    """Theory for every run of a dataset, over the dataset's own dimensions.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs with a temperature, and with the coordinates exponent, strength, diffusion, and e where
        restitution is a constant.
    dim : int
        Velocity dimension.

    Returns
    -------
    xarray.Dataset
        The variables of `LONG_NAMES`; NaN where a law does not hold.
    """
    first = runs["temperature"]
    for axis in {"time", "output"} & set(first.dims):
        first = first.isel({axis: 0})
    e = runs.coords.get("e", xr.DataArray(np.nan))
    gases = [e, *(runs[name] for name in ("exponent", "strength", "diffusion"))]
    broadcast = xr.broadcast(*gases, first.reset_coords(drop=True))
    found = {}
    for name, law in LAWS.items():
        values = np.vectorize(_guarded(law, dim), otypes=[float])(*(a.values for a in broadcast))
        found[name] = (broadcast[0].dims, values, attributes(LONG_NAMES[name]))
    return xr.Dataset(found, broadcast[0].coords)


Law = Callable[[float, float, float, float, float, int], float]
"""(e, λ, C_λ, ε, first T, d) ↦ what a theory says."""


def _haff(e: float, exponent: float, strength: float, eps: float, T: float, dim: int) -> float:
    if eps > 0.0 or exponent == 0.0:
        return np.nan
    return theory.haff_constant(VHS(exponent, strength), e, dim, T0=T)


def _cooling_a2(
    e: float, exponent: float, strength: float, eps: float, T: float, dim: int
) -> float:
    return theory.cooling_state_a2(e, dim, exponent) if eps == 0.0 else np.nan


def _heated_a2(e: float, exponent: float, strength: float, eps: float, T: float, dim: int) -> float:
    return theory.heated_state_a2(e, dim, exponent) if eps > 0.0 else np.nan


def _heated_T(e: float, exponent: float, strength: float, eps: float, T: float, dim: int) -> float:
    if eps == 0.0:
        return np.nan
    a2 = theory.heated_state_a2(e, dim, exponent)
    return theory.heated_temperature(VHS(exponent, strength), e, dim, eps, a2)


LAWS: dict[str, Law] = {
    "haff_constant": _haff,
    "cooling_state_a2": _cooling_a2,
    "heated_state_a2": _heated_a2,
    "heated_temperature": _heated_T,
}
"""Theories by the name of their variable."""


def _guarded(law: Law, dim: int) -> Callable[..., float]:
    """The law, NaN for a gas without constant e below 1."""

    def value(e: float, exponent: float, strength: float, eps: float, T: float) -> float:
        if not (math.isfinite(e) and 0.0 <= e < 1.0 and math.isfinite(T)):
            return np.nan
        return float(law(e, exponent, strength, eps, T, dim))

    return value
