"""Variables of a dataset, as xarray takes them."""

from collections.abc import Sequence
from typing import Any

Variable = tuple[str | Sequence[str], Any, dict[str, Any]]
"""Dimensions, values and attributes of a variable."""


def labelled(
    values: Any, long_name: str, dims: str | Sequence[str] = (), **attributes: Any
) -> Variable:
    """A dimensionless variable: its long name, the unit 1, and more ``attributes``."""
    return dims, values, {"long_name": long_name, "units": "1", **attributes}
