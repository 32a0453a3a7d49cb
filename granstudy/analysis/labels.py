"""How runs are called: in legends, in cells, in rows."""

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr

from granstudy.analysis.groups import groups, keys, values_of

TOLERANCE = ", rtol"
SINGLE = ", single"
ON_GPU = ", gpu"
"""What is added to the method of a run with a tolerance, in single precision, or on a GPU."""

PAPERS_OWN = ("literal", "full")
"""The method and the variant that reproduce the paper: before all others in tables, under them in figures."""


def families(table: xr.Dataset) -> list[str]:
    """What each run of a table counts as on the front: its method, with `TOLERANCE`, `SINGLE`, `ON_GPU`."""
    return [
        str(method)
        + TOLERANCE * bool(rtol > 0)
        + SINGLE * (precision == "single")
        + ON_GPU * (device == "gpu")
        for method, rtol, precision, device in zip(
            values_of(table, "method"),
            values_of(table, "rtol", -1.0),
            values_of(table, "precision"),
            values_of(table, "device"),
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
        if len(groups(keys(table, fewer))) == table.sizes["run"]:
            names = fewer
    return names


def parameter_text(name: str, value: object, called: str) -> str:
    """A parameter as a label says it: ``N = 32``, ``rescaled``, ``conserve mass``."""
    if isinstance(value, str):
        return f"{name} {value}" if name == "conserve" else value
    return f"{called} = {value:g}"


def run_text(parameters: Mapping[str, object], called: Callable[[str], str] = str) -> str:
    """Parameters of a run as a label says them, without those that are "": the run lacks them.

    ``called`` gives the name that the label has for a parameter.
    """
    return ", ".join(
        parameter_text(name, value, called(name))
        for name, value in parameters.items()
        if value != ""
    )
