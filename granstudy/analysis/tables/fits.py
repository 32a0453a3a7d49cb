"""Laws fitted to runs: an order of convergence, the growth of a cost, Haff's law of cooling."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.analysis.columns import computed
from granstudy.analysis.groups import check_numbers, check_swept, groups, keys, values_of
from granstudy.analysis.labels import families
from granstudy.analysis.source import TableSource
from granstudy.datasets.netcdf import read_dataset, run_seconds
from granstudy.reading.cooling import fit_haff, local_slope
from granstudy.support.errors import unknown_name
from granstudy.trust.flags import Status


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


LEAST_MEMORY_MB = 8.0
"""Smaller peak memories are the allocator's, and are not fitted."""


def with_order(table: xr.Dataset, source: TableSource) -> xr.Dataset:
    """Add `order`, the fitted slope of each group of runs that differ in ``fit.x`` alone.

    Runs without an error, as they ended early, do not count.
    """
    x, swept = _refined(table, source), table.attrs["swept"].split()
    order = np.full(table.sizes["run"], np.nan)
    for members in groups(keys(table, [name for name in swept if name != x])).values():
        error = table[source.quantity].values[members]
        order[members] = growth_exponent(table[x].values[members], error)
    table["order"] = computed("order", order, of=source.quantity, x=x)
    table.attrs["refined"] = x
    return table


def _refined(table: xr.Dataset, source: TableSource) -> str:
    """The swept parameter that an order is fitted against."""
    assert source.experiment.fit is not None
    x = source.experiment.fit.x
    if x is None:
        raise ValueError("fit.x: must be given; an order is fitted against a swept parameter")
    return check_swept("fit.x", x, table)


def check_order(table: xr.Dataset, source: TableSource) -> None:
    """Raise ValueError unless an order can be fitted: of an error, over two values of ``fit.x`` or more."""
    x = _refined(table, source)
    check_numbers("fit.x", x, table)
    if "error" not in source.quantity.split("_"):
        raise ValueError(
            f"fit.law='order': is of an error that falls with {x}, not of table.quantity={source.quantity!r}"
        )
    others = [name for name in table.attrs["swept"].split() if name != x]
    for key, members in groups(keys(table, others)).items():
        if np.unique(table[x].values[members]).size < 2:
            where = ", ".join(f"{name}={value}" for name, value in zip(others, key, strict=True))
            raise ValueError(
                f"fit.x={x!r}: has one value{f' at {where}' if where else ''}; an order needs two"
            )


def check_growth(table: xr.Dataset, source: TableSource) -> None:
    """Raise ValueError unless exponents can be fitted: of a benchmark, through two or more N of a method."""
    if source.experiment.run != "benchmark":
        raise ValueError(
            f"fit.law='growth': is of seconds of benchmark runs, not of {source.experiment.run} runs"
        )
    of_method: dict[str, set[float]] = {}
    for family, N in zip(families(table), values_of(table, "N").tolist(), strict=True):
        of_method.setdefault(family, set()).add(N)
    if all(len(sizes) < 2 for sizes in of_method.values()):
        raise ValueError("fit.law='growth': needs two values of N of a method; sweep N")


def check_haff(table: xr.Dataset, source: TableSource) -> None:
    """Raise ValueError unless Haff's law holds for each run, and three outputs or more show it."""
    _check_cooling("haff", source)


def check_slope(table: xr.Dataset, source: TableSource) -> None:
    """Raise ValueError unless Haff's law holds for each run, over a decade of outputs."""
    _check_cooling("slope", source)
    for run, _ in source.rows:
        assert run.time is not None
        first, last = run.time.recorded[1], run.time.t_final
        if first > last / 10.0:
            raise ValueError(
                f"fit.law='slope': is of the last decade of t; the first output of run {run.path} is at "
                f"t = {first:g}, the last at {last:g}"
            )


def _check_cooling(law: str, source: TableSource) -> None:
    if source.experiment.run != "evolution":
        raise ValueError(
            f"fit.law={law!r}: is of T(t) of evolution runs, not of {source.experiment.run} runs"
        )
    for run, _ in source.rows:
        scene = run.scene
        if scene.kernel.exponent == 0.0:
            raise ValueError(
                f"fit.law={law!r}: Haff's law holds for exponent > 0; run {run.path} has exponent 0, which "
                "cools exponentially"
            )
        if scene.diffusion != 0.0:
            raise ValueError(
                f"fit.law={law!r}: Haff's law holds without heating; run {run.path} has diffusion "
                f"{scene.diffusion!r}: set diffusion: 0.0"
            )
        assert run.time is not None
        if (run.time.dt is not None and run.time.steps < 2) or run.time.recorded.size < 3:
            raise ValueError(
                f"fit.law={law!r}: needs three outputs or more; run {run.path} has {run.time.recorded.size}"
            )


