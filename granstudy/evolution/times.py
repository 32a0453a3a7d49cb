"""Time settings of a run: final time, steps or tolerance, scheme, frame, conservation, outputs."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.evolution.schemes import SCHEMES
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.checks import check_positive, is_count, plain
from granstudy.support.errors import unknown_name
from granstudy.support.machine import check_memory
from granstudy.velocity.space import INVARIANTS

FRAMES = ("fixed", "rescaled")
"""Velocities that a grid stores: v, or (v − u)/θ (docs/method.md §5)."""

FIRST_TIME = 1e-2
"""First output after t = 0 of an adaptive run, where t_final is 1 or later; else t_final/100."""

PER_DECADE = 10
"""Outputs in a decade of time of an adaptive run."""

MOST_STEPS = 10**8
"""Steps of one size that a run makes at most."""

NUMBERS_AN_OUTPUT = 60
"""Numbers that a run records at each output: moments, signs of health, exact laws."""

DEFAULT_SCHEME, DEFAULT_ADAPTIVE_SCHEME = "rk3", "dopri54"
"""Schemes of steps of one size, and of steps that adapt, where none is given."""


@dataclass(frozen=True, init=False)
class TimeSettings:
    """Time settings of a run, checked; `granstudy.simulate` explains each.

    Raises
    ------
    ValueError
        For a value that `granstudy.simulate` does not allow; the message says field, value and allowed.
    """

    t_final: float
    dt: float | None
    time_rtol: float | None
    times: Sequence[float] | np.ndarray | None
    frame: str
    scheme: str
    conserve: tuple[str, ...]
    save_every: int | None

    def __init__(
        self,
        t_final: float,
        dt: float | None = None,
        time_rtol: float | None = None,
        times: Sequence[float] | np.ndarray | None = None,
        frame: str = "fixed",
        scheme: str | None = None,
        conserve: Sequence[str] = (),
        save_every: int | None = None,
    ) -> None:
        check_positive("t_final", t_final)
        if (dt is None) == (time_rtol is None):
            raise ValueError(
                f"dt={dt!r}, time_rtol={time_rtol!r}: give one, a step or its tolerance"
            )
        if not isinstance(frame, str) or frame not in FRAMES:
            raise unknown_name("frame", frame, FRAMES)
        if scheme is None:
            scheme = DEFAULT_SCHEME if time_rtol is None else DEFAULT_ADAPTIVE_SCHEME
        if not isinstance(scheme, str) or scheme not in SCHEMES:
            raise unknown_name("scheme", scheme, list(SCHEMES))
        if save_every is not None and not is_count(save_every):
            raise ValueError(f"save_every={save_every!r}: must be a positive integer or None")
        fields: dict[str, Any] = {
            "t_final": plain(t_final),
            "dt": plain(dt),
            "time_rtol": plain(time_rtol),
            "times": times,
            "frame": frame,
            "scheme": scheme,
            "conserve": invariants(conserve),
            "save_every": save_every,
        }
        for name, value in fields.items():
            object.__setattr__(self, name, value)
        if dt is not None:
            self._check_fixed(self.dt)
        if time_rtol is not None:
            self._check_adaptive(self.time_rtol)

    def _check_fixed(self, dt: Any) -> None:
        """Raise ValueError for a bad size of steps, or times beside it."""
        step_count(self.t_final, dt)
        if self.times is not None:
            raise ValueError(
                f"times={self.times!r}: only with time_rtol; with dt every step is an output"
            )

    def _check_adaptive(self, rtol: Any) -> None:
        """Raise ValueError for a bad tolerance, or bad times of outputs."""
        check_positive("time_rtol", rtol)
        if not 1e-13 <= rtol < 1.0:
            raise ValueError(f"time_rtol={rtol!r}: must be a number between 1e-13 and 1")
        if self.times is not None:
            times = _numbers(self.times)
            if times.ndim != 1 or not np.all(np.diff(times, prepend=0.0) > 0.0):
                raise ValueError(
                    f"times={self.times!r}: must be positive and increase, all of them numbers"
                )
            if times.size and times[-1] > self.t_final:
                raise ValueError(
                    f"times={self.times!r}: the last must be t_final={self.t_final!r} at most"
                )

    @property
    def rescaled(self) -> bool:
        """Whether velocities are rescaled with the gas."""
        return self.frame == "rescaled"

    @property
    def steps(self) -> int:
        """Number of steps of the size ``dt``, which must be given."""
        assert self.dt is not None
        return step_count(self.t_final, self.dt)

    @property
    def outputs(self) -> np.ndarray:
        """Times of the outputs of an adaptive run, from 0 to t_final."""
        if self.times is None:
            first = min(FIRST_TIME, self.t_final / 100)
            count = 1 + int(np.ceil(PER_DECADE * np.log10(self.t_final / first)))
            inner = np.geomspace(first, self.t_final, count)[:-1]
        else:
            inner = np.asarray(self.times, dtype=float)
            inner = inner[inner < self.t_final]
        return np.array([0.0, *inner, self.t_final])

    @property
    def recorded(self) -> np.ndarray:
        """Times at which moments are recorded, in a run of either kind of steps."""
        if self.time_rtol is not None:
            return self.outputs
        assert self.dt is not None
        return self.dt * np.arange(self.steps + 1)

    def describe(self) -> dict[str, Any]:
        """The settings as plain data: equal for equal runs, whichever defaults were written out."""
        number = {
            name: None if value is None else float(value)
            for name, value in (("dt", self.dt), ("time_rtol", self.time_rtol))
        }
        times = None if self.times is None else np.asarray(self.times, dtype=float).tolist()
        return {
            "t_final": float(self.t_final),
            **number,
            "times": times,
            "frame": self.frame,
            "scheme": self.scheme,
            "conserve": list(self.conserve),
            "save_every": None if self.save_every is None else int(self.save_every),
        }

    def coordinates(self) -> dict[str, Any]:
        """The parameters of time that a study sweeps, by name (`granstudy.datasets.parameters`)."""
        step = {"dt": self.dt} if self.time_rtol is None else {"time_rtol": self.time_rtol}
        conserve = "-".join(self.conserve) or "none"
        named = {"frame": self.frame, "scheme": self.scheme, "conserve": conserve}
        return {**named, "t_final": float(self.t_final), **step}


def check_frame(scene: Scene, solver: Solver, settings: TimeSettings) -> None:
    """Raise ValueError where the scene or the solver rules out the frame, or what is to be conserved.

    Particles take neither. Where a rescaled frame changes the scale of a restitution law, Q is interpolated
    between operators (`granstudy.evolution.frames.scaled_collisions`); ``rtol`` and the conservation of
    energy are then excluded.
    """
    if solver.traits.by_particles and (settings.rescaled or settings.conserve):
        raise ValueError(
            f"frame={settings.frame!r}, conserve={settings.conserve!r}: method {solver.method!r} needs "
            "neither; particles keep mass and momentum, and cool without a grid"
        )
    if not (settings.rescaled and callable(scene.restitution)):
        return
    if "energy" in settings.conserve:
        raise ValueError(
            f"conserve={settings.conserve!r}: not energy where frame='rescaled' changes the scale of "
            f"restitution={scene.restitution!r}; leave 'energy' out"
        )
    if solver.rtol is not None:
        raise ValueError(
            f"rtol={solver.rtol!r}: not where a rescaled frame changes the scale of "
            f"restitution={scene.restitution!r}; give N_rho and M_sph (M_cir)"
        )


def invariants(conserve: Sequence[str]) -> tuple[str, ...]:
    """Invariants to conserve in the order of `INVARIANTS`; ValueError for an unknown name."""
    if isinstance(conserve, str) or not isinstance(conserve, Sequence):
        allowed = ", ".join(INVARIANTS)
        raise ValueError(f"conserve={conserve!r}: must be a sequence out of {allowed}")
    for name in conserve:
        if not isinstance(name, str) or name not in INVARIANTS:
            raise unknown_name("invariant in conserve", name, INVARIANTS)
    return tuple(name for name in INVARIANTS if name in conserve)


def step_count(t_final: float, dt: float) -> int:
    """Number of steps of size ``dt``; ValueError where ``t_final`` is not a whole number of steps."""
    for field, value in (("t_final", t_final), ("dt", dt)):
        check_positive(field, value)
    if t_final > MOST_STEPS * dt:
        raise ValueError(
            f"dt={dt!r}: t_final={t_final!r} would take more than {MOST_STEPS:,} steps; take a larger dt, or "
            "time_rtol"
        )
    steps = round(t_final / dt)
    if steps < 1 or abs(steps * dt - t_final) > 1e-9 * t_final:
        raise ValueError(f"dt={dt!r}: t_final={t_final!r} must be a whole number of steps")
    return steps


def check_outputs(settings: TimeSettings) -> None:
    """Raise ValueError, before any step, where memory cannot hold what is recorded at every output."""
    if settings.dt is not None:
        needed = 8.0 * NUMBERS_AN_OUTPUT * settings.steps
        check_memory(
            f"t_final={settings.t_final!r}, dt={settings.dt!r}",
            needed,
            "take a larger dt, or time_rtol",
        )


def _numbers(values: object) -> np.ndarray:
    """Numbers as an array of floats; an array of no axis where they are none."""
    try:
        found = np.asarray(values)
    except ValueError:  # lists of different lengths
        return np.array(np.nan)
    return found.astype(float) if found.dtype.kind in "iuf" else np.array(np.nan)
