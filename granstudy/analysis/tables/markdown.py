"""A table of runs as a Markdown table that people read."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pandas as pd
import xarray as xr

from granstudy.analysis.columns import column, heading, parameter_heading
from granstudy.analysis.groups import groups, keys
from granstudy.analysis.labels import PAPERS_OWN, families
from granstudy.datasets.parameters import ABSENT
from granstudy.model.methods import METHODS
from granstudy.study.benchmark.front import fastest_within
from granstudy.trust.flags import FLAGS, Status, Trust, flag_word

ALONE = {"C0", "seconds"}
"""Columns that belong to one run each; methods then get a line each."""

JUDGED = {"truth", "state"}
"""Attributes of tables that judge each run, which then has a line, with its status."""

HIDDEN = ("has_paper", "reason")
"""Columns left out: `paper` is empty where `has_paper` is false, and reasons stand below the table."""

LONG_CELL = 12
"""Characters of a parameter beyond which it is rounded."""

NO_NUMBER = {str(value) for value in ABSENT.values() if not isinstance(value, str | bool)}
"""Numbers that stand for a parameter that a run lacks; their cells stay empty."""


def markdown_table(table: xr.Dataset) -> str:
    """Title, GitHub table, and a legend: the quantity, the fastest runs, failures, fixed parameters.

    Runs that differ in method alone share a line. Where an order was fitted, runs that differ in the refined
    parameter alone share one.
    """
    swept = table.attrs["swept"].split()
    left = len(swept) - 1
    if "refined" in table.attrs:
        header, lines = _across(table, swept, table.attrs["refined"])
    elif _shared_lines(table, swept):
        header, lines = _across(table, swept, "method")
    else:
        header, lines = _long(table, swept)
        left = len(swept)
    rows = github_table(header, lines, ["left"] * left + ["right"] * (len(header) - left))
    return "\n".join([f"# {table.attrs['title']}", "", rows, "", *_legend(table)]) + "\n"


def github_table(
    header: Sequence[str], lines: Sequence[Sequence[str]], alignment: Sequence[str]
) -> str:
    """Write cells as a GitHub table; ``alignment`` has ``left`` or ``right`` for each column."""
    text: str = pd.DataFrame(lines, columns=list(header)).to_markdown(
        index=False, tablefmt="pipe", colalign=alignment, disable_numparse=True
    )
    return text


def _shared_lines(table: xr.Dataset, swept: list[str]) -> bool:
    """Tell whether at least half of the lines would hold more than one method."""
    if "method" not in swept or ALONE & set(table) or JUDGED & set(table.attrs):
        return False
    runs = Counter(_cells(table, [name for name in swept if name != "method"])).values()
    return 2 * sum(count > 1 for count in runs) >= len(runs)


def _cells(table: xr.Dataset, names: Sequence[str]) -> list[tuple[str, ...]]:
    """Parameters of every run as cells, empty where the run does not have one."""
    texts = [[str(value) for value in key] for key in keys(table, names)]
    return [tuple("" if text in NO_NUMBER else text for text in row) for row in texts]


def _short(cell: str) -> str:
    """A cell as a reader wants it: a number that was chosen, with all its digits, to six."""
    try:
        return f"{float(cell):.6g}" if len(cell) > LONG_CELL else cell
    except ValueError:
        return cell


def _long(table: xr.Dataset, swept: list[str]) -> tuple[list[str], list[list[str]]]:
    """One line a run, all columns."""
    hidden = (*HIDDEN, *(() if JUDGED & set(table.attrs) else ("status",)))
    names = [str(name) for name in table.data_vars if name not in hidden]
    lines = [
        [*map(_short, cells), *(_number(table, name, i) for name in names)]
        for i, cells in enumerate(_cells(table, swept))
    ]
    return [*map(parameter_heading, swept), *map(heading, names)], lines


def _across(table: xr.Dataset, swept: list[str], across: str) -> tuple[list[str], list[list[str]]]:
    """One line for the runs that differ in ``across`` alone: the quantity side by side."""
    names = [name for name in swept if name != across]
    rows = groups(_cells(table, names))
    values = [cell for (cell,) in _cells(table, [across])]
    columns = _in_order(list(dict.fromkeys(values)), across)
    label = "" if across == "method" else f"{heading(across)} = "
    header = [heading(name) for name in names] + [label + value for value in columns]
    with_paper, with_order = "paper" in table, "order" in table
    if with_paper:
        header += ["paper", *(f"{value} / paper" for value in columns)]
    if with_order:
        header.append(heading("order"))
    lines = []
    for key in _as_swept(list(rows)):
        place = {values[i]: i for i in rows[key]}
        found = [place.get(value) for value in columns]
        some = next(i for i in found if i is not None)
        numbers = _numbers(table, table.attrs["quantity"], found)
        cells = [*key, *(f"{n}{_mark(table, i)}" for n, i in zip(numbers, found, strict=True))]
        if with_paper:
            cells += [_number(table, "paper", some), *_numbers(table, "ratio", found)]
        if with_order:
            cells.append(_number(table, "order", some))
        lines.append(cells)
    return header, lines


def _in_order(values: list[str], across: str) -> list[str]:
    """Sort the values that are laid across: the paper's method first, numbers from large to small."""
    if across != "method":
        return sorted(values, key=float, reverse=True)
    known = list(dict.fromkeys([*PAPERS_OWN, *METHODS, *values]))
    return sorted(values, key=known.index)


