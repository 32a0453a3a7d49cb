"""One experiment of a study file: runs of one kind, swept."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from granstudy.datasets.parameters import SWEPT
from granstudy.study.schema.sections import (
    SceneFields,
    SceneModel,
    Section,
    SolverModel,
    TimeFields,
    TimeModel,
    Value,
)
from granstudy.support.errors import nearest


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
    rounds: Annotated[int, Field(ge=1, description="turns that every run gets at least")] = 3
    radial_nodes: Annotated[
        int,
        Field(description="N of the radial run that errors of radial runs are measured against"),
    ] = 96


class AverageModel(Section):
    """Moments of particles averaged over time, once a gas no longer changes but for its scale."""

    start: Annotated[float, Field(ge=0.0, description="time from which on")]
    of: Annotated[list[str], Field(min_length=1, description="temperature, a2")] = ["a2"]


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


class FitModel(Section):
    """What is fitted to the runs."""

    law: Literal["order", "haff", "growth", "slope"]
    x: Annotated[str | None, Field(description="for an order: the refined parameter")] = None


class FigureModel(Section):
    """What is drawn: a quantity against a swept parameter or time, a front, or runs beside the truth."""

    kind: Literal["convergence", "cooling", "speed", "front", "slope", "states", "gallery"]
    x: Annotated[str | None, Field(description="the parameter on the abscissa")] = None
    title: Annotated[str | None, Field(description="default: the experiment's")] = None
    beside: Annotated[
        list[str],
        Field(description="for a front or states: other experiments, panels beside this one's"),
    ] = []


class Experiment(Section):
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
