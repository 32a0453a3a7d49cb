"""Numbers printed in the paper, and the runs that they belong to."""

from dataclasses import dataclass
from importlib.resources import as_file, files
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from granstudy.analysis.columns import computed
from granstudy.support.errors import unknown_name

TABLES = (1, 2, 3, 4, 5, 6, 7, 8)
"""Numbers of the tables that the paper prints."""

NAMES = (*(f"table{number}" for number in TABLES), "figure4")
"""Names that a study file can give as ``table: {paper: ...}``."""

HAFF_CONSTANTS = {0.2: 0.5159, 0.8: 0.19058}
"""C0 by e for T0 = 2, the legend of the published Fig. 4 (docs/method.md §6).

With N = 32, our C0 is 0.1906 and 0.5160 at R = 8, but 0.1878 and 0.5102 at R = 7, where the
truncation takes 6% of the initial cooling: the printed numbers are those of R = 8.
"""

VARIANTS = ("full", "separate")
"""Columns of Tables 1 and 2."""

TIMED = {"direct": ("direct",), "fast": ("literal", "fast")}
"""Methods that Table 5 times, and ours beside each: the same method first, then a faster one."""

FACTORS = {"table3": 9 / 4}
"""What our quantity is multiplied by, to be what the paper's code prints (docs/method.md §6).

For Table 3 that code took T = (3/2) ∫ ½|v|² f dv where 2/3 is meant, in T and in T_ref alike.
"""


@dataclass(frozen=True)
class Printed:
    """One printed number and the parameters of the runs it is compared with."""

    parameters: dict[str, Any]
    value: float


def paper_table(number: int) -> pd.DataFrame:
    """Table of the paper by its number, a row for each row printed (docs/method.md §6).

    Raises
    ------
    ValueError
        If the paper has no such table.
    """
    if isinstance(number, bool) or number not in TABLES:
        raise unknown_name("table", number, [str(table) for table in TABLES])
    with as_file(files(__package__) / f"table{number}.csv") as path:
        return pd.read_csv(path)


def printed_quantity(name: str, quantity: str) -> str:
    """Name the variable of a table that ``name`` prints: the table's quantity, C0 for Figure 4."""
    return "C0" if name == "figure4" else quantity


def printed_numbers(name: str) -> list[Printed]:
    """List all numbers of ``table1`` .. ``table8``, or the Haff constants of ``figure4``.

    Raises
    ------
    ValueError
        For another name.
    """
    check_printed(name)
    if name == "figure4":
        return [Printed({"e": e}, C0) for e, C0 in HAFF_CONSTANTS.items()]
    number = int(name.removeprefix("table"))
    columns = _columns(number)
    rows = paper_table(number).to_dict("records")
    return [
        Printed({key: v for key, v in row.items() if key not in columns} | also, row[column])
        for row in rows
        for column, conditions in columns.items()
        for also in conditions
        if not np.isnan(row[column])
    ]


def check_printed(name: str) -> None:
    """Raise ValueError unless the paper prints numbers under this name."""
    if name not in NAMES:
        raise unknown_name("printed table", name, NAMES)


def _columns(number: int) -> dict[str, list[dict[str, Any]]]:
    """Columns of numbers of a table, each with the parameters of its runs.

    Tables 1 and 2 have a column for each variant, Table 5 one for each method (`TIMED`). Tables 3, 4, 6 and 7
    are spherical designs, Table 8 is Gauss–Legendre in θ and φ.
    """
    if number in (1, 2):
        return {variant: [{"variant": variant}] for variant in VARIANTS}
    if number == 5:
        return {
            f"{method}_seconds": [{"method": name} for name in ours]
            for method, ours in TIMED.items()
        }
    rule = "gauss-theta-phi" if number == 8 else "design"
    return {str(paper_table(number).columns[-1]): [{"sphere_rule": rule}]}


def match_printed(name: str, runs: xr.Dataset) -> np.ndarray:
    """Find the printed number of every run, NaN where the paper prints none.

    Raises
    ------
    ValueError
        If the runs have no parameter that the table is printed by.
    """
    values = np.full(runs.sizes["run"], np.nan)
    for printed in printed_numbers(name):
        same = np.ones(values.size, dtype=bool)
        for key, value in printed.parameters.items():
            if key not in runs.coords:
                raise ValueError(f"paper={name!r}: is printed by {key}, which the runs do not have")
            same &= runs[key].values == value
        values[same] = printed.value
    return values


def with_paper(table: xr.Dataset, paper: str, quantity: str) -> xr.Dataset:
    """Add the printed number of each run and ours over it.

    Where the paper's code prints a multiple of the quantity (`FACTORS`), this multiple is `as_printed`, and
    its ratio to the printed number is taken. The attribute `factor` of `paper` has the factor.

    Raises
    ------
    ValueError
        If the table does not have the quantity, or the paper prints no number for any of the runs.
    """
    if quantity not in table:
        raise ValueError(f"paper={paper!r}: prints {quantity}, which the table does not have")
    printed = match_printed(paper, table)
    has_paper = np.isfinite(printed)
    if not has_paper.any():
        raise ValueError(f"paper={paper!r}: prints no number for any of the runs")
    factor = FACTORS.get(paper, 1.0)
    ours = factor * table[quantity].values
    if factor != 1.0:
        table["as_printed"] = computed("as_printed", ours, of=quantity, factor=factor)
    table["paper"] = computed("paper", printed, of=quantity)
    table["paper"].attrs |= {"units": table[quantity].attrs.get("units", "1"), "factor": factor}
    table["ratio"] = computed("ratio", ours / printed)
    table["has_paper"] = computed("has_paper", has_paper)
    table.attrs["paper_quantity"] = quantity
    return table
