"""One run of a study: its values, its canonical name, and the scene, solver and times that they come to."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from pathlib import Path
from typing import Any
from urllib.parse import quote

from granstudy.accuracy.asked import CHOSEN
from granstudy.evolution.times import TimeSettings
from granstudy.model.load_scene import load_scene
from granstudy.model.methods import ACCURACIES, METHODS, PARTICLES
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation
from granstudy.runs.labels.cases import Case, random_case
from granstudy.study.schema.experiment import (
    BenchmarkExperiment,
    CollisionExperiment,
    EvolutionExperiment,
    Experiment,
    LabelsExperiment,
    TimingModel,
)
from granstudy.study.schema.generated import Section
from granstudy.study.schema.sections import SolverModel, TimeModel, TimesModel
from granstudy.study.schema.words import COORDINATES, place
from granstudy.support.own_code.load import is_reference

SHARED_WITH_REFERENCE = ("N", "R", "N_rho")
"""What a run's reference takes over from its solver: all but the rule on the sphere."""

SHARED_WITH_TRUTH = ("t_final",)
"""What a run's truth takes over from its times."""

NOT_SHARED = ("rtol", "precision", "device")
"""Settings of an experiment's solver that its reference does not take over; it says its own."""


@dataclass(frozen=True)
class Run:
    """One run of a study: its experiment and the values of its swept parameters.

    Attributes
    ----------
    experiment : str
        The experiment's name.
    model : Experiment
        What the study file says of it.
    values : tuple of (str, value)
        The swept parameters, in the order of `granstudy.study.schema.words.SWEPT`; then arguments of the
        user's own functions.
    is_reference : bool
        Whether other runs are measured against this one.
    folder : Path
        Folder of the study file, which files named in it are looked for in.
    """

    experiment: str
    model: Experiment
    values: tuple[tuple[str, Any], ...]
    is_reference: bool = False
    folder: Path = Path()

    def __hash__(self) -> int:
        return hash((self.experiment, self.path))

    @cached_property
    def path(self) -> str:
        """Canonical name of the point, ``e~0.2/N~16/variant~full``; ``reference/..`` of one."""
        parts = [f"{key}~{canonical(value)}" for key, value in self.values]
        return "/".join(["reference", *parts] if self.is_reference else parts)

    @cached_property
    def reference(self) -> "Run":
        """The run that this run's error is measured against.

        Runs on a radial grid, whose nodes no Cartesian run has, get one of their own method with more nodes.
        """
        if isinstance(self.model, BenchmarkExperiment) and self.solver.traits.radial:
            finer = {"N": self.timing.radial_nodes, "method": self.solver.method}
            values = dict(self.values) | finer
            return replace(self, values=tuple(values.items()), is_reference=True)
        assert self._reference_model is not None
        fixed = self._reference_model.model_fields_set
        shared = self._shared(key for key in SHARED_WITH_REFERENCE if key not in fixed)
        return replace(self, values=tuple(shared.items()), is_reference=True)

    @property
    def has_reference(self) -> bool:
        """Whether its error is measured against the run of another solver."""
        return self._reference_model is not None

    @property
    def _reference_model(self) -> SolverModel | None:
        """What the study file says of the solver that errors are measured against."""
        if isinstance(self.model, CollisionExperiment | BenchmarkExperiment):
            return self.model.reference
        return None

    @cached_property
    def truth(self) -> "Run":
        """The run that this evolution's T and a2 are held against; all runs of one gas share it."""
        model = self.model
        assert isinstance(model, EvolutionExperiment) and model.truth is not None
        truth, time = model.truth, model.time
        if truth.time.dt is not None or truth.time.time_rtol is not None:
            time = time.model_copy(update={"dt": None, "time_rtol": None})
        update = {
            "scene": model.scene.model_copy(update=_set(truth.scene)),
            "solver": truth.solver,
            "accuracy": None,
            "time": time.model_copy(update=_set(truth.time)),
            "truth": None,
            "refine": None,
        }
        shared = tuple(self._shared(SHARED_WITH_TRUTH).items())
        changed = model.model_copy(update=update)
        return Run(self.experiment, changed, shared, is_reference=True, folder=self.folder)

    @property
    def measured_against(self) -> "list[Run]":
        """The runs that the study computes for this one's errors."""
        model = self.model
        if isinstance(model, CollisionExperiment):
            return [self.reference]
        by_run = isinstance(model, EvolutionExperiment) and model.truth and model.truth.solver
        return [self.truth] if by_run else []

    @property
    def timing(self) -> TimingModel:
        """How a benchmark times the run."""
        assert isinstance(self.model, BenchmarkExperiment)
        return self.model.timing

    def has(self, values: dict[str, Any]) -> bool:
        """Whether the run has these values of parameters, swept or not."""
        own = self.solver.describe() | dict(self.values)
        return all(own.get(key) == value for key, value in values.items())

    def _shared(self, keys: Iterable[str]) -> dict[str, Any]:
        """The swept values of what is modelled, and of these parameters."""
        others = {*SolverModel.model_fields, *TimeModel.model_fields} - set(keys)
        return {key: value for key, value in self.values if key not in others}

    def _values_of(self, keys: Iterable[str]) -> dict[str, Any]:
        """The swept values of these parameters, in the order of the run's own."""
        wanted = set(keys)
        return {key: value for key, value in self.values if key in wanted}

    @cached_property
    def _case(self) -> Case:
        """The random run of this run's seed."""
        seed = dict(self.values)["seed"]
        if type(seed) is not int or seed < 0:
            raise ValueError(f"seed={seed!r}: must be an integer of at least 0")
        return random_case(seed)

    @cached_property
    def scene(self) -> Scene:
        """The scene with this run's swept values."""
        if isinstance(self.model, LabelsExperiment):
            return self._case.scene
        solver_and_time = {*SolverModel.model_fields, *TimeModel.model_fields}
        swept = {
            COORDINATES.get(key, key): value
            for key, value in self.values
            if key not in solver_and_time
        }
        words = self.model.scene.words
        name = swept.pop("scene", self.model.scene.name)
        for one, other in (("e", "restitution"), ("restitution", "e")):
            if one in swept:
                words.pop(other, None)
        words |= swept
        if "e" not in words and "restitution" not in words and not is_reference(name):
            raise ValueError("e: set scene.e or sweep e")
        return load_scene(name, beside=self.folder, **words)

    @cached_property
    def solver(self) -> Solver:
        """The solver with this run's swept values."""
        if isinstance(self.model, LabelsExperiment):
            return self._case.solver
        swept = self._values_of(SolverModel.model_fields)
        settings = swept if self._asks_in_place else self.model.solver_words | swept
        if not _takes(settings, "particles"):
            # So that an experiment can sweep over methods, one of them by particles.
            settings = _without(settings, PARTICLES - swept.keys())
        reference = self._reference_model
        if self.is_reference and reference is not None and "method" not in swept:
            settings = _without(settings, NOT_SHARED) | reference.model_dump(exclude_unset=True)
        refine = getattr(self.model, "refine", None)
        if refine is not None and not self.is_reference:
            settings[refine.refinement.over] = refine.refinement.values[0]
        rule = settings.get("sphere_rule")
        if isinstance(rule, str) and (self.folder / rule).is_file():
            settings["sphere_rule"] = str(self.folder / rule)
        may_be_open = "rtol" in settings and _takes(settings, "rtol")
        may_be_open |= "accuracy" in settings or "a2_accuracy" in settings
        for needed in ("N", "R"):
            if needed not in settings and not may_be_open:
                raise ValueError(f"{needed}: set solver.{needed} or sweep {needed}")
        if isinstance(settings.get("M_sph"), list):
            settings["M_sph"] = tuple(settings["M_sph"])
        return Solver(**settings)

    @property
    def _asks_in_place(self) -> bool:
        """Whether the run's block asks for an accuracy, and another block does not.

        The experiment's solver, steps and frame are then those of the other blocks.
        """
        asking = [bool(set(ACCURACIES) & set(block)) for block in self.model.sweep]
        return any(key in ACCURACIES for key, _ in self.values) and not all(asking)

    @property
    def time_fields(self) -> dict[str, Any]:
        """How an evolution goes through time, as `granstudy.simulate` takes it; unset fields stay out."""
        if isinstance(self.model, LabelsExperiment):
            return dict(self._case.time)
        assert isinstance(self.model, EvolutionExperiment)
        model = self.model.time
        fields = model.model_dump(exclude_none=True)
        if self._asks_in_place:
            fields = _without(fields, CHOSEN)
        fields |= self._values_of(TimeModel.model_fields)
        steps_open = self.solver.accuracy is not None
        if "dt" not in fields and "time_rtol" not in fields and not steps_open:
            raise ValueError("dt: set time.dt or sweep dt, or set or sweep time_rtol")
        if isinstance(model.times, TimesModel):
            fields["times"] = model.times.outputs(fields["t_final"])
        if "conserve" in fields:
            fields["conserve"] = _conserved(fields["conserve"])
        return fields

    @property
    def time(self) -> TimeSettings | None:
        """How the run goes through time, checked; None where nothing evolves."""
        return self.computation.time

    @property
    def _evolves(self) -> bool:
        return isinstance(self.model, EvolutionExperiment | LabelsExperiment)

    @cached_property
    def computation(self) -> Computation:
        """What the run computes, whichever study asks for it."""
        fields = self.time_fields if self._evolves else None
        refine = None if self.is_reference else getattr(self.model, "refine", None)
        ladder = None if refine is None else refine.refinement
        return Computation(self.model.computes, self.scene, self.solver, fields, refinement=ladder)


