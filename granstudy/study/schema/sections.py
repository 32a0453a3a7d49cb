"""Sections of a study file that say what is modelled, how well, and how it goes through time."""

import math
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from granstudy.study.schema.generated import (
    Section,
    density_fields,
    renamed,
    solver_fields,
    with_fields,
)

Value = bool | int | float | str | list[int] | None
"""One value of a swept parameter."""

DENSITY_FIELDS = density_fields()
"""What a study file can set of a named scene's initial density."""


class ViscoelasticModel(Section):
    """Restitution of viscoelastic spheres (`granstudy.Viscoelastic`)."""

    viscoelastic: Annotated[float, Field(description="the material constant A")]


@with_fields(DENSITY_FIELDS)
class SceneFields(Section):
    """What can be set of a named scene, its density's parameters among them."""

    restitution: float | ViscoelasticModel | None = None
    exponent: Annotated[float | None, Field(description="λ of the kernel, 0 to 1")] = None
    strength: Annotated[float | None, Field(description="C_λ; default 1/(2π), 1/(4π)")] = None
    diffusion: Annotated[float | None, Field(description="diffusion ε; default 1e-6")] = None
    symmetry: Annotated[
        str | None, Field(description="none, inversion, ...; default: what the density declares")
    ] = None

    @model_validator(mode="before")
    @classmethod
    def _old_words(cls, values: Any) -> Any:
        return renamed(values) if isinstance(values, dict) else values

    @property
    def density(self) -> dict[str, Any]:
        """The parameters of the density that are set."""
        values = {name: getattr(self, name) for name in DENSITY_FIELDS}
        return {name: value for name, value in values.items() if value is not None}


class SceneModel(SceneFields):
    """What is modelled: a named scene, and what of it is set otherwise."""

    name: Annotated[str, Field(description="bkw2d, bkw3d, double_well2d, double_well3d, ...")]


@with_fields(solver_fields())
class SolverModel(Section):
    """How well it is modelled: any field of `granstudy.Solver` that is not swept."""


class TimesModel(Section):
    """Output times, spaced evenly in their logarithm."""

    first: Annotated[float, Field(gt=0.0, description="the first time")]
    last: Annotated[float | None, Field(gt=0.0, description="the last; default t_final")] = None
    per_decade: Annotated[int, Field(ge=1, description="how many a decade")] = 10

    def outputs(self, t_final: float) -> list[float]:
        """The times themselves."""
        last = t_final if self.last is None else self.last
        count = 1 + round(self.per_decade * math.log10(last / self.first))
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
