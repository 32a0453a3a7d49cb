"""Words of a study file that the analysis knows: quantities, printed tables, fit laws, kinds of figures.

The schema of study files, one floor below, takes any text for them. ``python -m
granstudy.analysis.vocabulary`` writes the JSON schema with the words, for editors.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from granstudy.analysis.columns import COLUMNS, listed
from granstudy.analysis.figures.figure import FIGURES, check_kind
from granstudy.analysis.paper.printed import check_printed
from granstudy.analysis.tables.fits import FITS, check_law
from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.file import StudyFile
from granstudy.support.errors import unknown_name

WORDS = {("FigureModel", "kind"): list(FIGURES), ("FitModel", "law"): list(FITS)}
"""Known words by section and field."""

SCHEMA = Path("workflow/config/study.schema.json")
"""Where the JSON schema of study files lies in a checkout."""


def check_words(study: StudyFile, path: str | Path = "") -> None:
    """Check every word of a study file that the analysis has to know.

    Parameters
    ----------
    path : str or Path
        The file, for the messages.

    Raises
    ------
    ValueError
        One line an unknown word, each naming the field, the word, the nearest known one and what is allowed.
    """
    problems = []
    for name, experiment in study.experiments.items():
        for field, word, check in _words(experiment):
            try:
                check(word)
            except ValueError as error:
                where = f"experiments.{name}.{field}"
                problems.append(f"{path}: {where}: {error}" if path else f"{where}: {error}")
    if problems:
        raise ValueError("\n".join(problems))


def _words(experiment: Experiment) -> list[tuple[str, str, Callable[[str], None]]]:
    """Words of an experiment: field, word, and the function that checks it."""
    table, fit, figure = experiment.table, experiment.fit, experiment.figure
    found: list[tuple[str, str, Callable[[str], None]]] = []
    if table is not None:
        found.append(("table.quantity", table.quantity, _check_column))
    if table is not None and table.paper is not None:
        found.append(("table.paper", table.paper, check_printed))
    if fit is not None:
        found.append(("fit.law", fit.law, check_law))
    if figure is not None:
        found.append(("figure.kind", figure.kind, check_kind))
    return found


def _check_column(quantity: str) -> None:
    try:
        listed(quantity)
    except ValueError:
        raise unknown_name("quantity", quantity, list(COLUMNS)) from None


def study_schema() -> dict[str, Any]:
    """The JSON schema of study files, with the words that the analysis knows."""
    schema = StudyFile.model_json_schema()
    for (section, field), known in WORDS.items():
        fields = schema["$defs"][section]["properties"]
        others = {key: value for key, value in fields[field].items() if key != "enum"}
        fields[field] = {"enum": known, **others}
    return schema


def write_schema(path: str | Path = SCHEMA) -> None:
    """Write the JSON schema of study files, for editors that complete and check YAML."""
    Path(path).write_text(json.dumps(study_schema(), indent=1, ensure_ascii=False) + "\n")


if __name__ == "__main__":
    write_schema()
