"""One run of a study: its scene, solver and times, its canonical name, its cost."""

import json
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import cached_property
from typing import Any
from urllib.parse import quote

from granstudy.collision.choice.cost import Cost, estimate
from granstudy.collision.choice.methods import OPERATORS, check
from granstudy.collision.operator import choose
from granstudy.evolution.forecast import expected_evaluations
from granstudy.evolution.times import TimeSettings, check_frame
from granstudy.model.kernel import VHS
from granstudy.model.methods import METHODS, PARTICLES
from granstudy.model.restitution import Viscoelastic, check_restitution
from granstudy.model.scene import Scene, load_scene
from granstudy.model.solver import Choice, Solver
from granstudy.particles.cost import particle_cost
from granstudy.particles.restitution_table import alpha_table
from granstudy.states.solve import check_state, gaussian_scene, state_evaluations
from granstudy.study.schema.experiment import Experiment, TimingModel
from granstudy.study.schema.sections import (
    SceneFields,
    SolverModel,
    TimeFields,
    TimeModel,
    TimesModel,
    ViscoelasticModel,
)
from granstudy.trust.exact_law import check_maxwell_law
from granstudy.velocity.sphere import sphere_area

SHARED_WITH_REFERENCE = ("e", "exponent", "epsilon", "N", "R", "N_rho")
"""What a collision run's reference takes over from the run: all but the rule on the sphere."""

SHARED_WITH_TRUTH = ("e", "exponent", "epsilon")
"""What a run's truth takes over from it: what is modelled."""

DENSITY_FIELDS = ("temperature", "velocity", "separation", "tail")
"""What a study file can set of a named scene's initial density."""

STAND_IN = {2: (64, 8.0), 3: (32, 8.0)}
"""N and R of estimates where a tolerance chooses them when the run starts."""

