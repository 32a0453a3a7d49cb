"""Laws of cooling read off T(t): Haff's law with the kernel's own exponent, and local slopes."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp
from scipy.optimize import OptimizeWarning, curve_fit

from granstudy.theory import haff_temperature
from granstudy.trust.flags import Status

FEWEST = 3
"""Outputs that a fit needs."""

HEATING = ("refused", "modelled")
"""What becomes of heated runs."""


class Fit(NamedTuple):
    """A law of cooling fitted to T(t): T = T0 (1 + C0 (t − start))^{−2/λ} without heating."""

    T0: float
    C0: float
    T0_error: float
    C0_error: float
    residual: float
    """Root mean square of T/T_law − 1."""


def fit_haff(
    time: np.ndarray,
    temperature: np.ndarray,
    T0: float | None = None,
    exponent: float = 1.0,
    *,
    free: bool = False,
    relative: bool = False,
    diffusion: float = 0.0,
) -> Fit:
    """Fit Haff's law T = T0 (1 + C0 t)^{−2/λ} by least squares, with standard errors.

    The paper fits the same way (its Figs. 3 and 4, eq. 52): T0 stays at the initial temperature, all
    times weigh alike. Haff's law holds for a fixed shape of the density. While the shape still
    changes, C0 depends on the fitted interval; the standard error does not tell that.

    Parameters
    ----------
    time, temperature : array_like
        A run's times and temperatures, at least three.
    T0 : float, optional
        The temperature at t = 0; by default the first one.
    exponent : float
        λ of the kernel, above 0; by default that of hard spheres.
    free : bool
        Whether T0 is fitted too.
    relative : bool
        Whether errors relative to T weigh alike, which decades of cooling need.
    diffusion : float
        ε of a heated gas. The law is then the solution of T' = 2ε − (2/λ) C0 T0^{−λ/2} T^{1+λ/2}.

    Raises
    ------
    ValueError
        If a value is not finite or there are fewer than three.

    References
    ----------
    P. Haff, J. Fluid Mech. 134, 401 (1983).
    """
    time, temperature = np.asarray(time, dtype=float), np.asarray(temperature, dtype=float)
    if time.size < FEWEST:
        raise ValueError(f"time has {time.size} values: a cooling law needs at least three")
    if not (np.all(np.isfinite(time)) and np.all(np.isfinite(temperature))):
        raise ValueError("temperature: a cooling law needs finite values at every time")
    initial = float(temperature[0]) if T0 is None else T0
    law = _law(exponent, diffusion)
    start = _start(time, temperature, initial, exponent, diffusion)
    sigma = temperature if relative else None
    if free:
        found, covariance = curve_fit(law, time, temperature, p0=[initial, start], sigma=sigma)
        errors = np.sqrt(np.diag(covariance))
        (T0_, C0), (T0_error, C0_error) = found, errors
    else:
        found, covariance = curve_fit(
            lambda t, C0: law(t, initial, C0), time, temperature, p0=[start], sigma=sigma
        )
        T0_, C0, T0_error, C0_error = initial, found[0], 0.0, np.sqrt(covariance[0, 0])
    ratio = temperature / law(time, T0_, C0) - 1.0
    numbers = (T0_, C0, T0_error, C0_error, np.sqrt(np.mean(ratio**2)))
    return Fit(*map(float, numbers))


def _law(exponent: float, diffusion: float) -> Callable[..., np.ndarray]:
    """(t, T0, C0) ↦ T."""
    if diffusion == 0.0:
        return lambda t, T0, C0: haff_temperature(t, T0, C0, exponent)
    return lambda t, T0, C0: heated_cooling(t, T0, C0, exponent, diffusion)


def heated_cooling(
    t: np.ndarray, T0: float, C0: float, exponent: float, diffusion: float
) -> np.ndarray:
    """T of a gas of fixed shape that is heated: T' = 2ε − (2/λ) C0 T0^{−λ/2} T^{1+λ/2}, T(0) = T0.

    Without heating this is Haff's law. The equation is integrated to 1e-10.
    """
    K = 2.0 / exponent * C0 * T0 ** (-exponent / 2)
    power = 1.0 + exponent / 2
    solved = solve_ivp(
        lambda _, T: 2.0 * diffusion - K * np.abs(T) ** power,
        (0.0, float(t[-1])),
        [T0],
        method="LSODA",
        t_eval=t,
        rtol=1e-10,
        atol=1e-12 * T0,
    )
    return np.asarray(solved.y[0])


def _start(
    t: np.ndarray, temperature: np.ndarray, T0: float, exponent: float, diffusion: float
) -> float:
    """C0 that Gauss–Newton starts from: from T at the end alone, heated from the first slope."""
    if diffusion == 0.0:
        return float(((T0 / temperature[-1]) ** (exponent / 2) - 1.0) / t[-1])
    slope = (temperature[1] - temperature[0]) / (t[1] - t[0])
    return float(exponent / 2 * (2.0 * diffusion - slope) / T0)


def haff(
    runs: xr.Dataset,
    start: float = 0.0,
    heating: str = "refused",
    free: bool | None = None,
    relative: bool = False,
) -> xr.Dataset:
    """Haff's law fitted to every run of a dataset, over the dataset's own dimensions.

    Parameters
    ----------
    runs : xarray.Dataset
        Runs with a temperature over time, and with the coordinates `exponent` and `diffusion`.
    start : float
        Time from which on the law is fitted: T = T0 (1 + C0 (t − t_start))^{−2/λ}, t_start the first output
        from then on.
    heating : str
        ``refused``: heated runs have NaN. ``modelled``: the law has the heating in it (`heated_cooling`).
    free : bool, optional
        Whether T0 is fitted too. Default: only after a ``start``.
    relative : bool
        Whether errors relative to T weigh alike.

    Returns
    -------
    xarray.Dataset
        `T0`, `C0`, their standard errors, `power` −2/λ, `residual`, and `reason`: why there is NaN.

    Raises
    ------
    ValueError
        If the dataset has no temperature over time, or for an unknown ``heating``.
    """
    if heating not in HEATING:
        raise ValueError(f"heating={heating!r}: allowed are {', '.join(HEATING)}")
    axis = time_axis(runs)
    e = runs.coords["e"] if "e" in runs.coords else xr.DataArray(np.nan)
    status = runs["status"] if "status" in runs else xr.DataArray(int(Status.OK))
    free = start > 0.0 if free is None else free

    def one(
        t: np.ndarray, T: np.ndarray, exponent: float, diffusion: float, e: float, status: float
    ) -> tuple[Any, ...]:
        return _fitted(t, T, exponent, diffusion, e, status, start, heating, free, relative)

    arguments = [runs["time"], runs["temperature"], runs["exponent"], runs["diffusion"], e, status]
    plain = [a.reset_coords(drop=True) for a in arguments]
    *numbers, reason = xr.apply_ufunc(
        one,
        *plain,
        input_core_dims=[[axis], [axis], [], [], [], []],
        output_core_dims=[[]] * 7,
        vectorize=True,
        output_dtypes=[float] * 6 + [object],
    )
    found = {
        name: value.assign_attrs(long_name=text, symbol=symbol, units="1")
        for (name, (text, symbol)), value in zip(HAFF.items(), numbers, strict=True)
    }
    found["reason"] = reason.astype(str).assign_attrs(long_name="why no law was fitted")
    scalars = {n: c for n, c in runs.coords.items() if axis not in c.dims and n not in found}
    return xr.Dataset(found).assign_coords(
        {n: c for n, c in scalars.items() if set(c.dims) <= set(reason.dims)}
    )


HAFF = {
    "T0": ("temperature of Haff's law at its start", "$T_0$"),
    "C0": ("Haff constant of T0 (1 + C0 (t − t_start))^(−2/λ)", "$C_0$"),
    "T0_standard_error": ("standard error of T0", r"$\Delta T_0$"),
    "C0_standard_error": ("standard error of C0", r"$\Delta C_0$"),
    "residual": ("root mean square of T/T_law − 1", r"rms $T/T_\mathrm{law} - 1$"),
    "power": ("power −2/λ of Haff's law", r"$-2/\lambda$"),
}
"""Long names and symbols of what `haff` gives."""


def _fitted(
    t: np.ndarray,
    T: np.ndarray,
    exponent: float,
    diffusion: float,
    e: float,
    status: float,
    start: float,
    heating: str,
    free: bool,
    relative: bool,
) -> tuple[Any, ...]:
    """The numbers of `HAFF`, and why they are NaN; "" where they are not."""
    there = np.isfinite(t) & np.isfinite(T) & (t >= start)
    t, T = t[there], T[there]
    reason = _reason(t, exponent, diffusion, e, status, start, heating)
    nan = (np.nan,) * 5
    power = -2.0 / exponent if exponent > 0.0 else np.nan
    if not reason:
        modelled = diffusion if heating == "modelled" else 0.0
        try:
            fit = fit_haff(
                t - t[0], T, None, exponent, free=free, relative=relative, diffusion=modelled
            )
        except (RuntimeError, ValueError, OptimizeWarning) as error:
            return (*nan, power, f"the fit did not converge: {error}")
        return (fit.T0, fit.C0, fit.T0_error, fit.C0_error, fit.residual, power, "")
    return (*nan, power, reason)


def _reason(
    t: np.ndarray,
    exponent: float,
    diffusion: float,
    e: float,
    status: float,
    start: float,
    heating: str,
) -> str:
    """Why Haff's law cannot be fitted; "" where it can."""
    if status != Status.OK:
        return "the run ended early" if status > 0 else "there is no run"
    if exponent == 0.0:
        return "exponent 0: Maxwell molecules cool exponentially; Haff's law needs λ > 0"
    if e == 1.0 and diffusion == 0.0:
        return "e = 1: elastic collisions take no energy"
    if diffusion > 0.0 and heating == "refused":
        return f"heated by diffusion {diffusion:g}; heating='modelled' fits the law with it"
    if t.size < FEWEST:
        return f"{t.size} outputs from t = {start:g} on; a fit needs {FEWEST}"
    return ""


