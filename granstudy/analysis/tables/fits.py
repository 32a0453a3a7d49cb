"""Laws fitted to runs: an order of convergence, Haff's constant of cooling."""

from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import curve_fit

from granstudy import theory
from granstudy.analysis.labels import families
from granstudy.analysis.tables.runs import Rows
from granstudy.datasets.netcdf import run_seconds
from granstudy.datasets.open_runs import open_runs
from granstudy.study.schema.experiment import FitModel
from granstudy.theory import haff_temperature


def fit_order(x: np.ndarray, error: np.ndarray) -> tuple[float, float]:
    """Fit order p and prefactor c of error = c xᵖ, by a straight line through the logarithms.

    Parameters
    ----------
    x, error : array_like
        Refined parameter and error, both positive, at least two different x.

    Returns
    -------
    order, prefactor : float
        Least squares of log(error) = p log(x) + log(c): every point counts by its ratio to the
        line, so the small errors weigh as much as the large ones.

    Raises
    ------
    ValueError
        If a value is not positive and finite, or there are fewer than two different x.
    """
    x, error = np.asarray(x, dtype=float), np.asarray(error, dtype=float)
    for name, values in (("x", x), ("error", error)):
        if not np.all(np.isfinite(values) & (values > 0.0)):
            raise ValueError(f"{name}={values}: an order needs positive, finite values")
    if np.unique(x).size < 2:
        raise ValueError(f"x={x}: an order needs at least two different values")
    order, intercept = np.polyfit(np.log(x), np.log(error), 1)
    return float(order), float(np.exp(intercept))


def growth_exponent(x: np.ndarray, cost: np.ndarray, least: float = 0.0) -> float:
    """Fit the exponent of cost ~ xᵖ to the costs above ``least``; NaN where fewer than two are."""
    x, cost = np.asarray(x, dtype=float), np.asarray(cost, dtype=float)
    kept = np.isfinite(cost) & (cost > least)
    return fit_order(x[kept], cost[kept])[0] if np.unique(x[kept]).size > 1 else float("nan")


