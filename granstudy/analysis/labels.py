"""Names of runs in legends, cells and rows."""

from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr

from granstudy.analysis.groups import groups, keys, values_of
from granstudy.model.methods import YARDSTICK

ASKED = "accuracy"
"""Family of the runs that were asked for an accuracy, and the parameter that says which."""

TOLERANCE = ", rtol"
SINGLE = ", single"
ON_GPU = ", gpu"
"""Endings of a method's name for runs with a tolerance, in single precision, on a GPU."""

PAPERS_OWN = (YARDSTICK, "full")
"""Method and variant that reproduce the paper: before all others in tables, under them in figures."""


def families(table: xr.Dataset) -> list[str]:
    """Family of each run, a line of a front: `ASKED`, or the method with `TOLERANCE`, `SINGLE`, `ON_GPU`."""
    return [
        ASKED
        if accuracy > 0
        else str(method)
        + TOLERANCE * bool(rtol > 0)
        + SINGLE * (precision == "single")
        + ON_GPU * (device == "gpu")
        for accuracy, method, rtol, precision, device in zip(
            values_of(table, ASKED, -1.0),
            values_of(table, "method"),
            values_of(table, "rtol", -1.0),
            values_of(table, "precision"),
            values_of(table, "device"),
            strict=True,
        )
    ]


SAYS_LEAST = ("time_rtol", "sphere_rule")
"""Parameters that a label leaves out where the others tell runs apart."""


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
    """Write a parameter as a label does: ``N = 32``, ``rescaled``, ``conserve mass``."""
    if isinstance(value, str):
        return f"{name} {value}" if name == "conserve" else value
    return f"{called} = {value:g}"


def run_text(parameters: Mapping[str, object], called: Callable[[str], str] = str) -> str:
    """Write a run's parameters as a label does, without those that the run lacks, which are "".

    ``called`` gives a parameter's name in the label.
    """
    return ", ".join(
        parameter_text(name, value, called(name))
        for name, value in parameters.items()
        if value != ""
    )