def time_axis(runs: xr.Dataset) -> str:
    """The dimension of a dataset along which time goes.

    Raises
    ------
    ValueError
        If its runs do not go through time, or one time was selected.
    """
    found = [
        str(dim) for dim in runs.get("time", xr.DataArray(0)).dims if dim in ("time", "output")
    ]
    if "temperature" not in runs or not found:
        raise ValueError(
            "temperature: the dataset has none over time; this is of runs through time"
        )
    return found[0]


def local_slope(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Geometric means of neighbouring x, and the slopes d ln y/d ln x between them."""
    x = np.asarray(x, dtype=float)
    return np.sqrt(x[1:] * x[:-1]), np.diff(np.log(y)) / np.diff(np.log(x))


def slopes(runs: xr.Dataset, name: str = "temperature") -> xr.DataArray:
    """d ln y/d ln t between neighbouring outputs after t = 0, over the dataset's own dimensions.

    `time` are the geometric means of the outputs. NaN where y is not positive.
    """
    axis = time_axis(runs)
    if name not in runs or axis not in runs[name].dims:
        raise ValueError(f"quantity={name!r}: the runs have none over time")

    def one(t: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        positive = (t > 0.0) & (y > 0.0)
        at, slope = local_slope(np.where(t > 0.0, t, np.nan), np.where(positive, y, np.nan))
        return at, slope

    time, y = runs["time"], runs[name]
    at, slope = xr.apply_ufunc(
        one,
        time.reset_coords(drop=True),
        y.reset_coords(drop=True),
        input_core_dims=[[axis], [axis]],
        output_core_dims=[["between"], ["between"]],
        exclude_dims={axis},
        vectorize=True,
        output_dtypes=[float, float],
        join="exact",
    )
    if time.ndim == 1:
        at = at.isel({dim: 0 for dim in at.dims if dim != "between"}, drop=True)
    at = at.assign_attrs(time.attrs).rename(between=axis)
    slope = slope.rename(between=axis).assign_coords(
        {n: c for n, c in runs.coords.items() if axis not in c.dims and set(c.dims) <= set(y.dims)}
    )
    slope = slope.assign_coords(time=(at.dims, at.values, at.attrs))
    symbol = "T" if name == "temperature" else name
    text = f"d ln {symbol}/d ln t"
    return slope.rename(f"{name}_slope").assign_attrs(
        long_name=text, symbol=rf"$\mathrm{{d}}\,\ln {symbol}/\mathrm{{d}}\,\ln t$", units="1"
    )
