"""Study files: the typed model of their YAML, and how one is read."""

from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import Field, ValidationError, model_validator

from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.generated import Section
from granstudy.study.schema.mistakes import explain


class MapModel(Section):
    """A table and a figure of all experiments that have a truth: errors and labels."""

    title: str


MAP = "map"
"""What the files of a study's map are called; no experiment can have that name."""


class StudyFile(Section):
    """A study: titled experiments, each swept over its parameters."""

    title: str
    experiments: Annotated[dict[str, Experiment], Field(min_length=1)]
    map: MapModel | None = None

    @model_validator(mode="after")
    def _fits_together(self) -> "StudyFile":
        if MAP in self.experiments:
            raise ValueError(f"experiments.{MAP}: is the name of the map's files; take another")
        if self.map is not None and not self.with_truth:
            raise ValueError("map: shows experiments with a truth, and there is none")
        return self

    @property
    def with_truth(self) -> list[str]:
        """Names of the experiments whose runs are held against a truth."""
        return [name for name, experiment in self.experiments.items() if experiment.has_truth]


def read_study_file(path: str | Path) -> StudyFile:
    """Read a study file; its runs are not checked yet.

    Raises
    ------
    ValueError
        One line an error, each naming the file, the field, the value and what is allowed.
    """
    path = Path(path)
    if not path.is_file():
        raise ValueError(f"study {str(path)!r}: no such file")
    try:
        content = yaml.safe_load(path.read_text())
    except yaml.YAMLError as error:
        raise ValueError(f"{path}: not YAML: {error}") from None
    return study_model(content, str(path))


def study_model(content: Any, source: str = "study") -> StudyFile:
    """The typed model of what a study file says.

    Parameters
    ----------
    content : dict
        What the file says, as plain data.
    source : str
        Where it comes from, for messages.

    Raises
    ------
    ValueError
        One line an error, each naming the source, the field, the value and what is allowed.
    """
    try:
        return StudyFile.model_validate(content)
    except ValidationError as error:
        lines = [f"{source}: {line}" for line in explain(error, StudyFile)]
        raise ValueError("\n".join(lines)) from None
