"""Sections of a report: an experiment's table and figure, with what they show."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import xarray as xr
from markupsafe import Markup

from granstudy.analysis.columns import heading
from granstudy.analysis.figures.figure import FIGURES
from granstudy.analysis.report.markup import data_uri, html_of
from granstudy.analysis.tables.atlas import markdown_atlas
from granstudy.analysis.tables.map import markdown_map
from granstudy.analysis.tables.markdown import HIDDEN
from granstudy.analysis.tables.table import KINDS
from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.parameters import parameter
from granstudy.study.layout import Layout
from granstudy.study.schema.experiment import FigureModel
from granstudy.study.schema.file import AtlasModel, MapModel
from granstudy.study.schema.names import ATLAS, MAP
from granstudy.trust.flags import Trust

LARGEST_SVG = 1_000_000
"""Bytes; a figure with more is shown as PNG."""

MARKED = "Trusted runs are filled, marginal ones hollow, untrusted ones pale."
MARKED_OTHERWISE = {
    "map": "Cells of marginal and of untrusted runs are hatched.",
    "gallery": "Lines of untrusted runs are pale.",
}
"""How figures show labels, by the kind of figure where it is another way."""

OF_ATLAS = (
    "States over e and λ: a2, a3, K and the tail, and how far the linear theories are off. States that "
    "are not trusted are hatched. The dataset has every number with its error."
)
"""What the atlas of a study shows."""

OF_MAP = "Errors of T and a2 of every run that is held against a truth, and its label."
"""What the map of a study shows."""


@dataclass(frozen=True)
class Definition:
    """A column of a table: its heading, and what it is."""

    heading: str
    meaning: str


@dataclass(frozen=True)
class Drawing:
    """A figure as it stands in the page: its address, what is seen, the same for who does not see it."""

    address: str
    caption: str
    alternative: str


@dataclass(frozen=True)
class SectionOf:
    """One experiment, the map, or the atlas.

    Attributes
    ----------
    name, title : str
    table : Markup or None
    definitions : list of Definition
        Of the table's columns.
    drawing : Drawing or None
    csv : str or None
        Address of the table as CSV.
    missing : list of str
        What the study asks for and was not made.
    """

    name: str
    title: str
    table: Markup | None
    definitions: list[Definition]
    drawing: Drawing | None
    csv: str | None
    missing: list[str]


def sections(layout: Layout) -> list[SectionOf]:
    """All that a study asks for: map and atlas first, then the experiments in the study file's order."""
    model = layout.study.model
    joint = {
        MAP: (model.map, OF_MAP, markdown_map),
        ATLAS: (model.atlas, OF_ATLAS, markdown_atlas),
    }
    return [
        _joint_section(layout, name, *joint[name]) if name in joint else _section(layout, name)
        for name in layout.tabled
    ]


def _section(layout: Layout, name: str) -> SectionOf:
    experiment = layout.experiment(name)
    table = _table(layout, name)
    asked = experiment.figure
    drawing = None
    if asked is not None and table is not None:
        drawing = _drawing(layout, name, _caption(asked, table), asked.title or experiment.title)
    missing = [f"table {name}"] if experiment.table is not None and table is None else []
    missing += [f"figure {name}"] if asked is not None and drawing is None else []
    return SectionOf(
        name=name,
        title=experiment.title,
        table=None if table is None else html_of(KINDS[experiment.run].markdown(table)),
        definitions=[] if table is None else definitions(table),
        drawing=drawing,
        csv=_csv(layout, name),
        missing=missing,
    )


def _joint_section(
    layout: Layout,
    name: str,
    asked: MapModel | AtlasModel | None,
    caption: str,
    markdown: Callable[[xr.Dataset], str],
) -> SectionOf:
    """A section of what several experiments are joined to."""
    table = _table(layout, name)
    title = asked.title if asked is not None else name
    drawing = _drawing(layout, name, caption, title)
    return SectionOf(
        name=name,
        title=title,
        table=None if table is None else html_of(markdown(table)),
        definitions=[] if table is None else definitions(table),
        drawing=drawing,
        csv=_csv(layout, name),
        missing=[] if table is not None and drawing is not None else [name],
    )


def _table(layout: Layout, name: str) -> xr.Dataset | None:
    path = Path(layout.table_file(name))
    return read_dataset(path) if path.is_file() else None


def _csv(layout: Layout, name: str) -> str | None:
    path = Path(layout.table_file(name, "csv"))
    return data_uri(path) if path.is_file() else None


def _drawing(layout: Layout, name: str, caption: str, title: str) -> Drawing | None:
    """The figure as SVG, as PNG where that is large; None where there is none."""
    svg, png = (Path(layout.figure_file(name, form)) for form in ("svg", "png"))
    if not (svg.is_file() and png.is_file()):
        return None
    address = data_uri(svg if svg.stat().st_size <= LARGEST_SVG else png)
    shown = caption.partition(". ")[0].rstrip(".")
    return Drawing(address, caption, f"{title}. {shown}. The table has the numbers.")


def _caption(asked: FigureModel, table: xr.Dataset) -> str:
    """What a figure shows, in a sentence; how labels are marked, where runs have any."""
    quantity = asked.quantity or table.attrs["quantity"]
    words = {"quantity": _long_name(table, quantity)}
    words |= {axis: _long_name(table, getattr(asked, axis) or "time") for axis in ("x", "y")}
    shows = FIGURES[asked.kind].shows.format(**words)
    if shows[1:2].islower():  # else it begins with a symbol, such as a2
        shows = shows[0].upper() + shows[1:]
    doubtful = "trust" in table and bool((table["trust"] != Trust.TRUSTED).any())
    marked = MARKED_OTHERWISE.get(asked.kind, MARKED)
    return f"{shows}. {marked}" if doubtful else f"{shows}."


def _long_name(table: xr.Dataset, name: str) -> str:
    """What a column or a parameter is, in words."""
    if name in table.data_vars:
        return str(table[name].attrs.get("long_name") or heading(name))
    return parameter(name).long_name or name


def definitions(table: xr.Dataset) -> list[Definition]:
    """What the columns of a table are: swept parameters first."""
    swept = [name for name in table.attrs["swept"].split() if parameter(name).long_name]
    columns = [str(name) for name in table.data_vars if name not in HIDDEN]
    found = [Definition(heading(name), parameter(name).long_name) for name in swept]
    for name in columns:
        own = table[name].attrs
        parts = [own.get("long_name", ""), own.get("definition", "")]
        unit = own.get("units", "1")
        parts += [f"in {unit}"] if unit not in ("1", "") else []
        meaning = ", ".join(part for part in parts if part)
        if meaning:
            found.append(Definition(heading(name), meaning))
    return found
