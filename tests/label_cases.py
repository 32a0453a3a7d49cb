"""Random runs whose true errors are known, to hold labels and estimates against.

``python tests/label_cases.py COUNT [FIRST]`` makes COUNT runs from the seed FIRST on, and prints a line a run
and the runs that break a rule. The rules (docs/method.md §10):

1. no trusted run has an error above 1% in T or 0.01 in a2;
2. no untrusted run has both errors below 1e-6;
3. where an error is above 1e-6, the estimate is not below a third of it, and not above a hundred times it;
   an error above 0.1, of a run that is lost, counts as 0.1 here.
"""

import sys
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

import granstudy as gs
from granstudy.model.stated_moments import of_gaussians
from granstudy.trust.flags import Trust
from granstudy.trust.truth import Errors, Truth, errors, maxwell_truth, truth_of_dataset

SMALL = 1e-6
"""Errors below count as none."""

LARGE = Errors(1e-2, 1e-2)
"""Errors of T and a2 that no trusted run may have."""

LOST = 0.1
"""An error above which the gas is lost, and no estimate can tell how far."""

UNDER, OVER = 3.0, 100.0
"""An estimate may be this many times below, and above, the error."""


@dataclass(frozen=True)
class Gaussians:
    """A sum of Gaussians with known moments, which it states only if asked to."""

    masses: tuple[float, ...]
    centres: tuple[tuple[float, ...], ...]
    variances: tuple[float, ...]

    def __call__(self, *v: np.ndarray) -> np.ndarray:
        """The density at the velocities v."""
        total = np.zeros(np.broadcast_shapes(*(np.shape(vi) for vi in v)))
        for m, c, s in zip(self.masses, self.centres, self.variances, strict=True):
            c2 = sum((vi - ci) ** 2 for vi, ci in zip(v, c, strict=True))
            total += m * np.exp(-c2 / (2 * s)) / (2 * np.pi * s) ** (len(v) / 2)
        return total

    def known_moments(self):
        """Moments in closed form."""
        variances = [[s] * len(self.centres[0]) for s in self.variances]
        return of_gaussians(self.masses, self.centres, variances)


@dataclass(frozen=True)
class StatedGaussians(Gaussians):
    """Gaussians that state their moments."""

    @property
    def moments(self):
        """Moments in closed form."""
        return self.known_moments()


@dataclass(frozen=True)
class Case:
    """A run and its truth: another solver, or the exact law."""

    scene: gs.Scene
    solver: gs.Solver
    time: dict[str, Any]
    t_final: float
    fine: gs.Solver | None

    def __str__(self) -> str:
        scene, solver = self.scene, self.solver
        return (
            f"{scene.initial} λ={scene.kernel.exponent:g} e={scene.restitution:g} "
            f"ε={scene.diffusion:g} {solver.method} N={solver.N} R={solver.R:.3g} "
            f"t={self.t_final:.3g} {self.time}"
        )


@dataclass(frozen=True)
class Outcome:
    """What a run says of itself, and the truth."""

    case: Case
    trust: Trust
    ended: bool
    true: Errors
    estimated: Errors
    uncertainty: Errors

    @property
    def broken(self) -> list[str]:
        """The rules that the run breaks."""
        found = []
        if self.trust is Trust.TRUSTED and any(np.greater(self.true, LARGE)):
            found.append("trusted and wrong")
        if self.trust is Trust.UNTRUSTED and self.ended and all(np.less(self.true, SMALL)):
            found.append("untrusted and right")
        names = Errors._fields
        for name, true, estimate, own in zip(
            names, self.true, self.estimated, self.uncertainty, strict=True
        ):
            if not self.ended or true < max(SMALL, 10 * own):
                continue
            if estimate * UNDER < min(true, LOST):
                found.append(f"{name} underestimated: {estimate:.1e} for {true:.1e}")
            if estimate > OVER * true:
                found.append(f"{name} overestimated: {estimate:.1e} for {true:.1e}")
        return found

    def __str__(self) -> str:
        pairs = ", ".join(
            f"{name} {true:.1e} ({estimate:.1e})"
            for name, true, estimate in zip(Errors._fields, self.true, self.estimated, strict=True)
        )
        return f"{self.trust.name.lower():9} {pairs}  {self.case}"


