"""Laws fitted to runs: an order of convergence, Haff's constant of cooling."""

import numpy as np
from scipy.optimize import curve_fit

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
