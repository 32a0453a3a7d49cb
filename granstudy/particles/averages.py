"""Averages over time, for stages in which a gas no longer changes but for its scale."""

import xarray as xr

from granstudy.datasets.run_dataset import standard_error
from granstudy.support.errors import unknown_name


def time_average(ds: xr.Dataset, name: str, start: float) -> tuple[float, float]:
    """Mean of a moment over the recorded times from ``start`` on, and its standard error.

    Each batch is averaged first and the error taken over batches, as one batch's values at several times
    are not independent.

    Raises
    ------
    ValueError
        If the dataset holds no values of ``name`` by batch, or no time from ``start`` on.
    """
    by_batch = {str(n).removesuffix("_by_batch") for n in ds if str(n).endswith("_by_batch")}
    if name not in by_batch:
        raise unknown_name("moment by batch", name, sorted(by_batch))
    late = ds[f"{name}_by_batch"].sel(time=slice(start, None))
    if late.sizes["time"] == 0:
        raise ValueError(f"start={start!r}: the dataset ends at t = {float(ds['time'][-1]):g}")
    means = late.mean("time").values
    return float(means.mean()), float(standard_error(means))
