"""Study files: the typed model of their YAML, and one clear line for each thing wrong in one."""

import json
from pathlib import Path
from typing import Annotated, Any

import yaml
from pydantic import BaseModel, Field, ValidationError, model_validator

from granstudy.study.schema.experiment import (
    AverageModel,
    Experiment,
    FigureModel,
    FitModel,
    TableModel,
    TimingModel,
    TruthModel,
)
from granstudy.study.schema.sections import (
    SceneModel,
    Section,
    SolverModel,
    TimeModel,
    TimesModel,
    ViscoelasticModel,
)
from granstudy.support.errors import nearest


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
        return [name for name, model in self.experiments.items() if model.truth is not None]


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
    try:
        return StudyFile.model_validate(content)
    except ValidationError as error:
        lines = [f"{path}: {_explain(problem)}" for problem in error.errors()]
        raise ValueError("\n".join(lines)) from None


def _explain(problem: Any) -> str:
    """One line for one of pydantic's errors."""
    where = ".".join(str(part) for part in problem["loc"] if "Model" not in str(part))
    value = problem["input"]
    if problem["type"] == "extra_forbidden":
        known = _known_fields(problem["loc"])
        key = str(problem["loc"][-1])
        return f"{where}: unknown field{nearest(key, known)}; allowed are {', '.join(known)}"
    if problem["type"] == "missing":
        return f"{where}: must be given"
    message = problem["msg"].removeprefix("Value error, ")
    hint = ""
    if isinstance(value, str) and problem["type"].startswith(("float", "int")):
        try:
            float(value)
            hint = " (YAML reads 1e-3 as text: write 1.0e-3)"
        except ValueError:
            pass
    shown = "" if isinstance(value, dict) else f"value {value!r}: "
    return f"{where}: {shown}{message}{hint}"


def _known_fields(location: tuple[Any, ...]) -> list[str]:
    """Fields allowed where an unknown one was found."""
    if len(location) == 1:
        return list(StudyFile.model_fields)
    parts: dict[str, type[BaseModel]] = {
        "map": MapModel,
        "truth": TruthModel,
        "scene": SceneModel,
        "solver": SolverModel,
        "time": TimeModel,
        "times": TimesModel,
        "timing": TimingModel,
        "table": TableModel,
        "average": AverageModel,
        "fit": FitModel,
        "figure": FigureModel,
        "restitution": ViscoelasticModel,
    }
    for part in reversed(location[:-1]):
        if part in parts:
            return list(parts[str(part)].model_fields)
    return list(Experiment.model_fields)


def write_schema(path: str | Path) -> None:
    """Write the JSON schema of study files, for editors that complete and check YAML."""
    schema = json.dumps(StudyFile.model_json_schema(), indent=1, ensure_ascii=False)
    Path(path).write_text(schema + "\n")


if __name__ == "__main__":
    write_schema("workflow/config/study.schema.json")