def local_slope(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Slopes d ln y/d ln x between neighbouring points, and where: the geometric means of their x."""
    x = np.asarray(x, dtype=float)
    return np.sqrt(x[1:] * x[:-1]), np.diff(np.log(y)) / np.diff(np.log(x))


def fit_haff(
    time: np.ndarray, temperature: np.ndarray, T0: float | None = None
) -> tuple[float, float]:
    """Fit C0 of Haff's law T = T0 (1 + C0 t)^{−2} by least squares, and its standard error.

    As the paper fits it (its Figs. 3 and 4, eq. 52): T0 stays at the initial temperature, all
    times weigh alike. Haff's law holds for a fixed shape of the density; while the shape still
    changes, C0 depends on the fitted interval, which the standard error does not tell.

    Parameters
    ----------
    time, temperature : array_like
        A run's times and temperatures, at least three.
    T0 : float, optional
        The temperature at t = 0; by default the first one.

    Raises
    ------
    ValueError
        If a value is not finite or there are fewer than three.

    References
    ----------
    P. Haff, J. Fluid Mech. 134, 401 (1983).
    """
    time, temperature = np.asarray(time, dtype=float), np.asarray(temperature, dtype=float)
    if time.size < 3:
        raise ValueError(f"time has {time.size} values: a cooling law needs at least three")
    if not (np.all(np.isfinite(time)) and np.all(np.isfinite(temperature))):
        raise ValueError("temperature: a cooling law needs finite values at every time")
    initial = float(temperature[0]) if T0 is None else T0
    # From T(t_end) alone; close enough for Gauss–Newton to need a handful of steps.
    start = (np.sqrt(initial / temperature[-1]) - 1.0) / time[-1]
    C0, covariance = curve_fit(
        lambda t, C0: haff_temperature(t, initial, C0), time, temperature, p0=[start]
    )
    return float(C0[0]), float(np.sqrt(covariance[0, 0]))


LEAST_MEMORY_MB = 8.0
"""Peak memories below this are the allocator's, and not fitted."""


def _with_fit(table: xr.Dataset, fit: FitModel, rows: Rows) -> xr.Dataset:
    if fit.law == "order":
        return _with_order(table, table.attrs["quantity"], fit.x)
    if fit.law == "growth":
        return _with_growth(table)
    return {"slope": _with_slope, "haff": _with_haff}[fit.law](table, rows)


def _with_order(table: xr.Dataset, quantity: str, x: str | None) -> xr.Dataset:
    """Add `order`, the fitted slope of each group of runs that differ in ``x`` alone."""
    swept = table.attrs["swept"].split()
    if x not in swept:
        raise ValueError(f"fit.x={x!r}: an order is fitted against a swept parameter: {swept}")
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i in range(table.sizes["run"]):
        key = tuple(table[name].values[i] for name in swept if name != x)
        groups.setdefault(key, []).append(i)
    order = np.full(table.sizes["run"], np.nan)
    for members in groups.values():
        error = table[quantity].values[members]
        order[members], _ = fit_order(table[x].values[members], error)
    long_name = f"p of {quantity} ~ {x}^p, fitted to the runs that differ in {x} alone"
    table["order"] = ("run", order, {"long_name": long_name, "units": "1"})
    table.attrs["refined"] = x
    return table


def _with_growth(table: xr.Dataset) -> xr.Dataset:
    """Add the exponents of time and memory in N, of each method, and those of N^{d+1} log N."""
    exponents = np.full((3, table.sizes["run"]), np.nan)
    groups: dict[tuple[Any, ...], list[int]] = {}
    for i, key in enumerate(zip(families(table), table["threads"].values, strict=True)):
        groups.setdefault(key, []).append(i)
    for members in groups.values():
        N = table["N"].values[members].astype(float)
        exponents[0, members] = growth_exponent(N, table["seconds"].values[members])
        if "peak_memory_mb" in table:
            memory = table["peak_memory_mb"].values[members]
            exponents[1, members] = growth_exponent(N, memory, LEAST_MEMORY_MB)
        exponents[2, members] = growth_exponent(N, N ** (table.attrs["dim"] + 1) * np.log(N))
    long_names = {
        "time_exponent": "p of seconds ~ N^p, fitted to the runs of a method",
        "memory_exponent": f"p of peak memory ~ N^p, fitted where it is above {LEAST_MEMORY_MB} MB",
        "law_exponent": "p of N^{d+1} log N ~ N^p, fitted to the same N",
    }
    for values, (name, long_name) in zip(exponents, long_names.items(), strict=True):
        table[name] = ("run", values, {"long_name": long_name, "units": "1"})
    return table


def _with_haff(table: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Add C0 fitted to each run, its standard error, and C0 of theory for a Gaussian shape."""
    fitted = []
    for run, file in rows:
        with open_runs([file]) as ds:
            time, T = ds["time"].values, ds["temperature"].values[0]
        e, kernel = run.scene.restitution, run.scene.kernel
        C0 = (
            np.nan
            if callable(e)
            else theory.haff_constant(kernel, float(e), run.scene.dim, T0=float(T[0]))
        )
        fitted.append((*fit_haff(time, T), C0))
    long_names = {
        "C0": "Haff constant, least squares of T0 (1 + C0 t)^-2",
        "C0_error": "standard error of the fitted C0",
        "C0_theory": "Haff constant of a Gaussian shape at the initial temperature",
    }
    for column, (name, long_name) in enumerate(long_names.items()):
        values = np.array([numbers[column] for numbers in fitted])
        table[name] = ("run", values, {"long_name": long_name, "units": "1"})
    return table


def _with_slope(table: xr.Dataset, rows: Rows) -> xr.Dataset:
    """Add d ln T/d ln t of the last decade, its distance from Haff's law, and how long the run took."""
    found = []
    for run, file in rows:
        with open_runs([file]) as ds:
            time, T = ds["time"].values[1:], ds["temperature"].values[0, 1:]
        at, slope = local_slope(time, T)
        late = slope[at > time[-1] / 10.0]
        law = -2.0 / run.scene.kernel.exponent
        found.append((late.mean(), np.abs(late - law).max(), run_seconds(file)))
    long_names = {
        "slope": ("d ln T/d ln t, mean over the last decade of t", ".6f"),
        "slope_error": ("largest |d ln T/d ln t + 2/λ| in the last decade of t", ".1e"),
        "seconds": ("wall time of the run, set-up included", ".3g"),
    }
    for column, (name, (long_name, digits)) in enumerate(long_names.items()):
        values = np.array([numbers[column] for numbers in found], dtype=float)
        table[name] = ("run", values, {"long_name": long_name, "units": "1", "format": digits})
    return table
