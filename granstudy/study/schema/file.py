"""Study files: the typed model of their YAML, and one clear line for each thing wrong in one."""

import json
import math
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from granstudy.support.errors import nearest

SWEPT = (
    "e",
    "exponent",
    "epsilon",
    "symmetry",
    "N",
    "R",
    "N_rho",
    "M_sph",
    "M_cir",
    "rtol",
    "particles",
    "batches",
    "seed",
    "variant",
    "method",
    "sphere_rule",
    "radial_rule",
    "dealias",
    "precision",
    "device",
    "frame",
    "scheme",
    "conserve",
    "time_rtol",
    "dt",
)
"""What a study can sweep, in the order of a run's path."""

Value = bool | int | float | str | list[int] | None


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class ViscoelasticModel(_Model):
    """Restitution of viscoelastic spheres (`granstudy.Viscoelastic`)."""

    viscoelastic: Annotated[float, Field(description="the material constant A")]


class SceneFields(_Model):
    """What can be set of a named scene."""

    restitution: float | ViscoelasticModel | None = None
    exponent: Annotated[float | None, Field(description="λ of the kernel, 0 to 1")] = None
    strength: Annotated[float | None, Field(description="C_λ; default 1/(2π), 1/(4π)")] = None
    epsilon: Annotated[float | None, Field(description="diffusion ε; default 1e-6")] = None
    temperature: Annotated[
        float | None,
        Field(description="of maxwellian, uniform_ball, power_law; of each of two_beams"),
    ] = None
    velocity: Annotated[list[float] | None, Field(description="of a maxwellian scene")] = None
    separation: Annotated[float | None, Field(description="of two_beams")] = None
    tail: Annotated[float | None, Field(description="s of power_law's |v|^-s, above d + 4")] = None
    symmetry: Annotated[
        str | None, Field(description="none, inversion, ...; default: what the density declares")
    ] = None


class SceneModel(SceneFields):
    """What is modelled: a named scene, and what of it is set otherwise."""

    name: Annotated[str, Field(description="bkw2d, bkw3d, double_well2d, double_well3d, ...")]


class SolverModel(_Model):
    """How well: any field of `granstudy.Solver` that is not swept."""

    N: int | None = None
    R: float | None = None
    N_rho: int | None = None
    M_sph: int | list[int] | None = None
    M_cir: int | None = None
    variant: str | None = None
    method: str | None = None
    sphere_rule: str | None = None
    radial_rule: str | None = None
    rtol: Annotated[
        float | None,
        Field(description="tolerance of Q's quadrature error, in place of N_rho, M_.."),
    ] = None
    circular: bool | None = None
    particles: Annotated[int | None, Field(description="of method dsmc, all batches together")] = (
        None
    )
    batches: Annotated[int | None, Field(description="of method dsmc; default 20")] = None
    seed: Annotated[int | None, Field(description="of method dsmc; default 0")] = None
    dealias: Annotated[bool | None, Field(description="pad the products of fast")] = None
    precision: Annotated[str | None, Field(description="double, or single for fast")] = None
    device: Annotated[str | None, Field(description="cpu or gpu; default: cpu")] = None


class TimesModel(_Model):
    """Output times, spaced evenly in their logarithm."""

    first: Annotated[float, Field(gt=0.0, description="time of the first")]
    last: Annotated[float | None, Field(gt=0.0, description="of the last; default t_final")] = None
    per_decade: Annotated[int, Field(ge=1, description="how many a decade")] = 10

    def outputs(self, t_final: float) -> list[float]:
        """The times themselves."""
        last = t_final if self.last is None else self.last
        count = 1 + round(self.per_decade * math.log10(last / self.first))
        return np.geomspace(self.first, last, max(count, 1)).tolist()


class TimeFields(_Model):
    """In which steps and frame a run goes through time (`granstudy.simulate`)."""

    dt: Annotated[float | None, Field(description="the step, where it is not swept")] = None
    time_rtol: Annotated[
        float | None, Field(description="in place of dt: tolerance of a step's error")
    ] = None
    times: Annotated[
        list[float] | TimesModel | None, Field(description="outputs, with time_rtol")
    ] = None
    frame: Annotated[str | None, Field(description="fixed or rescaled; default fixed")] = None
    scheme: Annotated[
        str | None,
        Field(description="rk3, dopri54 or exponential; default rk3 with dt, else dopri54"),
    ] = None
    conserve: Annotated[
        str | None,
        Field(description="none, mass, mass-momentum or mass-momentum-energy; default none"),
    ] = None
    save_every: Annotated[
        int | None, Field(description="keep the density every so many outputs")
    ] = None


class TimeModel(TimeFields):
    """The same, and how long."""

    t_final: float


class TruthModel(_Model):
    """What the runs of an evolution are held against: an exact law, or a run that is told to be better."""

    law: Annotated[
        Literal["maxwell"] | None,
        Field(description="exact T and a2 of Maxwell molecules, from the density's own moments"),
    ] = None
    solver: Annotated[
        SolverModel | None, Field(description="the whole solver of a run, in place of a law")
    ] = None
    scene: Annotated[
        SceneFields,
        Field(description="what that run's scene has otherwise; its T and a2 must agree"),
    ] = SceneFields()
    time: Annotated[TimeFields, Field(description="what that run's time has otherwise")] = (
        TimeFields()
    )

    @model_validator(mode="after")
    def _law_or_run(self) -> "TruthModel":
        if (self.law is None) == (self.solver is None):
            raise ValueError("law, solver: give one, an exact law or the solver of a run")
        if self.law is not None and (self.scene.model_fields_set or self.time.model_fields_set):
            raise ValueError("law: takes no scene and no time")
        return self


