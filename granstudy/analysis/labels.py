"""How runs are called: in legends, in cells, in rows."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

TOLERANCE = ", rtol"


SINGLE = ", single"


ON_GPU = ", gpu"
"""What is added to the method of a run with a tolerance, in single precision, or on a GPU."""


def families(table: xr.Dataset) -> list[str]:
    """What each run of a table counts as on the front: its method, with `TOLERANCE`, `SINGLE`, `ON_GPU`."""

    def along(name: str, absent: object) -> np.ndarray:
        values = table[name].values if name in table.coords else np.array(absent)
        return np.broadcast_to(values, table.sizes["run"])

    return [
        str(method)
        + TOLERANCE * bool(rtol > 0)
        + SINGLE * (precision == "single")
        + ON_GPU * (device == "gpu")
        for method, rtol, precision, device in zip(
            along("method", ""),
            along("rtol", -1.0),
            along("precision", ""),
            along("device", ""),
            strict=True,
        )
    ]


SAYS_LEAST = ("time_rtol", "sphere_rule")
"""Parameters that a label leaves out where runs can be told apart without."""


def telling_apart(table: xr.Dataset) -> list[str]:
    """The swept parameters that tell a table's runs apart."""
    swept = table.attrs["swept"].split()
    names = [name for name in swept if np.unique(table[name].values).size > 1]
    for name in SAYS_LEAST:
        fewer = [other for other in names if other != name]
        rows = {tuple(table[other].values[i] for other in fewer) for i in range(table.sizes["run"])}
        if len(rows) == table.sizes["run"]:
            names = fewer
    return names


def parameter_text(name: str, value: object, symbol: str = "") -> str:
    """A parameter as a label says it: ``N = 32``, ``rescaled``, ``conserve mass``."""
    if isinstance(value, str):
        return f"{name} {value}" if name == "conserve" else value
    return f"{symbol or name} = {value:g}"


def run_text(parameters: Mapping[str, object], symbols: Mapping[str, str] = {}) -> str:
    """Parameters of a run as a label says them; "" stands for one that the run does not have."""
    return ", ".join(
        parameter_text(name, value, symbols.get(name, ""))
        for name, value in parameters.items()
        if value != ""
    )
