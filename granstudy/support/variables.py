"""Variables of a dataset, as xarray takes them."""

from collections.abc import Sequence
from typing import Any

Variable = tuple[str | Sequence[str], Any, dict[str, Any]]
"""Dimensions, values and attributes of a variable."""


def labelled(values: Any, long_name: str, dims: str | Sequence[str] = (), **more: Any) -> Variable:
    """A dimensionless variable with the `attributes` of its long name."""
    return dims, values, attributes(long_name, **more)


def attributes(long_name: str, **more: Any) -> dict[str, Any]:
    """Attributes of a dimensionless variable: its long name, the unit 1, and ``more``."""
    return {"long_name": long_name, "units": "1", **more}
