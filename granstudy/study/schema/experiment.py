"""One experiment of a study file: runs of one kind, swept. A class a kind, told apart by ``run``."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from granstudy.study.schema.generated import OLD_WORDS, Section
from granstudy.study.schema.sections import (
    AccuracyModel,
    RangeModel,
    RefineModel,
    SceneFields,
    SceneModel,
    SolverModel,
    TimeFields,
    TimeModel,
    Value,
)
from granstudy.study.schema.sweeps import read_sweep, values_of
from granstudy.study.schema.words import SWEPT
from granstudy.support.errors import nearest
from granstudy.support.own_code.load import is_reference

SEED = "seed"
"""The one parameter of random runs."""


class TruthModel(Section):
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


class TimingModel(Section):
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
    rounds: Annotated[
        int, Field(ge=1, le=10_000, description="turns that every run gets at least")
    ] = 3
    radial_nodes: Annotated[
        int,
        Field(description="N of the radial run that errors of radial runs are measured against"),
    ] = 96


class AverageModel(Section):
    """Moments of particles averaged over time, once the gas changes in scale alone."""

    start: Annotated[float, Field(ge=0.0, description="time from which on")]
    of: list[str] = Field(["a2"], min_length=1, description="temperature, a2")


class TableModel(Section):
    """Which number of every run goes into the table."""

    quantity: Annotated[
        str,
        Field(
            description="a variable of the runs, at its last time; for collisions "
            "'collision_error', for benchmarks 'seconds' or 'error'"
        ),
    ]
    paper: Annotated[str | None, Field(description="reference file of printed values")] = None


class EvolutionTableModel(TableModel):
    """Which number of every evolution goes into the table."""

    average: Annotated[
        AverageModel | None,
        Field(description="of method dsmc: averages over time in place of values at its end"),
    ] = None
    seconds: Annotated[
        bool, Field(description="beside a truth: how long every run took, which a front needs")
    ] = False


class StateTableModel(TableModel):
    """Which number of every state goes into the table, and what stands beside it."""

    beside: list[str] = Field(
        [], description="other experiments, whose a2 (and T) stand beside those of the states"
    )


class FitModel(Section):
    """What is fitted to the runs; the laws are those of `granstudy.analysis.tables.fits.FITS`."""

    law: str
    x: Annotated[str | None, Field(description="for an order: the refined parameter")] = None


class FigureModel(Section):
    """What is drawn; the kinds are those of `granstudy.analysis.figures.figure.FIGURES`."""

    kind: str
    x: Annotated[
        str | None,
        Field(description="the parameter on the abscissa; for a quantity also time, its default"),
    ] = None
    y: Annotated[str | None, Field(description="for a map: the parameter on the ordinate")] = None
    quantity: Annotated[
        str | None,
        Field(description="for a quantity or a map: any number of the runs; default: the table's"),
    ] = None
    title: Annotated[str | None, Field(description="default: the experiment's")] = None
    beside: list[str] = Field(
        [], description="for a front or states: other experiments, panels beside this one's"
    )


class SweptExperiment(Section):
    """What experiments of every kind have: a title, a sweep, and what is made of the runs."""

    title: str
    run: str
    threads: Annotated[int, Field(ge=1, description="cores a run takes")] = 1
    sweep: Annotated[
        list[dict[str, RangeModel | Value | list[Value]]],
        Field(min_length=1, description="blocks; each the product of its lists and ranges"),
        BeforeValidator(read_sweep),
    ]
    table: TableModel | None = None
    fit: FitModel | None = None
    figure: FigureModel | None = None

    @property
    def has_truth(self) -> bool:
        """Whether its runs are held against a truth."""
        return False

    @property
    def same_parameters(self) -> bool:
        """Whether all blocks of the sweep must set the same parameters.

        Runs beside a truth, and runs that are timed, are compared by what comes out. Each of their blocks may
        say what it needs, one an accuracy, another N and R.
        """
        return not self.has_truth

    @property
    def computes(self) -> str:
        """What a run computes, in words."""
        return self.run

    @property
    def beside_table(self) -> list[str]:
        """Other experiments whose numbers stand in this one's table."""
        return []

    @property
    def beside_figure(self) -> list[str]:
        """Other experiments that this one's figure shows."""
        return [] if self.figure is None else self.figure.beside

    @model_validator(mode="after")
    def _sweeps_parameters(self) -> "SweptExperiment":
        keys = [tuple(sorted(block)) for block in self.sweep]
        for block in self.sweep:
            for key in block:
                self._check_swept(key)
        if len(set(keys)) > 1 and self.same_parameters:
            raise ValueError(
                "sweep: all blocks must set the same parameters, except those of runs with a truth or of a "
                f"benchmark; got {keys}"
            )
        return self

    def _check_swept(self, key: str) -> None:
        """Raise ValueError for a word that such runs do not sweep; here every word is good."""


