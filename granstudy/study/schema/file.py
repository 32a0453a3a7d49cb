"""Study files: the typed model of their YAML, and how one is read."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError, field_validator, model_validator

from granstudy.study.schema.experiment import Experiment
from granstudy.study.schema.generated import Section
from granstudy.study.schema.mistakes import explain
from granstudy.study.schema.names import check_experiment_names, check_study_name
from granstudy.study.schema.reading import read_yaml
from granstudy.study.schema.values import shown


class MapModel(Section):
    """A table and a figure of all experiments that have a truth: errors and labels."""

    title: str


class StudyFile(Section):
    """A study: titled experiments, each swept over its parameters."""

    title: str
    experiments: Annotated[dict[str, Experiment], Field(min_length=1)]
    map: MapModel | None = None

    @field_validator("experiments", mode="before")
    @classmethod
    def _are_names(cls, experiments: Any) -> Any:
        if isinstance(experiments, dict):
            check_experiment_names(experiments)
        return experiments

    @model_validator(mode="after")
    def _fits_together(self) -> "StudyFile":
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
    content = read_yaml(path)
    check_study_name(path)
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
    if not isinstance(content, dict):
        what = "is empty" if content is None else f"holds {shown(content)}"
        raise ValueError(
            f"{source}: {what}; a study has the fields {', '.join(StudyFile.model_fields)}"
        )
    try:
        return StudyFile.model_validate(content)
    except ValidationError as error:
        lines = [f"{source}: {line}" for line in explain(error, StudyFile)]
        raise ValueError("\n".join(lines)) from None