class TimingModel(_Model):
    """How a benchmark times its runs."""

    baseline: Annotated[
        dict[str, Value] | None,
        Field(
            description="parameters of the one run that speedups are taken over; default: literal "
            "at the same N"
        ),
    ] = None
    single_thread: Annotated[bool, Field(description="time with one thread, too")] = True
    memory: Annotated[bool, Field(description="measure the peak memory, too")] = True
    rounds: Annotated[int, Field(ge=1, description="turns that every run gets at least")] = 3
    radial_nodes: Annotated[
        int,
        Field(description="N of the radial run that errors of radial runs are measured against"),
    ] = 96


class AverageModel(_Model):
    """Moments of particles averaged over time, once a gas no longer changes but for its scale."""

    start: Annotated[float, Field(ge=0.0, description="time from which on")]
    of: Annotated[list[str], Field(min_length=1, description="temperature, a2")] = ["a2"]


class TableModel(_Model):
    """Which number of every run goes into the table."""

    quantity: Annotated[
        str,
        Field(
            description="a variable of the runs, at its last time; for collisions "
            "'collision_error', for benchmarks 'seconds' or 'error'"
        ),
    ]
    paper: Annotated[str | None, Field(description="reference file of printed values")] = None
    average: Annotated[
        AverageModel | None,
        Field(description="of method dsmc: averages over time in place of values at its end"),
    ] = None
    beside: Annotated[
        list[str],
        Field(description="for states: other experiments, whose a2 (and T) stand beside theirs"),
    ] = []
    seconds: Annotated[
        bool, Field(description="beside a truth: how long every run took, which a front needs")
    ] = False


class FitModel(_Model):
    """What is fitted to the runs."""

    law: Literal["order", "haff", "growth", "slope"]
    x: Annotated[str | None, Field(description="for an order: the refined parameter")] = None


class FigureModel(_Model):
    """What is drawn: a quantity against a swept parameter or time, a front, or runs beside the truth."""

    kind: Literal["convergence", "cooling", "speed", "front", "slope", "states", "gallery"]
    x: Annotated[str | None, Field(description="the parameter on the abscissa")] = None
    title: Annotated[str | None, Field(description="default: the experiment's")] = None
    beside: Annotated[
        list[str],
        Field(description="for a front or states: other experiments, panels beside this one's"),
    ] = []


class Experiment(_Model):
    """Runs of one kind: a scene and a solver, swept."""

    title: str
    run: Literal["evolution", "collision", "benchmark", "state"]
    state: Annotated[
        Literal["cooling", "heated"] | None, Field(description="which state; state runs need it")
    ] = None
    scene: SceneModel
    solver: SolverModel = SolverModel()
    time: TimeModel | None = None
    reference: Annotated[
        SolverModel | None,
        Field(
            description="the solver that errors are measured against; collisions need it, "
            "benchmarks may have it"
        ),
    ] = None
    truth: Annotated[
        TruthModel | None,
        Field(description="what T and a2 of an evolution's runs are held against"),
    ] = None
    timing: TimingModel | None = None
    threads: Annotated[int, Field(ge=1, description="cores a run takes")] = 1
    sweep: Annotated[
        list[dict[str, Value | list[Value]]],
        Field(min_length=1, description="blocks; each the product of its lists"),
    ]
    table: TableModel | None = None
    fit: FitModel | None = None
    figure: FigureModel | None = None

    @model_validator(mode="after")
    def _fits_together(self) -> "Experiment":
        if (self.run == "evolution") != (self.time is not None):
            raise ValueError("time: evolution runs need it, others do not take it")
        if (self.run == "state") != (self.state is not None):
            raise ValueError("state: state runs need it, cooling or heated; others do not take it")
        if self.run != "benchmark" and (self.run == "collision") != (self.reference is not None):
            raise ValueError(
                "reference: collision runs need it, evolution and state runs do not take it"
            )
        if self.truth is not None and self.run != "evolution":
            raise ValueError("truth: only evolution runs take it")
        if self.table is not None and self.table.seconds and self.truth is None:
            raise ValueError("table.seconds: stands beside errors of runs with a truth; give one")
        if self.figure is not None and self.figure.kind == "gallery" and self.truth is None:
            raise ValueError("figure.kind: a gallery shows runs beside their truth; give one")
        if self.timing is not None and self.run != "benchmark":
            raise ValueError("timing: only benchmarks take it")
        if self.table is not None and self.table.beside and self.run != "state":
            raise ValueError("table.beside: only state runs take it")
        if self.table is not None and self.table.average and self.run != "evolution":
            raise ValueError("table.average: only evolution runs take it")
        return self

    @model_validator(mode="after")
    def _sweeps_parameters(self) -> "Experiment":
        keys = [tuple(k for k in SWEPT if k in block) for block in self.sweep]
        for block in self.sweep:
            for key in block:
                if key not in SWEPT:
                    raise ValueError(
                        f"sweep: unknown parameter {key!r}{nearest(key, SWEPT)}: "
                        f"allowed are {', '.join(SWEPT)}"
                    )
                if self.time is None and key in TimeModel.model_fields:
                    raise ValueError(f"sweep: {key!r} is of times, which only evolution runs have")
        if len(set(keys)) > 1 and self.run != "benchmark":
            raise ValueError(f"sweep: all blocks must set the same parameters, got {keys}")
        return self


class MapModel(_Model):
    """A table and a figure of all experiments that have a truth: errors and labels."""

    title: str


MAP = "map"
"""What the files of a study's map are called; no experiment can have that name."""


class StudyFile(_Model):
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