NO_TIMES = {"dt": None, "save_every": None}
"""Fields of a run's times that its parameters name even where they are left out."""


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
        """The run that this run's error is measured against.

        A benchmark's `radial` runs, whose nodes no Cartesian run has, get one with more nodes.
        """
        if self.model.run == "benchmark" and self.solver.method == "radial":
            finer = dict(self.values) | {"N": self.timing.radial_nodes, "method": "radial"}
            return replace(self, values=tuple(finer.items()), is_reference=True)
        assert self.model.reference is not None
        fixed = self.model.reference.model_fields_set
        shared = tuple(
            (key, value)
            for key, value in self.values
            if key in SHARED_WITH_REFERENCE and key not in fixed
        )
        return replace(self, values=shared, is_reference=True)

    @cached_property
    def truth(self) -> "Run":
        """The run that this evolution's T and a2 are held against; all runs of one gas share it."""
        truth = self.model.truth
        assert truth is not None and truth.solver is not None and self.model.time is not None
        scene = self.model.scene.model_copy(update=_set(truth.scene))
        time = self.model.time
        if truth.time.dt is not None or truth.time.time_rtol is not None:
            time = time.model_copy(update={"dt": None, "time_rtol": None})
        time = time.model_copy(update=_set(truth.time))
        model = self.model.model_copy(
            update={"scene": scene, "solver": truth.solver, "time": time, "truth": None}
        )
        shared = tuple((key, value) for key, value in self.values if key in SHARED_WITH_TRUTH)
        return Run(self.experiment, model, shared, is_reference=True)

    @property
    def measured_against(self) -> "list[Run]":
        """The runs that the study computes for this one's errors."""
        if self.model.run == "collision":
            return [self.reference]
        truth = self.model.truth
        return [] if truth is None or truth.solver is None else [self.truth]

    @property
    def timing(self) -> TimingModel:
        """How a benchmark times the run."""
        return self.model.timing or TimingModel()

    def has(self, values: dict[str, Any]) -> bool:
        """Whether the run has these values of parameters, swept or not."""
        own = self.solver.describe() | dict(self.values)
        return all(own.get(key) == value for key, value in values.items())

    def _value(self, key: str, default: Any) -> Any:
        return dict(self.values).get(key, default)

    @cached_property
    def scene(self) -> Scene:
        """The scene with this run's swept values."""
        model = self.model.scene
        base = load_scene(
            model.name,
            **{key: value for key in DENSITY_FIELDS if (value := getattr(model, key)) is not None},
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
            symmetry=self._value("symmetry", model.symmetry),
        )

    @cached_property
    def solver(self) -> Solver:
        """The solver with this run's swept values."""
        settings = self.model.solver.model_dump(exclude_none=True)
        fields = set(SolverModel.model_fields)
        swept = {key: value for key, value in self.values if key in fields}
        settings |= swept
        if settings.get("method") != "dsmc":
            # So that an experiment can sweep over methods, one of them `dsmc`.
            for field in PARTICLES - swept.keys():
                settings.pop(field, None)
        reference = self.model.reference
        if self.is_reference and reference is not None and self._value("method", None) != "radial":
            for own in ("rtol", "precision", "device"):  # of the run's; a reference says its own
                settings.pop(own, None)
            settings |= reference.model_dump(exclude_unset=True)
        chosen = "rtol" in settings and "rtol" in METHODS[settings.get("method", "fast")].takes
        for needed in ("N", "R"):
            if needed not in settings and not chosen:
                raise ValueError(f"{needed}: set solver.{needed} or sweep {needed}")
        if isinstance(settings.get("M_sph"), list):
            settings["M_sph"] = tuple(settings["M_sph"])
        return Solver(**settings)

    @property
    def time_fields(self) -> dict[str, Any]:
        """How the run goes through time, as `granstudy.simulate` takes it; what is left out stays out."""
        model = self.model.time
        assert model is not None
        fields = model.model_dump(exclude_none=True)
        fields |= {key: value for key, value in self.values if key in TimeModel.model_fields}
        if "dt" not in fields and "time_rtol" not in fields:
            raise ValueError("dt: set time.dt or sweep dt, or set or sweep time_rtol")
        if isinstance(model.times, TimesModel):
            fields["times"] = model.times.outputs(model.t_final)
        if "conserve" in fields:
            fields["conserve"] = _conserved(fields["conserve"])
        return fields

    @cached_property
    def time(self) -> TimeSettings | None:
        """The same, checked; None where nothing evolves."""
        return None if self.model.time is None else TimeSettings(**self.time_fields)

    @property
    def evaluations(self) -> int:
        """Evaluations of Q that the run makes, about as many where the steps adapt (none by `dsmc`)."""
        if self.model.state is not None:
            return state_evaluations(self.choice.solver)
        return 1 if self.time is None else expected_evaluations(self.scene, self.time)

    @property
    def planned_scene(self) -> Scene:
        """The scene that Q is planned for: of a state a gas at rest, as isotropic as the state is."""
        return self.scene if self.model.state is None else gaussian_scene(self.scene)

    @cached_property
    def choice(self) -> Choice:
        """What the solver leaves open, as it will be chosen; N and R are stand-ins where they are open.

        Choosing those takes too long before a workflow starts.
        """
        solver = self.solver
        if solver.N is None:
            N, R = STAND_IN[self.scene.dim]
            solver = replace(solver, N=N, R=R)
        return replace(choose(self.planned_scene, solver), asked=self.solver)

    @cached_property
    def cost(self) -> Cost:
        """Estimated seconds and memory of the run."""
        if self.solver.method == "dsmc":
            assert self.time is not None
            records = len(self.time.recorded)
            return particle_cost(self.scene, self.solver, self.time.t_final, records)[0]
        return estimate(
            OPERATORS[self.choice.solver.method].cost,
            self.planned_scene,
            self.choice.solver,
            self.evaluations,
        )

    def check(self) -> None:
        """Raise ValueError for anything that would stop the run later."""
        if self.solver.N is None and self.model.run == "benchmark":
            raise ValueError("N=None: benchmark runs need N and R")
        if self.model.state is not None:
            check_state(self.scene, self.solver, heated=self.model.state == "heated")
        _ = self.evaluations  # t_final must be a whole number of steps
        self._check_truth()
        if self.solver.method == "dsmc":
            self._check_particles()
            return
        solver = self.choice.solver
        check_restitution(self.scene.restitution, solver.R)
        radial = solver.traits.radial
        asked = self.solver.method == solver.method
        check(self.scene if asked else self.planned_scene, solver)
        if self.model.reference is not None and not self.is_reference:
            self.reference.check()
        if self.model.run == "collision" and not self.is_reference:
            other = self.reference.choice.solver.method
            if radial != METHODS[other].radial:
                raise ValueError(
                    f"method {solver.method!r}: has other velocity nodes than its reference's "
                    f"method {other!r}; a collision run and its reference must share them"
                )
        if self.time is not None:
            check_frame(self.scene, solver, self.time)

    def _check_truth(self) -> None:
        truth = self.model.truth
        if truth is None or self.is_reference:
            return
        if truth.solver is not None:
            try:
                self.truth.check()
            except ValueError as error:
                raise ValueError(f"truth: {error}") from None
        else:
            check_maxwell_law(self.scene)

    def _check_particles(self) -> None:
        if self.model.run != "evolution":
            raise ValueError(
                f"method='dsmc': has no collision operator for {self.model.run} runs, only evolution runs"
            )
        alpha_table(self.scene.restitution, self.solver.R)

    def parameters(self) -> str:
        """All that the run depends on, as canonical JSON."""
        return json.dumps(
            {
                "run": " ".join(filter(None, (self.model.state, self.model.run))),
                "scene": self.scene.describe(),
                "solver": self.solver.describe(),
                "time": None if self.model.time is None else {**NO_TIMES, **self.time_fields},
            },
            sort_keys=True,
        )


def _set(model: SceneFields | TimeFields) -> dict[str, Any]:
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
