"""How a run goes through time: how long, in which steps and scheme, in which frame, what it conserves."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.evolution.schemes import SCHEMES
from granstudy.model.restitution import Restitution
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.support.checks import check_positive
from granstudy.support.errors import unknown_name
from granstudy.velocity.space import INVARIANTS

FRAMES = ("fixed", "rescaled")

FIRST_TIME = 1e-2
"""First output of an adaptive run, where t_final is a hundred times as long or more."""

PER_DECADE = 10
"""Outputs a decade of an adaptive run."""


@dataclass(frozen=True, init=False)
class TimeSettings:
    """How a run goes through time; see `granstudy.simulate`.

    Raises
    ------
    ValueError
        If a field is not what `granstudy.simulate` allows; the message names field, value and allowed.
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
        if frame not in FRAMES:
            raise unknown_name("frame", frame, FRAMES)
        if scheme is None:
            scheme = "rk3" if time_rtol is None else "dopri54"
        if scheme not in SCHEMES:
            raise unknown_name("scheme", scheme, list(SCHEMES))
        if save_every is not None and (not isinstance(save_every, int) or save_every < 1):
            raise ValueError(f"save_every={save_every!r}: must be a positive integer or None")
        fields: dict[str, Any] = {
            "t_final": t_final,
            "dt": dt,
            "time_rtol": time_rtol,
            "times": times,
        }
        fields |= {"frame": frame, "scheme": scheme, "conserve": invariants(conserve)}
        for name, value in (fields | {"save_every": save_every}).items():
            object.__setattr__(self, name, value)
        if time_rtol is not None:
            self._check_adaptive()
            return
        _ = self.steps
        if times is not None:
            raise ValueError(
                f"times={times!r}: only with time_rtol; with dt every step is an output"
            )

    def _check_adaptive(self) -> None:
        rtol = self.time_rtol
        check_positive("time_rtol", rtol)
        assert rtol is not None
        if not 1e-13 <= rtol < 1.0:
            raise ValueError(f"time_rtol={rtol!r}: must be a number between 1e-13 and 1")
        if self.times is not None:
            times = np.asarray(self.times, dtype=float)
            if times.ndim != 1 or not np.all(np.diff(times, prepend=0.0) > 0.0):
                raise ValueError(f"times={self.times!r}: must be positive and increase")
            if times.size and times[-1] > self.t_final:
                raise ValueError(
                    f"times={self.times!r}: the last must be t_final={self.t_final!r} at most"
                )

    @property
    def rescaled(self) -> bool:
        """Whether velocities are scaled with the gas."""
        return self.frame == "rescaled"

    @property
    def steps(self) -> int:
        """Number of steps of the size ``dt``."""
        assert self.dt is not None
        return step_count(self.t_final, self.dt)

    @property
    def outputs(self) -> np.ndarray:
        """Times of an adaptive run's outputs, 0 and t_final among them."""
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
        """Times at which moments are recorded."""
        if self.time_rtol is not None:
            return self.outputs
        assert self.dt is not None
        return self.dt * np.arange(self.steps + 1)

    def coordinates(self) -> dict[str, Any]:
        """What a dataset says of it, by scalar coordinate."""
        step = {"dt": self.dt} if self.time_rtol is None else {"time_rtol": self.time_rtol}
        conserve = "-".join(self.conserve) or "none"
        return {"frame": self.frame, "scheme": self.scheme, "conserve": conserve, **step}


def invariants(conserve: Sequence[str]) -> tuple[str, ...]:
    """Invariants to conserve in the order of `INVARIANTS`, or ValueError for another name."""
    if isinstance(conserve, str) or not isinstance(conserve, Sequence):
        allowed = ", ".join(INVARIANTS)
        raise ValueError(f"conserve={conserve!r}: must be a sequence out of {allowed}")
    for name in conserve:
        if name not in INVARIANTS:
            raise unknown_name("invariant in conserve", name, INVARIANTS)
    return tuple(name for name in INVARIANTS if name in conserve)


def step_count(t_final: float, dt: float) -> int:
    """Number of steps, or ValueError where ``t_final`` is not a whole number of them."""
    for field, value in (("t_final", t_final), ("dt", dt)):
        check_positive(field, value)
    steps = round(t_final / dt)
    if steps < 1 or abs(steps * dt - t_final) > 1e-9 * t_final:
        raise ValueError(f"dt={dt!r}: t_final={t_final!r} must be a whole number of steps")
    return steps


def check_conserve(conserve: Sequence[str], restitution: Restitution, frame: str) -> None:
    """Raise ValueError for the energy of particles whose restitution changes with the frame's scale."""
    if "energy" in conserve and callable(restitution) and frame == "rescaled":
        raise ValueError(
            f"conserve={tuple(conserve)!r}: not energy where frame='rescaled' changes the scale of "
            f"restitution={restitution!r}; leave 'energy' out"
        )


def check_frame(scene: Scene, solver: Solver, settings: TimeSettings) -> None:
    """Raise ValueError for what a frame or conservation cannot do with a scene and a solver."""
    if solver.traits.by_particles and (settings.frame != FRAMES[0] or settings.conserve):
        raise ValueError(
            f"frame={settings.frame!r}, conserve={settings.conserve!r}: method {solver.method!r} needs "
            "neither; particles keep mass and momentum, and cool without a grid"
        )
    check_conserve(settings.conserve, scene.restitution, settings.frame)
    if settings.rescaled and callable(scene.restitution) and solver.rtol is not None:
        raise ValueError(
            f"rtol={solver.rtol!r}: not where a rescaled frame changes the scale of "
            f"restitution={scene.restitution!r}; give N_rho and M_sph (M_cir)"
        )
