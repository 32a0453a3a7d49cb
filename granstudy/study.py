"""Study files: which scene, and which e, N, M_sph, variant, ... to sweep; from file to list of runs."""

import itertools
import json
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal
from urllib.parse import quote

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from granstudy.collision import carleman_scenes
from granstudy.collision.rules import directions
from granstudy.cost import Cost, estimate
from granstudy.errors import nearest
from granstudy.evolve import step_count
from granstudy.isotropy import check_isotropic
from granstudy.kernel import VHS, Viscoelastic, check_restitution, sphere_area
from granstudy.scene import Scene, load_scene
from granstudy.solver import Solver

SWEPT = (
    "e",
    "exponent",
    "epsilon",
    "N",
    "R",
    "N_rho",
    "M_sph",
    "M_cir",
    "rtol",
    "variant",
    "method",
    "sphere_rule",
    "radial_rule",
    "dt",
)
"""What a study can sweep, in the order of a run's path."""

SHARED_WITH_REFERENCE = ("e", "exponent", "epsilon", "N", "R", "N_rho")
"""What a collision run's reference takes over from the run: all but the rule on the sphere."""

Value = bool | int | float | str | list[int] | None


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class ViscoelasticModel(_Model):
    """Restitution of viscoelastic spheres (`granstudy.Viscoelastic`)."""

    viscoelastic: Annotated[float, Field(description="the material constant A")]


class SceneModel(_Model):
    """What is modelled: a named scene, and what of it is set otherwise."""

    name: Annotated[str, Field(description="bkw2d, bkw3d, double_well2d, double_well3d, ...")]
    restitution: float | ViscoelasticModel | None = None
    exponent: Annotated[float | None, Field(description="λ of the kernel, 0 to 1")] = None
    strength: Annotated[float | None, Field(description="C_λ; default 1/(2π), 1/(4π)")] = None
    epsilon: Annotated[float | None, Field(description="diffusion ε; default 1e-6")] = None
    temperature: Annotated[float | None, Field(description="of a maxwellian scene")] = None
    velocity: Annotated[list[float] | None, Field(description="of a maxwellian scene")] = None


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


class TimeModel(_Model):
    """How long, in which steps."""

    t_final: float
    dt: Annotated[float | None, Field(description="the step, where it is not swept")] = None
    save_every: Annotated[int | None, Field(description="keep the density every so many steps")] = (
        None
    )


class TableModel(_Model):
    """Which number of every run goes into the table."""

    quantity: Annotated[
        str,
        Field(
            description="a variable of the runs, at its last time; for collisions 'collision_error'"
        ),
    ]
    paper: Annotated[str | None, Field(description="reference file of printed values")] = None


class FitModel(_Model):
    """What is fitted to the runs."""

    law: Literal["order", "haff"]
    x: Annotated[str | None, Field(description="for an order: the refined parameter")] = None


class FigureModel(_Model):
    """What is drawn: a quantity against a swept parameter, or temperature against time."""

    kind: Literal["convergence", "cooling", "speed"]
    x: Annotated[str | None, Field(description="the parameter on the abscissa")] = None


class Experiment(_Model):
    """Runs of one kind: a scene and a solver, swept."""

    title: str
    run: Literal["evolution", "collision", "benchmark"]
    scene: SceneModel
    solver: SolverModel = SolverModel()
    time: TimeModel | None = None
    reference: Annotated[
        SolverModel | None,
        Field(description="for collisions: the solver that errors are measured against"),
    ] = None
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
        if (self.run == "collision") != (self.reference is not None):
            raise ValueError("reference: collision runs need it, others do not take it")
        keys = [tuple(k for k in SWEPT if k in block) for block in self.sweep]
        for block in self.sweep:
            for key in block:
                if key not in SWEPT:
                    raise ValueError(
                        f"sweep: unknown parameter {key!r}{nearest(key, SWEPT)}: "
                        f"allowed are {', '.join(SWEPT)}"
                    )
        if len(set(keys)) > 1:
            raise ValueError(f"sweep: all blocks must set the same parameters, got {keys}")
        return self


class StudyFile(_Model):
    """A study: titled experiments, each swept over its parameters."""

    title: str
    experiments: Annotated[dict[str, Experiment], Field(min_length=1)]


