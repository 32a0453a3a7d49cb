"""Sections of a study file that say what is modelled, how well, and how it goes through time."""

import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, model_validator

from granstudy.runs.computation import Refinement
from granstudy.study.schema.generated import (
    Section,
    density_fields,
    renamed,
    solver_fields,
    with_fields,
)
from granstudy.support.own_code.load import is_reference

Value = bool | int | float | str | list[int | float] | None
"""One value of a swept parameter; a list of numbers is one value of a vector."""

DENSITY_FIELDS = density_fields()
"""What a study file can set of a named scene's initial density."""


class RangeModel(Section):
    """Values in equal steps, or in equal ratios, of a swept parameter."""

    start: Annotated[int | float, Field(description="the first value")]
    stop: Annotated[int | float, Field(description="the last value")]
    count: Annotated[int | None, Field(ge=2, description="how many values")] = None
    step: Annotated[int | float | None, Field(description="in place of count: the step")] = None
    spacing: Annotated[
        Literal["linear", "log"], Field(description="equal steps, or equal ratios")
    ] = "linear"

    @model_validator(mode="after")
    def _count_or_step(self) -> "RangeModel":
        if (self.count is None) == (self.step is None):
            raise ValueError("count, step: give one")
        numbers = (self.start, self.stop, self.step or 1.0, float(self.stop) - self.start)
        if not all(math.isfinite(value) for value in numbers):
            raise ValueError("start, stop, step: must be finite numbers")
        if self.spacing == "log" and (self.step is not None or min(self.start, self.stop) <= 0):
            raise ValueError("spacing: log needs a count, and positive start and stop")
        if self.step is not None and self._steps(self.step) < 1:
            raise ValueError(f"step={self.step!r}: does not lead from start to stop")
        steps = 0 if self.step is None else self._steps(self.step)
        if max(steps, self.count or 0) >= MOST_VALUES:
            raise ValueError(f"count, step: more than {MOST_VALUES:,} values; must be fewer")
        return self

    def _steps(self, step: float) -> float:
        steps = (self.stop - self.start) / step * (1 + 1e-9) if step else 0.0
        return math.floor(steps) if abs(steps) < MOST_VALUES else steps

    def __len__(self) -> int:
        if self.count is not None:
            return self.count
        assert self.step is not None
        return 1 + int(self._steps(self.step))

    def values(self) -> list[int | float]:
        """The values themselves, to 12 digits; whole numbers where start and step, or all values, are."""
        if self.step is not None:
            found = [self.start + k * self.step for k in range(len(self))]
            if type(self.start) is int and type(self.step) is int:
                return found
        elif self.spacing == "log":
            found = np.geomspace(self.start, self.stop, len(self)).tolist()
        else:
            found = np.linspace(self.start, self.stop, len(self)).tolist()
        rounded = [float(f"{value:.12g}") for value in found]
        whole = type(self.start) is int and type(self.stop) is int
        if whole and all(value.is_integer() for value in rounded):
            return [int(value) for value in rounded]
        return rounded


MOST_VALUES = 100_000
"""Values that a range has fewer than."""


class ViscoelasticModel(Section):
    """Restitution of viscoelastic spheres (`granstudy.Viscoelastic`)."""

    viscoelastic: Annotated[float, Field(description="the material constant A")]


@with_fields(DENSITY_FIELDS)
class SceneFields(Section):
    """What can be set of a scene, the parameters of its density among them."""

    e: Annotated[float | None, Field(description="constant restitution, 0 to 1")] = None
    restitution: Annotated[
        float | str | ViscoelasticModel | None,
        Field(
            description="a constant; viscoelastic, with A; or a law of one's own, my_gas.py:law, with "
            "its arguments beside it"
        ),
    ] = None
    A: Annotated[float | None, Field(description="of viscoelastic spheres: their constant")] = None
    exponent: Annotated[float | None, Field(description="λ of the kernel, 0 to 1")] = None
    strength: Annotated[float | None, Field(description="C_λ; default 1/(2π), 1/(4π)")] = None
    diffusion: Annotated[float | None, Field(description="diffusion ε; default 1e-6")] = None
    symmetry: Annotated[
        str | None, Field(description="none, inversion, ...; default: what the density declares")
    ] = None
    dim: Annotated[
        int | None, Field(description="2 or 3, for a density of one's own of any dimension")
    ] = None
    arguments: Annotated[
        dict[str, Value] | None,
        Field(
            description="arguments of a density or law of one's own; they may stand beside it, too"
        ),
    ] = None

    @model_validator(mode="before")
    @classmethod
    def _in_one_form(cls, values: Any) -> Any:
        if isinstance(values, str):
            return {"name": values}
        if not isinstance(values, dict):
            return values
        values = renamed(values)
        if any(is_reference(values.get(key)) for key in ("name", "restitution")):
            known = {key: value for key, value in values.items() if key in cls.model_fields}
            own = {key: value for key, value in values.items() if key not in cls.model_fields}
            if own:
                return known | {"arguments": {**(known.get("arguments") or {}), **own}}
        return values

    @model_validator(mode="after")
    def _one_restitution(self) -> "SceneFields":
        if self.e is not None and self.restitution is not None:
            raise ValueError("e, restitution: both say the same; give one")
        return self

    @property
    def words(self) -> dict[str, Any]:
        """The words that are set, as `granstudy.load_scene` takes them."""
        set_ = {name: getattr(self, name) for name in self.model_fields_set}
        words = {k: v for k, v in set_.items() if v is not None and k not in ("name", "arguments")}
        law = words.get("restitution")
        if isinstance(law, ViscoelasticModel):
            words |= {"restitution": "viscoelastic", "A": law.viscoelastic}
        return words | (self.arguments or {})

    @property
    def has_own_code(self) -> bool:
        """Whether the density or the law is a function of the user."""
        return is_reference(self.restitution) or is_reference(getattr(self, "name", None))


