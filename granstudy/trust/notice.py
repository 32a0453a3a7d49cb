"""A warning of runs that are not trusted, with the remedy that their label names."""

import warnings
from collections.abc import Hashable

import numpy as np
import xarray as xr

from granstudy.trust.flags import Trust, flag_word

NAMED = 3
"""Runs that a warning names."""


NO_NAMES = ("run_key",)
"""Coordinates that tell a run apart for machines alone."""


class NotTrustedWarning(UserWarning):
    """Temperature and kurtosis of a run may be off by more than a study wants (`granstudy.trust.health`)."""


def warn_of_trust(ds: xr.Dataset, stacklevel: int = 2) -> None:
    """Warn once of all runs of a dataset that are marginal or untrusted.

    Parameters
    ----------
    ds : xarray.Dataset
        A run, or runs over any dimensions.
    stacklevel : int
        As of `warnings.warn`, counted from the caller.
    """
    text = notice(ds)
    if text:
        warnings.warn(text, NotTrustedWarning, stacklevel=stacklevel + 1)


def notice(ds: xr.Dataset) -> str:
    """Which runs are not trusted, and the remedies; "" where all are."""
    if "trust" not in ds:
        return ""
    trust = ds["trust"]
    labels = trust.values
    there = labels[labels >= 0].size
    doubtful = np.argwhere((labels == Trust.MARGINAL) | (labels == Trust.UNTRUSTED))
    if len(doubtful) == 0:
        return ""
    if labels.ndim == 0:
        return (
            f"the run is {flag_word('trust', trust)}: {_one_line(trust.attrs.get('reasons', ''))}"
        )
    counts = [
        f"{count} {label.name.lower()}"
        for label in (Trust.UNTRUSTED, Trust.MARGINAL)
        if (count := int((labels == label).sum()))
    ]
    worst = sorted(map(tuple, doubtful.tolist()), key=lambda place: int(labels[place]))
    named = [_named(ds, dict(zip(trust.dims, place, strict=True))) for place in worst[:NAMED]]
    more = ["..."] if len(worst) > NAMED else []
    told = "\n".join(f"- {line}" for line in named) + "".join(f"\n{line}" for line in more)
    return f"{' and '.join(counts)} of {there} runs (ds.granular.trusted says which):\n{told}"


def _named(ds: xr.Dataset, place: dict[Hashable, int]) -> str:
    """A run by its parameters, its label and its reasons."""
    one = ds[["trust"]].isel(place)
    names = [str(dim) for dim in place if dim in ds.coords] or [
        str(name)
        for name, c in ds.coords.items()
        if c.dims == tuple(place) and name not in NO_NAMES and np.unique(c.values).size > 1
    ]
    where = ", ".join(f"{name}={one[name].values}" for name in names)
    reasons = str(ds["trust_reasons"].isel(place).values) if "trust_reasons" in ds else ""
    return f"{where or 'a run'}: {flag_word('trust', one['trust'])}; {_one_line(reasons)}"


def _one_line(reasons: str) -> str:
    return "; ".join(reasons.splitlines())
