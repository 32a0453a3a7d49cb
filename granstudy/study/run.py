"""One run of a study: its values, its canonical name, and the scene, solver and times that they come to."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from typing import Any
from urllib.parse import quote

from granstudy.evolution.times import TimeSettings
from granstudy.model.kernel import VHS
from granstudy.model.load_scene import load_scene
from granstudy.model.methods import METHODS, PARTICLES
from granstudy.model.restitution import Viscoelastic
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation
from granstudy.study.schema.experiment import (
    BenchmarkExperiment,
    CollisionExperiment,
    EvolutionExperiment,
    Experiment,
    TimingModel,
)
from granstudy.study.schema.generated import Section
from granstudy.study.schema.sections import SolverModel, TimeModel, TimesModel, ViscoelasticModel
from granstudy.velocity.sphere import sphere_area

SHARED_WITH_REFERENCE = ("e", "exponent", "diffusion", "N", "R", "N_rho")
"""What a run's reference takes over from the run: all but the rule on the sphere."""

SHARED_WITH_TRUTH = ("e", "exponent", "diffusion")
"""What a run's truth takes over from it: what is modelled."""

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
        The swept parameters, in the order of `granstudy.datasets.parameters.SWEPT`.
    is_reference : bool
        Whether other runs are measured against this one.
    """

    experiment: str
    model: Experiment
    values: tuple[tuple[str, Any], ...]
    is_reference: bool = False

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
        shared = self._values_of(key for key in SHARED_WITH_REFERENCE if key not in fixed)
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
            "time": time.model_copy(update=_set(truth.time)),
            "truth": None,
        }
        shared = tuple(self._values_of(SHARED_WITH_TRUTH).items())
        return Run(self.experiment, model.model_copy(update=update), shared, is_reference=True)

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

    def _values_of(self, keys: Iterable[str]) -> dict[str, Any]:
        """The swept values of these parameters, in the order of the run's own."""
        wanted = set(keys)
        return {key: value for key, value in self.values if key in wanted}

    @cached_property
    def scene(self) -> Scene:
        """The scene with this run's swept values."""
        model, swept = self.model.scene, dict(self.values)
        base = load_scene(model.name, **model.density)
        exponent = swept.get("exponent", model.exponent)
        strength = 1.0 / sphere_area(base.dim) if model.strength is None else model.strength
        diffusion = swept.get("diffusion", model.diffusion)
        return Scene(
            dim=base.dim,
            initial=base.initial,
            kernel=VHS(0.0 if exponent is None else exponent, strength),
            restitution=_restitution(swept.get("e", model.restitution)),
            diffusion=base.diffusion if diffusion is None else diffusion,
            symmetry=swept.get("symmetry", model.symmetry),
        )

    @cached_property
    def solver(self) -> Solver:
        """The solver with this run's swept values."""
        swept = self._values_of(SolverModel.model_fields)
        settings = self.model.solver.model_dump(exclude_none=True) | swept
        if not _takes(settings, "particles"):
            # So that an experiment can sweep over methods, one of them by particles.
            settings = _without(settings, PARTICLES - swept.keys())
        reference = self._reference_model
        if self.is_reference and reference is not None and "method" not in swept:
            settings = _without(settings, NOT_SHARED) | reference.model_dump(exclude_unset=True)
        may_be_open = "rtol" in settings and _takes(settings, "rtol")
        for needed in ("N", "R"):
            if needed not in settings and not may_be_open:
                raise ValueError(f"{needed}: set solver.{needed} or sweep {needed}")
        if isinstance(settings.get("M_sph"), list):
            settings["M_sph"] = tuple(settings["M_sph"])
        return Solver(**settings)

    @property
    def time_fields(self) -> dict[str, Any]:
        """How an evolution goes through time, as `granstudy.simulate` takes it; unset fields stay out."""
        assert isinstance(self.model, EvolutionExperiment)
        model = self.model.time
        fields = model.model_dump(exclude_none=True) | self._values_of(TimeModel.model_fields)
        if "dt" not in fields and "time_rtol" not in fields:
            raise ValueError("dt: set time.dt or sweep dt, or set or sweep time_rtol")
        if isinstance(model.times, TimesModel):
            fields["times"] = model.times.outputs(model.t_final)
        if "conserve" in fields:
            fields["conserve"] = _conserved(fields["conserve"])
        return fields

    @property
    def time(self) -> TimeSettings | None:
        """How the run goes through time, checked; None where nothing evolves."""
        return self.computation.time

    @property
    def _evolves(self) -> bool:
        return isinstance(self.model, EvolutionExperiment)

    @cached_property
    def computation(self) -> Computation:
        """What the run computes, whichever study asks for it."""
        fields = self.time_fields if self._evolves else None
        return Computation(self.model.computes, self.scene, self.solver, fields)


def _restitution(value: Any) -> Any:
    """A scene's restitution out of a study file's."""
    if value is None:
        raise ValueError("e: set scene.restitution or sweep e")
    return Viscoelastic(value.viscoelastic) if isinstance(value, ViscoelasticModel) else value


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
        plain = Decimal(repr(value)).normalize()
        return format(plain, "f")
    return quote(str(value), safe="")