def with_growth(table: xr.Dataset, source: TableSource) -> xr.Dataset:
    """Add the exponents of time and memory in N, of each method, and those of N^{d+1} log N."""
    seconds, memory, law = np.full((3, table.sizes["run"]), np.nan)
    members_of = groups(list(zip(families(table), table["threads"].values.tolist(), strict=True)))
    for members in members_of.values():
        N = table["N"].values[members].astype(float)
        seconds[members] = growth_exponent(N, table["seconds"].values[members])
        if "peak_memory_mb" in table:
            peaks = table["peak_memory_mb"].values[members]
            memory[members] = growth_exponent(N, peaks, LEAST_MEMORY_MB)
        law[members] = growth_exponent(N, N ** (table.attrs["dim"] + 1) * np.log(N))
    found = {"time_exponent": seconds, "memory_exponent": memory, "law_exponent": law}
    return _with_columns(table, found)


def with_haff(table: xr.Dataset, source: TableSource) -> xr.Dataset:
    """Add C0 fitted to each run, its standard error, and C0 of theory for a Gaussian shape."""
    fitted = []
    for run, file in source.rows:
        ds = read_dataset(file)
        time, T = ds["time"].values, ds["temperature"].values
        e, kernel = run.scene.restitution, run.scene.kernel
        if ds["status"] != Status.OK or time.size < 3:
            fitted.append((np.nan, np.nan, np.nan))
            continue
        C0 = (
            np.nan
            if callable(e)
            else theory.haff_constant(kernel, float(e), run.scene.dim, T0=float(T[0]))
        )
        fit = fit_haff(time, T, exponent=kernel.exponent)
        fitted.append((fit.C0, fit.C0_error, C0))
    return _with_columns(table, _columns(("C0", "C0_error", "C0_theory"), fitted))


def with_slope(table: xr.Dataset, source: TableSource) -> xr.Dataset:
    """Add d ln T/d ln t of the last decade, its distance from Haff's law, and the run's seconds."""
    found = []
    for run, file in source.rows:
        ds = read_dataset(file)
        if ds["status"] != Status.OK:
            found.append((np.nan, np.nan, run_seconds(file)))
            continue
        time, T = ds["time"].values[1:], ds["temperature"].values[1:]
        at, slope = local_slope(time, T)
        late = slope[at > time[-1] / 10.0]
        distance = np.abs(late + 2.0 / run.scene.kernel.exponent).max()
        found.append((late.mean(), distance, run_seconds(file)))
    return _with_columns(table, _columns(("slope", "slope_error", "seconds"), found))


@dataclass(frozen=True)
class Fit:
    """A law that is fitted to the runs of a table.

    Attributes
    ----------
    add : callable
        (table, source of the table) ↦ the table with the fit's columns.
    check : callable
        (table, source of the table) ↦ None; ValueError where the law cannot be fitted. It is called before
        any run, too, with a table whose numbers are all 1.
    beside : tuple of str
        Variables of the runs that an evolution's table shows with the fit.
    """

    add: Callable[[xr.Dataset, TableSource], xr.Dataset]
    check: Callable[[xr.Dataset, TableSource], None]
    beside: tuple[str, ...] = ()


FITS: dict[str, Fit] = {
    "order": Fit(with_order, check_order),
    "haff": Fit(with_haff, check_haff),
    "growth": Fit(with_growth, check_growth),
    "slope": Fit(with_slope, check_slope, beside=("a2",)),
}
"""Laws that a study file can ask for, as ``fit: {law: ...}``."""


def check_fit(table: xr.Dataset, source: TableSource) -> None:
    """Raise ValueError unless the fit that an experiment asks for can be made of its table."""
    fit = source.experiment.fit
    if fit is None:
        return
    if fit.law not in FITS:
        raise ValueError(f"fit.law: {unknown_name('law', fit.law, list(FITS))}")
    allowed = {"order": (fit.x,), "growth": (None, "N")}.get(fit.law, (None,))
    if fit.x not in allowed:
        raise ValueError(
            f"fit.x={fit.x!r}: only law 'order' takes it, not {fit.law!r}; leave it out"
        )
    FITS[fit.law].check(table, source)


def _columns(names: Sequence[str], rows: Sequence[tuple[float, ...]]) -> dict[str, np.ndarray]:
    """Columns out of numbers that were found row by row."""
    return dict(zip(names, np.array(rows, dtype=float).T, strict=True))


def _with_columns(table: xr.Dataset, columns: dict[str, np.ndarray]) -> xr.Dataset:
    """Add columns with the long names of `granstudy.analysis.columns.COLUMNS`."""
    for name, values in columns.items():
        table[name] = computed(name, values, least=LEAST_MEMORY_MB)
    return table