@dataclass(frozen=True)
class Run:
    """One run of a study: its experiment and the values of its swept parameters."""

    experiment: str
    model: Experiment
    values: tuple[tuple[str, Any], ...]
    is_reference: bool = False

    @property
    def path(self) -> str:
        """Canonical name of the point, ``e~0.2/N~16/variant~full``; ``reference/..`` of one."""
        parts = [f"{key}~{canonical(value)}" for key, value in self.values]
        return "/".join(["reference", *parts] if self.is_reference else parts)

    @cached_property
    def reference(self) -> "Run":
        """The run that this collision run's error is measured against."""
        shared = tuple(pair for pair in self.values if pair[0] in SHARED_WITH_REFERENCE)
        return Run(self.experiment, self.model, shared, is_reference=True)

    def _value(self, key: str, default: Any) -> Any:
        return dict(self.values).get(key, default)

    @cached_property
    def scene(self) -> Scene:
        """The scene with this run's swept values."""
        model = self.model.scene
        base = load_scene(
            model.name,
            **{
                key: value
                for key, value in (("temperature", model.temperature), ("velocity", model.velocity))
                if value is not None
            },
        )
        exponent = self._value("exponent", model.exponent)
        strength = 1.0 / sphere_area(base.dim) if model.strength is None else model.strength
        restitution: Any = self._value("e", model.restitution)
        if restitution is None:
            raise ValueError("e: set scene.restitution or sweep e")
        if isinstance(restitution, ViscoelasticModel):
            restitution = Viscoelastic(restitution.viscoelastic)
        epsilon = self._value("epsilon", model.epsilon)
        return Scene(
            dim=base.dim,
            initial=base.initial,
            kernel=VHS(0.0 if exponent is None else exponent, strength),
            restitution=restitution,
            diffusion=base.diffusion if epsilon is None else epsilon,
        )

    @cached_property
    def solver(self) -> Solver:
        """The solver with this run's swept values."""
        settings = self.model.solver.model_dump(exclude_none=True)
        fields = set(SolverModel.model_fields)
        settings |= {key: value for key, value in self.values if key in fields}
        if self.is_reference:
            assert self.model.reference is not None
            settings.pop("rtol", None)
            settings |= self.model.reference.model_dump(exclude_none=True)
        for needed in ("N", "R"):
            if needed not in settings:
                raise ValueError(f"{needed}: set solver.{needed} or sweep {needed}")
        if isinstance(settings.get("M_sph"), list):
            settings["M_sph"] = tuple(settings["M_sph"])
        return Solver(**settings)

    @property
    def dt(self) -> float | None:
        """The time step, None where nothing evolves."""
        if self.model.time is None:
            return None
        dt = self._value("dt", self.model.time.dt)
        if dt is None:
            raise ValueError("dt: set time.dt or sweep dt")
        return float(dt)

    @property
    def evaluations(self) -> int:
        """Evaluations of Q that the run makes: three a step of the Runge–Kutta scheme."""
        if self.model.time is None:
            return 1
        assert self.dt is not None
        return 3 * step_count(self.model.time.t_final, self.dt)

    @cached_property
    def cost(self) -> Cost:
        """Estimated seconds and memory of the run."""
        return estimate(self.scene, self.solver, self.evaluations)

    def check(self) -> None:
        """Raise ValueError for anything that would stop the run later."""
        check_restitution(self.scene.restitution, self.solver.R)
        radial = self.solver.method == "radial"
        if radial:
            check_isotropic(self.scene, self.solver.R)
        elif self.solver.rtol is None:
            directions(self.scene, self.solver)
        if self.solver.method == "carleman":
            carleman_scenes.check_scene(self.scene)
        if self.model.reference is not None and not self.is_reference:
            other = self.reference.solver.method
            if radial != (other == "radial"):
                raise ValueError(
                    f"method {self.solver.method!r}: has other velocity nodes than its reference's "
                    f"method {other!r}; a collision run and its reference must share them"
                )
        _ = self.evaluations  # t_final must be a whole number of steps

    def parameters(self) -> str:
        """All that the run depends on, as canonical JSON."""
        time = self.model.time
        return json.dumps(
            {
                "run": self.model.run,
                "scene": self.scene.describe(),
                "solver": self.solver.describe(),
                "time": None if time is None else {**time.model_dump(), "dt": self.dt},
            },
            sort_keys=True,
        )


@dataclass(frozen=True)
class Study:
    """A checked study file; ``runs`` by experiment, then by path, references among them."""

    name: str
    model: StudyFile
    runs: dict[str, dict[str, Run]]

    def run(self, experiment: str, path: str) -> Run:
        """The run of that name, or ValueError where the study has none."""
        try:
            return self.runs[experiment][path]
        except KeyError:
            raise ValueError(
                f"study {self.name!r} has no run {experiment}/{path}: add its value to a sweep list"
            ) from None


def load_study(path: str | Path) -> Study:
    """Read a study file and check every run in it.

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
        model = StudyFile.model_validate(content)
    except ValidationError as error:
        lines = [f"{path}: {_explain(problem)}" for problem in error.errors()]
        raise ValueError("\n".join(lines)) from None
    runs: dict[str, dict[str, Run]] = {}
    for name, experiment in model.experiments.items():
        runs[name] = {}
        for run in _expand(name, experiment):
            try:
                run.check()
            except ValueError as error:
                where = f"experiments.{name}, run {run.path}"
                raise ValueError(f"{path}: {where}: {error}") from None
            runs[name][run.path] = run
    return Study(path.stem, model, runs)


def canonical(value: Any) -> str:
    """A value as it stands in a path: decimal, without trailing zeros; 2x3 for a pair."""
    if isinstance(value, list):
        return "x".join(map(canonical, value))
    if isinstance(value, float):
        plain = Decimal(repr(value)).normalize()
        return format(plain, "f")
    return quote(str(value), safe="")


def _expand(name: str, experiment: Experiment) -> list[Run]:
    runs = []
    for block in experiment.sweep:
        keys = [key for key in SWEPT if key in block]
        lists = [_as_list(key, block[key]) for key in keys]
        for values in itertools.product(*lists):
            run = Run(name, experiment, tuple(zip(keys, values, strict=True)))
            runs.append(run)
            if experiment.reference is not None:
                runs.append(run.reference)
    return runs


def _as_list(key: str, value: Any) -> list[Any]:
    """The values of one sweep entry; whole numbers of real parameters become real."""
    values = value if isinstance(value, list) else [value]
    real = key in ("e", "exponent", "epsilon", "R", "rtol", "dt")
    return [float(v) if real and type(v) is int else v for v in values]


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
        "scene": SceneModel,
        "solver": SolverModel,
        "time": TimeModel,
        "table": TableModel,
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