def swept_words(runs: Iterable[Run]) -> list[str]:
    """Words that some of the runs sweep, in the order of a run's path."""
    words = dict.fromkeys(word for run in runs for word, _ in run.values)
    return sorted(words, key=place)


def _takes(settings: dict[str, Any], field: str) -> bool:
    """Whether the method of these settings takes a field that only some methods take."""
    method = METHODS.get(settings.get("method", Solver.method))
    return method is not None and field in method.takes


def _without(settings: dict[str, Any], names: Iterable[str]) -> dict[str, Any]:
    left_out = set(names)
    return {name: value for name, value in settings.items() if name not in left_out}


def _set(model: Section) -> dict[str, Any]:
    """The fields that a study file sets."""
    return {name: getattr(model, name) for name in model.model_fields_set}


def _conserved(names: str) -> tuple[str, ...]:
    """What a study file's ``mass-momentum`` names; nothing for ``none``."""
    return () if names == "none" else tuple(names.split("-"))


def canonical(value: Any) -> str:
    """A value as it stands in a path: decimal, without trailing zeros; 2x3 for a pair."""
    if isinstance(value, list):
        return "x".join(map(canonical, value))
    if isinstance(value, float):
        plain = Decimal(repr(value + 0.0)).normalize()  # −0.0 is 0.0
        return format(plain, "f")
    return quote(str(value), safe="")
