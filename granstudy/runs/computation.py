"""What a run computes: a kind, a scene, a solver and times, whoever asks for it."""

import itertools
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from granstudy.accuracy.asked import accurate_times
from granstudy.evolution.times import TimeSettings
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.checks import check_positive, is_real


@dataclass(frozen=True)
class Refinement:
    """A ladder of one parameter: a run goes up until its temperature and kurtosis no longer change.

    Attributes
    ----------
    over : str
        ``N`` or ``R``.
    values : tuple
        The parameter's values, from coarse to fine; at least two.
    temperature : float
        Largest relative change of T between two neighbouring values, over all common output times.
    a2 : float
        Largest change of a2, likewise.

    Raises
    ------
    ValueError
        If a field has another value.
    """

    over: str
    values: tuple[Any, ...]
    temperature: float = 1e-4
    a2: float = 1e-3

    def __post_init__(self) -> None:
        if self.over not in ("N", "R"):
            raise ValueError(f"refine: {self.over!r}: must be N or R")
        steps = list(self.values)
        if (
            len(steps) < 2
            or not all(map(is_real, steps))
            or any(b <= a for a, b in itertools.pairwise(steps))
        ):
            raise ValueError(f"refine.{self.over}={steps}: must be two or more increasing values")
        for name in ("temperature", "a2"):
            check_positive(f"refine.{name}", getattr(self, name))

    def describe(self) -> dict[str, Any]:
        """The refinement as plain data."""
        changes = {"temperature": float(self.temperature), "a2": float(self.a2)}
        return {self.over: list(self.values), **changes}


@dataclass(frozen=True, eq=False)
class Computation:
    """All that the numbers of a run depend on, but the code.

    Attributes
    ----------
    kind : str
        A row of `granstudy.runs.kinds.KINDS`.
    scene : Scene
    solver : Solver
    time_fields : dict, optional
        How an evolution goes through time, as `granstudy.simulate` takes it; None where nothing evolves.
    refinement : Refinement, optional
        The ladder that the run goes up.
    """

    kind: str
    scene: Scene
    solver: Solver
    time_fields: Mapping[str, Any] | None = None
    refinement: Refinement | None = field(default=None, kw_only=True)

    @cached_property
    def time(self) -> TimeSettings | None:
        """How the run goes through time, checked; None where nothing evolves."""
        if self.time_fields is None:
            return None
        if self.solver.accuracy is not None:
            return accurate_times(**self.time_fields)
        return TimeSettings(**self.time_fields)

    @cached_property
    def parameters(self) -> str:
        """All that the run depends on, as canonical JSON, equal however it was asked for."""
        described: dict[str, Any] = {
            "run": self.kind,
            "scene": self.scene.identity(),
            "solver": self.solver.describe(),
            "time": None if self.time is None else self.time.describe(),
        }
        if self.refinement is not None:
            described["refinement"] = self.refinement.describe()
        return json.dumps(described, sort_keys=True)


def ladder(computation: Computation) -> list[Computation]:
    """The runs that a run with a refinement goes up, from coarse to fine; each is a run of its own.

    Raises
    ------
    ValueError
        If the run has no refinement.
    """
    refinement = computation.refinement
    if refinement is None:
        raise ValueError(f"{computation.kind}: has no refinement")
    return [
        replace(
            computation,
            solver=replace(computation.solver, **{refinement.over: value}),
            refinement=None,
        )
        for value in refinement.values
    ]
