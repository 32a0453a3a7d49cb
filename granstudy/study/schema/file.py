"""Study files: the typed model of their YAML, and how one is read."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError, field_validator, model_validator

from granstudy.study.schema.experiment import Experiment, StateExperiment
from granstudy.study.schema.generated import Section
from granstudy.study.schema.mistakes import explain
from granstudy.study.schema.names import check_experiment_names, check_study_name
from granstudy.study.schema.reading import read_yaml
from granstudy.study.schema.values import shown

ATLAS_OVER = ("e", "exponent")
"""What the states of an atlas sweep."""


class MapModel(Section):
    """A table and a figure of all experiments that have a truth: errors and labels."""

    title: str


class AtlasModel(Section):
    """One dataset of all states to an accuracy, over e, λ, the dimension and the state, and its maps."""

    title: str


class StudyFile(Section):
    """A study: titled experiments, each swept over its parameters."""

    title: str
    experiments: Annotated[dict[str, Experiment], Field(min_length=1)]
    map: MapModel | None = None
    atlas: AtlasModel | None = None

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
        if self.atlas is not None:
            self._check_atlas()
        return self

    def _check_atlas(self) -> None:
        """Raise ValueError unless there are states to an accuracy, each swept over e and λ alone."""
        if not self.with_states:
            raise ValueError(
                "atlas: shows experiments of states with an accuracy, and there is none"
            )
        for name in self.with_states:
            for block in self.experiments[name].sweep:
                if set(block) != set(ATLAS_OVER):
                    raise ValueError(
                        f"atlas: experiment {name} sweeps {', '.join(block)}; states of an atlas sweep "
                        f"{' and '.join(ATLAS_OVER)}, and nothing else"
                    )

    @property
    def with_truth(self) -> list[str]:
        """Names of the experiments whose runs are held against a truth."""
        return [name for name, experiment in self.experiments.items() if experiment.has_truth]

    @property
    def with_states(self) -> list[str]:
        """Names of the experiments whose runs are states to an accuracy."""
        return [
            name
            for name, experiment in self.experiments.items()
            if isinstance(experiment, StateExperiment) and experiment.accuracy is not None
        ]


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