class ExperimentBase(SweptExperiment):
    """What experiments have whose runs the study file spells out: a scene and a solver."""

    scene: SceneModel
    solver: SolverModel = SolverModel()
    accuracy: Annotated[
        float | AccuracyModel | None,
        Field(description="in place of a solver: accuracy of T, or of temperature and a2"),
    ] = None

    @property
    def solver_words(self) -> dict[str, Any]:
        """What the experiment says of its solver; an accuracy is one."""
        words = self.solver.model_dump(exclude_none=True)
        if isinstance(self.accuracy, AccuracyModel):
            return words | self.accuracy.words
        return words if self.accuracy is None else words | {"accuracy": self.accuracy}

    def _check_swept(self, key: str) -> None:
        if key not in SWEPT and not self._has_own_code:
            allowed = [name for name in SWEPT if self._takes(name)]
            raise ValueError(
                f"sweep: unknown parameter {key!r}{nearest(key, [*allowed, *OLD_WORDS])}: allowed are "
                f"{', '.join(allowed)}"
            )
        if not self._takes(key):
            raise ValueError(f"sweep: {key!r} is of times, which only evolution runs have")

    def _takes(self, key: str) -> bool:
        """Whether runs of the kind have a parameter."""
        return key not in TimeModel.model_fields or "time" in type(self).model_fields

    @property
    def _has_own_code(self) -> bool:
        """Whether some run's density or law is a function of the user, whose arguments can be swept."""
        swept = [
            value
            for block in self.sweep
            for key in ("scene", "restitution")
            for value in (values_of(block[key]) if key in block else [])
        ]
        return self.scene.has_own_code or any(map(is_reference, swept))


class EvolutionExperiment(ExperimentBase):
    """Runs that advance the scene's density through time."""

    run: Literal["evolution"]
    time: TimeModel
    refine: Annotated[
        RefineModel | None, Field(description="a ladder of grids that every run goes up")
    ] = None
    truth: Annotated[
        TruthModel | None,
        Field(description="what T and a2 of the runs are held against"),
    ] = None
    table: EvolutionTableModel | None = None

    @property
    def has_truth(self) -> bool:
        """Whether its runs are held against a truth."""
        return self.truth is not None

    @model_validator(mode="after")
    def _times_beside_a_truth(self) -> "EvolutionExperiment":
        if self.table is not None and self.table.seconds and self.truth is None:
            raise ValueError("table.seconds: stands beside errors of runs with a truth; give one")
        return self


class CollisionExperiment(ExperimentBase):
    """Runs that evaluate Q once, on the scene's initial density."""

    run: Literal["collision"]
    reference: Annotated[
        SolverModel, Field(description="the solver that errors are measured against")
    ]


class BenchmarkExperiment(ExperimentBase):
    """Evaluations of Q that are timed in turn."""

    run: Literal["benchmark"]
    reference: Annotated[
        SolverModel | None, Field(description="the solver that errors are measured against")
    ] = None
    timing: TimingModel = TimingModel()

    @property
    def same_parameters(self) -> bool:
        """Each block says what its runs need."""
        return False


class StateExperiment(ExperimentBase):
    """Runs that solve for the state that the gas approaches."""

    run: Literal["state"]
    state: Annotated[Literal["cooling", "heated"], Field(description="which state")]
    refine: Annotated[
        RefineModel | None, Field(description="a ladder of grids that every run goes up")
    ] = None
    table: StateTableModel | None = None

    @property
    def computes(self) -> str:
        """What a run computes, in words."""
        return f"{self.state} state"

    @property
    def beside_table(self) -> list[str]:
        """Other experiments whose numbers stand in this one's table."""
        return [] if self.table is None else self.table.beside


class LabelsExperiment(SweptExperiment):
    """Random runs beside their truths, each drawn by its seed (`granstudy.runs.labels.cases`)."""

    run: Literal["labels"]

    @model_validator(mode="after")
    def _has_a_table_alone(self) -> "LabelsExperiment":
        for field in ("fit", "figure"):
            if getattr(self, field) is not None:
                raise ValueError(f"{field}: random runs have a table alone; leave {field} out")
        return self

    def _check_swept(self, key: str) -> None:
        if key != SEED:
            raise ValueError(f"sweep: {key!r}: random runs sweep {SEED} alone")


Experiment = Annotated[
    EvolutionExperiment
    | CollisionExperiment
    | BenchmarkExperiment
    | StateExperiment
    | LabelsExperiment,
    Field(discriminator="run"),
]
"""Runs of one kind, swept."""