def random_case(seed: int) -> Case:
    """The case of a seed: any scene, λ, e, ε, frame, method, scheme and steps, on grids good and bad."""
    rng = np.random.default_rng(seed)
    isotropic = rng.random() < 0.8
    dim = int(rng.integers(2, 4)) if isotropic else 2
    exponent = float(rng.choice([0.0, 0.5, 1.0], p=[0.4, 0.2, 0.4]))
    e = float(rng.choice([0.0, 0.3, 0.6, 0.9, 1.0]))
    epsilon = float(rng.choice([0.0, 0.0, 0.02, 0.2]))
    law = {
        "kernel": gs.VHS(exponent, gs.hard_spheres(dim).strength),
        "restitution": e,
        "diffusion": epsilon,
    }
    initial = _density(rng, dim, isotropic)
    scene = (
        gs.load_scene(initial, **law)
        if isinstance(initial, str)
        else gs.Scene(dim, initial, **law, symmetry="none")
    )
    t_final = float(rng.choice([0.2, 1.0, 3.0]))
    width = np.sqrt(max(1.0, 1.0 + 2 * epsilon * t_final))
    R = float(np.round(width * rng.uniform(5.0, 11.0), 2))
    time: dict[str, Any] = {"frame": str(rng.choice(["fixed", "rescaled"]))}
    time["scheme"] = str(rng.choice(["rk3", "dopri54", "exponential"]))
    if rng.random() < 0.5:
        time["dt"] = t_final / int(rng.choice([4, 10, 40]))
    else:
        time["time_rtol"] = float(rng.choice([1e-2, 1e-4, 1e-7]))
        time["times"] = [t_final / 4, t_final / 2]
    if rng.random() < 0.3:
        time["conserve"] = ("mass", "energy")
    if isotropic:
        solver = gs.Solver(N=int(rng.choice([12, 16, 20, 24, 32, 40])), R=R, method="radial")
        fine = gs.Solver(N=48, R=round(12.0 * width, 2), method="radial")
    else:
        M = int(rng.choice([6, 10, 16, 24]))
        solver = gs.Solver(N=int(rng.choice([16, 24, 32])), R=R, N_rho=M, M_cir=M, method="fast")
        fine = gs.Solver(N=56, R=round(11.0 * width, 2), N_rho=24, M_cir=28, method="fast")
    return Case(scene, solver, time, t_final, None if exponent == 0.0 else fine)


def _density(rng: np.random.Generator, dim: int, isotropic: bool) -> Any:
    """A named density, or a sum of two Gaussians of mean 0 and T = 1 about."""
    if rng.random() < 0.5:
        names = ["maxwellian", "bkw"] if isotropic else ["two_beams"]
        return f"{rng.choice(names)}{dim}d"
    m = float(rng.uniform(0.2, 0.8))
    s = float(rng.uniform(0.3, 1.2))
    offset = 0.0 if isotropic else float(rng.uniform(0.3, 1.5))
    centres = [(offset * (1 - m),) + (0.0,) * (dim - 1), (-offset * m,) + (0.0,) * (dim - 1)]
    kind = rng.choice([Gaussians, StatedGaussians])
    return kind((m, 1 - m), tuple(centres), (s, float(rng.uniform(0.6, 1.4))))


def outcome(case: Case) -> Outcome:
    """Make the run of a case, and hold it against its truth."""
    ds = gs.simulate(case.scene, case.solver, t_final=case.t_final, progress=False, **case.time)
    truth = _truth(case, ds)
    estimated = Errors(*(float(ds[f"{name}_error_estimate"].max()) for name in Errors._fields))
    uncertainty = Errors(truth.temperature_uncertainty, truth.a2_uncertainty)
    ended = int(ds["status"]) == 0
    return Outcome(case, Trust(int(ds["trust"])), ended, errors(ds, truth), estimated, uncertainty)


def _truth(case: Case, ds: xr.Dataset) -> Truth:
    """The exact law, or a finer run at the run's own times."""
    times = ds["time"].values
    if case.fine is None:
        scene, initial = case.scene, case.scene.initial
        if isinstance(initial, Gaussians):
            fields = (initial.masses, initial.centres, initial.variances)
            scene = gs.Scene(
                scene.dim,
                StatedGaussians(*fields),
                scene.kernel,
                scene.restitution,
                scene.diffusion,
            )
        return maxwell_truth(scene, times)
    rtol = 1e-9 if case.fine.method == "radial" else 1e-7
    inner = times[(times > 0.0) & (times < case.t_final)]
    fine = gs.simulate(
        case.scene, case.fine, t_final=case.t_final, time_rtol=rtol, times=inner, progress=False
    )
    return truth_of_dataset(fine)


def main(count: int, first: int = 0) -> None:
    """Make runs, print each, and the rules broken."""
    broken = 0
    for seed in range(first, first + count):
        found = outcome(random_case(seed))
        broken += bool(found.broken)
        print(seed, found, *found.broken, sep="\n    " if found.broken else "  ", flush=True)
    print(f"{count} runs, {broken} break a rule")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
