"""Scales of axes: logarithmic for decades, linear or symmetric for signed numbers: none is dropped."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from granstudy.trust.flags import Trust

DECADES = 10.0
"""Positive numbers that span so much are drawn in their logarithm."""

LONG_AGO = 100.0
"""Times are drawn in their logarithm where the last is so many times the first after 0."""

SIGNED_DECADES = 300.0
"""Signed numbers are drawn on a symmetric axis where the largest is so many times the median size."""

SCALES = ("linear", "log", "symlog")
"""Scales that one can ask for."""

DOUBLING = ("N", "N_rho", "M_cir", "dt", "M_sph", "particles", "batches")
"""Parameters that are refined by factors."""

FEW_TICKS = 9
"""Values up to which each has its tick."""


def check_scale(field: str, scale: str | None) -> None:
    """Raise ValueError unless a scale is None or one of `SCALES`."""
    if scale is not None and scale not in SCALES:
        raise ValueError(f"{field}={scale!r}: allowed are {', '.join(SCALES)}")


def number_scale(values: Sequence[np.ndarray], trusts: Sequence[np.ndarray] | None = None) -> str:
    """The scale that shows all of these numbers, and is not flattened by those that nobody believes.

    Parameters
    ----------
    values : sequence of ndarray
    trusts : sequence of ndarray, optional
        Labels of the numbers.
    """
    flat = _flat(values)
    finite = flat[np.isfinite(flat)]
    sizes = np.abs(finite[finite != 0.0])
    if sizes.size == 0:
        return "linear"
    if finite.min() > 0.0:
        return "log" if finite.max() > DECADES * finite.min() else "linear"
    believed = _largest_believed(values, trusts)
    outliers = believed is not None and sizes.max() > DECADES * believed
    return "symlog" if outliers or sizes.max() > SIGNED_DECADES * np.median(sizes) else "linear"


def _flat(values: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.ravel(np.asarray(v, dtype=float)) for v in values])


def _largest_believed(
    values: Sequence[np.ndarray], trusts: Sequence[np.ndarray] | None
) -> float | None:
    """Largest size of a number whose run is not untrusted; None where there is none."""
    if trusts is None:
        return None
    flat, labels = _flat(values), np.concatenate([np.ravel(t) for t in trusts])
    sizes = np.abs(flat[np.isfinite(flat) & (labels != Trust.UNTRUSTED)])
    return float(sizes.max()) if sizes.size and sizes.max() > 0.0 else None


def set_scale(
    ax: Axes,
    axis: str,
    scale: str,
    values: Sequence[np.ndarray],
    trusts: Sequence[np.ndarray] | None = None,
) -> None:
    """Set the scale of axis ``x`` or ``y``.

    A symmetric one is linear about 0, up to the smallest sizes, or up to the numbers that are believed.
    """
    setter = ax.set_xscale if axis == "x" else ax.set_yscale
    if scale != "symlog":
        setter(scale)
        return
    setter("symlog", linthresh=linear_up_to(values, trusts))


def linear_up_to(values: Sequence[np.ndarray], trusts: Sequence[np.ndarray] | None = None) -> float:
    """Size up to which a symmetric scale is linear, a power of ten."""
    flat = np.abs(_flat(values))
    sizes = flat[np.isfinite(flat) & (flat > 0.0)]
    if sizes.size == 0:
        return 1.0
    believed = _largest_believed(values, trusts)
    if believed is not None and sizes.max() > DECADES * believed:
        return float(10.0 ** np.ceil(np.log10(believed)))
    smallest = max(float(np.quantile(sizes, 0.05)), 1e-6 * float(sizes.max()))
    return float(10.0 ** np.floor(np.log10(smallest)))


def time_scale(times: Sequence[np.ndarray]) -> str:
    """Logarithmic for times over decades."""
    flat = np.concatenate([np.ravel(t) for t in times])
    after = flat[np.isfinite(flat) & (flat > 0.0)]
    return "log" if after.size > 2 and after.max() > LONG_AGO * after.min() else "linear"


def parameter_ticks(ax: Axes, name: str, values: np.ndarray) -> None:
    """Put the ticks of the abscissa where the runs are; parameters refined by factors lie in equal steps."""
    if values.size == 0:
        return
    if name in DOUBLING and values.min() > 0 and values.max() >= 2 * values.min():
        ax.set_xscale("log", base=2)
    if values.size <= FEW_TICKS:
        ax.xaxis.set_major_locator(FixedLocator(values.tolist()))
        ax.xaxis.set_minor_locator(NullLocator())
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
