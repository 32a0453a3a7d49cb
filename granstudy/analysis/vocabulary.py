"""Words of a study file that the analysis knows, in the JSON schema for editors.

The schema of study files, one floor below, takes any text for them. ``python -m
granstudy.analysis.vocabulary`` writes the JSON schema with the words.
"""

from pathlib import Path
from typing import Any

from granstudy.analysis.figures.figure import FIGURES
from granstudy.analysis.tables.fits import FITS
from granstudy.study.schema.file import StudyFile
from granstudy.support.files import write_json

WORDS = {("FigureModel", "kind"): list(FIGURES), ("FitModel", "law"): list(FITS)}
"""Known words by section and field."""

SCHEMA = Path(__file__).parents[1] / "workflow" / "study.schema.json"
"""Where the JSON schema of study files lies."""


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
    write_json(Path(path), study_schema())


if __name__ == "__main__":
    write_schema()