class SceneModel(SceneFields):
    """What is modelled: a named scene, or a density of one's own, and what of it is set otherwise."""

    name: Annotated[
        str,
        Field(
            description="bkw2d, bkw3d, double_well2d, double_well3d, ..., or my_gas.py:density, a "
            "function in a file beside the study"
        ),
    ]


@with_fields(solver_fields())
class SolverModel(Section):
    """How well it is modelled: any field of `granstudy.Solver` that is not swept."""


MOST_OUTPUTS = 100_000
"""Outputs that times with a number a decade make at most."""


class TimesModel(Section):
    """Output times, spaced evenly in their logarithm."""

    first: Annotated[float, Field(gt=0.0, description="the first time")]
    last: Annotated[float | None, Field(gt=0.0, description="the last; default t_final")] = None
    per_decade: Annotated[int, Field(ge=1, description="how many a decade")] = 10

    def outputs(self, t_final: float) -> list[float]:
        """The times themselves."""
        last = t_final if self.last is None else self.last
        if not self.first < last:
            raise ValueError(f"times.first={self.first!r}: must be below the last time, {last!r}")
        count = 1 + round(self.per_decade * (math.log10(last) - math.log10(self.first)))
        if count > MOST_OUTPUTS:
            raise ValueError(
                f"times.per_decade={self.per_decade!r}: makes {count} outputs; must be {MOST_OUTPUTS:,} at "
                "most"
            )
        return np.geomspace(self.first, last, max(count, 1)).tolist()


class TimeFields(Section):
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
    """In which steps and frame a run goes through time, and how long."""

    t_final: float


class AccuracyModel(Section):
    """Largest errors that T and a2 of a run may have."""

    temperature: Annotated[
        float | None, Field(gt=0.0, description="error of T, relative; default a tenth of a2's")
    ] = None
    a2: Annotated[float | None, Field(gt=0.0, description="error of a2; default ten times T's")] = (
        None
    )

    @model_validator(mode="after")
    def _at_least_one(self) -> "AccuracyModel":
        if self.temperature is None and self.a2 is None:
            raise ValueError("temperature, a2: give one, or both")
        return self

    @property
    def words(self) -> dict[str, float]:
        """The words of a solver that asks for it."""
        named = {"accuracy": self.temperature, "a2_accuracy": self.a2}
        return {name: value for name, value in named.items() if value is not None}


class RefineModel(Section):
    """A ladder of N or R that every run goes up until its answer no longer changes."""

    N: Annotated[list[int] | None, Field(min_length=2, description="N, from coarse to fine")] = None
    R: Annotated[
        list[int | float] | None, Field(min_length=2, description="or R, from small to large")
    ] = None
    temperature: Annotated[
        float, Field(gt=0.0, description="largest relative change of T between two neighbours")
    ] = 1e-4
    a2: Annotated[float, Field(gt=0.0, description="largest change of a2, likewise")] = 1e-3

    @model_validator(mode="after")
    def _one_ladder(self) -> "RefineModel":
        if (self.N is None) == (self.R is None):
            raise ValueError("N, R: give one, the values to go up")
        return self

    @property
    def refinement(self) -> Refinement:
        """The ladder itself."""
        over, values = ("N", self.N) if self.N is not None else ("R", self.R)
        assert values is not None
        steps = tuple(values) if over == "N" else tuple(float(value) for value in values)
        return Refinement(over, steps, self.temperature, self.a2)
