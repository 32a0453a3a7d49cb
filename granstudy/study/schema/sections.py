"""Sections of a study file that say what is modelled, how well, and how it goes through time."""

import math
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

Value = bool | int | float | str | list[int] | None


class Section(BaseModel):
    """A part of a study file: typed, immutable, without unknown fields."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class ViscoelasticModel(Section):
    """Restitution of viscoelastic spheres (`granstudy.Viscoelastic`)."""

    viscoelastic: Annotated[float, Field(description="the material constant A")]


class SceneFields(Section):
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


class SolverModel(Section):
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


class TimesModel(Section):
    """Output times, spaced evenly in their logarithm."""

    first: Annotated[float, Field(gt=0.0, description="time of the first")]
    last: Annotated[float | None, Field(gt=0.0, description="of the last; default t_final")] = None
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
    """The same, and how long."""

    t_final: float
