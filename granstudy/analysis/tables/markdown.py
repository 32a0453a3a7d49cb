"""A table of runs as a Markdown table that people read."""

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np
import xarray as xr

from granstudy.analysis.columns import HEADINGS, QUANTITIES, _digits
from granstudy.analysis.labels import families
from granstudy.study.benchmark.front import fastest_within
from granstudy.trust.flags import FLAGS, Status, flag_word


def markdown_table(table: xr.Dataset) -> str:
    """Title, GitHub table, and a line saying what the columns are.

    Where runs differ in method alone they share a line; where an order was fitted, runs that differ
    in the refined parameter alone do.
    """
    swept = table.attrs["swept"].split()
    parameters = len(swept) - 1
    if "refined" in table.attrs:
        header, lines = _across(table, swept, table.attrs["refined"])
    elif _shared_lines(table, swept):
        header, lines = _across(table, swept, "method")
    else:
        header, lines = _long(table, swept)
        parameters = len(swept)
    rule = ["---" if i < parameters else "---:" for i in range(len(header))]
    rows = rows_text([header, rule, *lines])
    return "\n".join([f"# {table.attrs['title']}", "", rows, "", *_legend(table)]) + "\n"


def rows_text(rows: Iterable[Sequence[str]]) -> str:
    """Rows of cells as the lines of a GitHub table."""
    return "\n".join("| " + " | ".join(cells) + " |" for cells in rows)


def _shared_lines(table: xr.Dataset, swept: list[str]) -> bool:
    """Tell whether at least half of the lines would hold more than one method."""
    if "method" not in swept or {"C0", "seconds", "trust"} & set(table):
        return False
    runs = Counter(_keys(table, [name for name in swept if name != "method"])).values()
    return 2 * sum(count > 1 for count in runs) >= len(runs)


def _keys(table: xr.Dataset, names: list[str]) -> list[tuple[str, ...]]:
    return [
        tuple(_parameter(table[name].values[i]) for name in names)
        for i in range(table.sizes["run"])
    ]


def _parameter(value: object) -> str:
    text = str(value)
    return "" if text in ("-1", "-1.0") else text


def _long(table: xr.Dataset, swept: list[str]) -> tuple[list[str], list[list[str]]]:
    """One line a run, all columns."""
    hidden = ("has_paper", "reason", *(() if "trust" in table else ("status",)))
    names = [str(name) for name in table.data_vars if name not in hidden]
    header = [HEADINGS.get(name, name) for name in swept]
    header += [HEADINGS.get(name, name.replace("_", " ")) for name in names]
    lines = [
        [*key, *(_number(table, name, i) for name in names)]
        for i, key in enumerate(_keys(table, swept))
    ]
    return header, lines


def _across(table: xr.Dataset, swept: list[str], across: str) -> tuple[list[str], list[list[str]]]:
    """One line for the runs that differ in ``across`` alone: the quantity side by side."""
    names = [name for name in swept if name != across]
    keys = _keys(table, names)
    # In the order of the sweep, parameter by parameter, whichever block a run comes from.
    order = [
        {value: i for i, value in enumerate(dict.fromkeys(values))}
        for values in zip(*keys, strict=True)
    ]
    columns = list(dict.fromkeys(_keys(table, [across])))
    if across == "method":
        # The yardstick beside the paper that it reproduces, then what we add.
        columns = sorted(
            columns,
            key=lambda c: ("literal", "fast", "carleman", "radial", "direct", "dsmc").index(c[0]),
        )
    else:
        columns = sorted(columns, key=lambda c: -float(c[0]))
    place = {
        (key, column): i
        for i, (key, column) in enumerate(zip(keys, _keys(table, [across]), strict=True))
    }
    quantity = table.attrs["quantity"]
    label = "" if across == "method" else f"{HEADINGS.get(across, across)} = "
    header = [HEADINGS.get(name, name) for name in names] + [label + c[0] for c in columns]
    with_paper = "paper" in table
    if with_paper:
        header += ["paper", *(f"{c[0]} / paper" for c in columns)]
    if "order" in table:
        header.append(HEADINGS["order"])
    lines = []
    for key in sorted(set(keys), key=lambda key: [o[v] for o, v in zip(order, key, strict=True)]):
        found = [place.get((key, column)) for column in columns]
        some = next(i for i in found if i is not None)
        cells = ["" if i is None else _number(table, quantity, i) for i in found]
        if with_paper:
            cells.append(_number(table, "paper", some))
            cells += ["" if i is None else _number(table, "ratio", i) for i in found]
        if "order" in table:
            cells.append(_number(table, "order", some))
        lines.append([*key, *cells])
    return header, lines


def _number(table: xr.Dataset, name: str, i: int) -> str:
    """Write a number to the digits that are worth reading."""
    value = table[name].values[i]
    if name in FLAGS:
        return flag_word(name, value)
    if table[name].dtype.kind in "biu":
        return str(value) if value.dtype.kind != "b" else "yes" * bool(value)
    if np.isnan(value):
        ended = Status(int(table["status"].values[i])).name.lower()
        return ended if name == table.attrs["quantity"] else ""
    return format(float(value), table[name].attrs.get("format") or _digits(table, name, value))


def _legend(table: xr.Dataset) -> list[str]:
    """Say what the quantity is, and what is held fixed."""
    quantity = table.attrs["quantity"]
    meaning = QUANTITIES.get(quantity, table[quantity].attrs.get("long_name", quantity))
    lines = [f"{quantity}: {meaning}."]
    if "paper" in table:
        lines[0] += " An empty cell under paper: the paper prints no number there."
    if "truth" in table.attrs:
        lines[0] += (
            f" The same of a2. Truth: {table.attrs['truth']}. A run that diverged is measured up to there."
        )
    elif (table["status"] == Status.DIVERGED).any():
        lines[0] += " diverged: the run could not reach the final time."
    if "front" in table:
        lines += ["", *_read_front(table)]
    for reason in dict.fromkeys(table["reason"].values) if "reason" in table else ():
        lines += ["", f"failed: {reason}."] if reason else []
    fixed = [
        f"{HEADINGS.get(str(name), name)} = {c.item()}"
        for name, c in table.coords.items()
        if c.ndim == 0 and c.item() != -1
    ]
    if fixed:
        lines += ["", "Held fixed: " + ", ".join(fixed) + "."]
    return lines


def _read_front(table: xr.Dataset) -> list[str]:
    """Say, for every method, which run is the fastest with no larger error than the baseline's."""
    lines = []
    base = int(np.argmax(table["baseline"].values))
    same = np.flatnonzero(table["threads"].values == table["threads"].values[base])
    largest = float(table["error"][base])
    family = families(table)
    for name in dict.fromkeys(family[i] for i in same):
        members = [i for i in same if family[i] == name]
        part = table.isel(run=members)
        found = fastest_within(part["seconds"].values, part["error"].values, largest)
        if found is not None:
            row = part.isel(run=found)
            lines.append(
                f"- {name}: {float(row['speedup']):.3g} times the baseline's speed "
                f"at an error of {float(row['error']):.1e}"
            )
    return [f"The fastest runs with an error of at most the baseline's {largest:.1e}:", "", *lines]