def _as_swept(cells: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Sort lines as the sweep does, parameter by parameter, whichever block a run comes from."""
    order = [
        {value: i for i, value in enumerate(dict.fromkeys(values))}
        for values in zip(*cells, strict=True)
    ]
    return sorted(cells, key=lambda key: [o[v] for o, v in zip(order, key, strict=True)])


def _numbers(table: xr.Dataset, name: str, runs: Sequence[int | None]) -> list[str]:
    return ["" if i is None else _number(table, name, i) for i in runs]


def _mark(table: xr.Dataset, i: int | None) -> str:
    """The label of a run that is not trusted, behind its number."""
    doubtful = (Trust.MARGINAL, Trust.UNTRUSTED)
    if i is None or "trust" not in table or int(table["trust"][i]) not in doubtful:
        return ""
    return f" ({flag_word('trust', table['trust'][i])})"


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
    if own := table[name].attrs.get("format"):
        return format(float(value), own)
    measure = table.attrs["paper_quantity"] if name == "paper" else name
    return column(measure, _beside(table)).text(float(value))


def _beside(table: xr.Dataset) -> list[str]:
    """Other experiments, whose names may stand in columns' names."""
    beside: str = table.attrs.get("beside", "")
    return beside.split()


def _legend(table: xr.Dataset) -> list[str]:
    """Explain the quantity, list the fastest runs and the failures, and name fixed parameters."""
    quantity = table.attrs["quantity"]
    legend = column(quantity, _beside(table)).legend
    own = table[quantity].attrs
    meaning = legend or ", ".join(
        text for text in (own.get("long_name", quantity), own.get("definition")) if text
    )
    lines = [f"{quantity}: {meaning}."]
    if "paper" in table:
        lines[0] += " An empty cell under paper: the paper prints no number there."
    if "as_printed" in table:
        lines[0] += (
            f" as printed: {table['as_printed'].attrs['long_name']}; docs/method.md §6 has the reason."
        )
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
        f"{parameter_heading(str(name))} = {_plain(c.item())}"
        for name, c in table.coords.items()
        if c.ndim == 0 and c.item() != -1
    ]
    if fixed:
        lines += ["", "Held fixed: " + ", ".join(fixed) + "."]
    return lines


def _plain(value: object) -> str:
    """A value as a reader wants it: a real number to six digits, and with a point."""
    if not isinstance(value, float):
        return str(value)
    text = f"{value:.6g}"
    return text if set(text) & set(".en") else f"{text}.0"


def _read_front(table: xr.Dataset) -> list[str]:
    """Say, for every method, which run is the fastest with no larger error than the baseline's."""
    lines = []
    base = int(np.argmax(table["baseline"].values))
    same = table.isel(run=np.flatnonzero(table["threads"] == table["threads"][base]))
    largest = float(table["error"][base])
    for (name,), members in groups([(family,) for family in families(same)]).items():
        part = same.isel(run=members)
        found = fastest_within(part["seconds"].values, part["error"].values, largest)
        if found is not None:
            row = part.isel(run=found)
            lines.append(
                f"- {name}: {float(row['speedup']):.3g} times the baseline's speed "
                f"at an error of {float(row['error']):.1e}"
            )
    return [f"The fastest runs with an error of at most the baseline's {largest:.1e}:", "", *lines]
