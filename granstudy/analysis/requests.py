"""What a study asks of its runs, tables, fits and figures, held against what they will be, before any run."""

from collections.abc import Mapping
from pathlib import Path

import xarray as xr
from matplotlib.cbook import is_math_text
from matplotlib.mathtext import MathTextParser

from granstudy.analysis.figures.figure import check_figure
from granstudy.analysis.source import FigureSource, TableSource
from granstudy.analysis.tables.atlas import atlas_of
from granstudy.analysis.tables.planned import planned_table
from granstudy.analysis.tables.table import KINDS
from granstudy.study.schema.experiment import Experiment
from granstudy.study.study import Study

PARTS = ("title", "table", "fit", "figure")
"""Fields of an experiment that a mistake is told of."""


def check_requests(study: Study, path: str | Path = "") -> None:
    """Check that every table, fit and figure of a study can be made of its runs.

    Nothing is computed: each table is planned with 1 for every number, by the functions that will make it.

    Parameters
    ----------
    path : str or Path
        The study file, for the messages.

    Raises
    ------
    ValueError
        One line a mistake, each naming the experiment, the field, its value and what is allowed.
    """
    mistakes: list[str] = []
    tables: dict[str, xr.Dataset | None] = {}
    for name, experiment in study.model.experiments.items():
        mistakes += _of_titles(name, experiment)
    if study.model.map is not None:
        mistakes += [f"map.{error}" for error in _unreadable("title", study.model.map.title)]
    if study.model.atlas is not None:
        mistakes += [f"atlas.{error}" for error in _unreadable("title", study.model.atlas.title)]
    for name in _in_order(study, mistakes):
        tables[name] = _planned(study, name, tables, mistakes)
    for name in study.model.experiments:
        mistakes += _of_figure(study, name, tables)
    mistakes += _of_atlas(study, tables)
    if mistakes:
        raise ValueError("\n".join(f"{path}: {line}" if path else line for line in mistakes))


def _of_atlas(study: Study, tables: Mapping[str, xr.Dataset | None]) -> list[str]:
    """What is wrong with a study's atlas; nothing where its tables are wrong already."""
    found = [tables.get(name) for name in study.model.with_states]
    there = [table for table in found if table is not None]
    if study.model.atlas is None or len(there) < len(found):
        return []
    try:
        atlas_of(study.model.atlas.title, there)
    except ValueError as error:
        return [f"atlas: {error}"]
    return []


def _in_order(study: Study, mistakes: list[str]) -> list[str]:
    """Experiments, each after those whose tables stand beside its own; none of those in a circle."""
    order: list[str] = []
    left = {name: set(each.beside_table) for name, each in study.model.experiments.items()}
    while ready := [name for name, waits in left.items() if waits <= set(order)]:
        order += ready
        left = {name: waits for name, waits in left.items() if name not in order}
    mistakes += [
        f"experiments.{name}.table.beside={sorted(waits)!r}: stand beside each other in a circle; leave "
        "one out"
        for name, waits in left.items()
    ]
    return order


def _planned(
    study: Study, name: str, tables: Mapping[str, xr.Dataset | None], mistakes: list[str]
) -> xr.Dataset | None:
    """The table of an experiment as it will be; None where there is a mistake in it, or in one beside it."""
    experiment = study.model.experiments[name]
    beside = [tables[other] for other in experiment.beside_table]
    there = [table for table in beside if table is not None]
    if len(there) < len(beside):
        return None
    try:
        return planned_table(table_source(study, name, there))
    except ValueError as error:
        mistakes += [_line(name, text, "table") for text in str(error).splitlines()]
        return None


def table_source(study: Study, name: str, beside: list[xr.Dataset]) -> TableSource:
    """The source of an experiment's table before any run: without files."""
    experiment, runs = study.model.experiments[name], study.runs[name]
    asked = experiment.table
    quantity = KINDS[experiment.run].quantity if asked is None else asked.quantity
    return TableSource(
        experiment=experiment,
        runs=runs,
        files=[""] * len(runs),
        beside=beside,
        quantity=quantity,
    )


def _of_figure(study: Study, name: str, tables: Mapping[str, xr.Dataset | None]) -> list[str]:
    """What is wrong with an experiment's figure; nothing where its tables are wrong already."""
    experiment = study.model.experiments[name]
    if experiment.figure is None:
        return []
    others = [tables.get(other) for other in experiment.beside_figure]
    beside, table = [other for other in others if other is not None], tables.get(name)
    if table is None or len(beside) < len(others):
        return []
    source = table_source(study, name, [])
    figure = FigureSource(
        experiment=experiment, runs=source.runs, files=source.files, beside=beside, table=table
    )
    try:
        check_figure(figure)
    except ValueError as error:
        return [_line(name, text, "figure") for text in str(error).splitlines()]
    return []


def _line(name: str, text: str, part: str) -> str:
    """A mistake with its experiment, and with its field where the text does not begin with it."""
    begins = any(text.startswith((f"{field}.", f"{field}=")) for field in PARTS)
    return f"experiments.{name}.{text}" if begins else f"experiments.{name}.{part}: {text}"


def _of_titles(name: str, experiment: Experiment) -> list[str]:
    """What is wrong with texts that Matplotlib draws."""
    texts = {"title": experiment.title}
    if experiment.figure is not None and experiment.figure.title is not None:
        texts["figure.title"] = experiment.figure.title
    drawn = experiment.figure is not None or experiment.has_truth
    found = texts.items() if drawn else ()
    return [
        f"experiments.{name}.{error}" for key, text in found for error in _unreadable(key, text)
    ]


def _unreadable(field: str, text: str) -> list[str]:
    """One line where Matplotlib cannot read a text as mathematics."""
    for line in text.splitlines():
        if not is_math_text(line):
            continue
        try:
            MathTextParser("path").parse(line)
        except ValueError as error:
            reason = str(error).strip().splitlines()[-1]
            return [
                f"{field}: value {text!r}: between $ and $ stands mathematics that Matplotlib cannot read "
                f"({reason}); write \\$ for a dollar"
            ]
    return []
