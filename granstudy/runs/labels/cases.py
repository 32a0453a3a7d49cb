"""Random runs: gases, grids, methods and steps, good and bad, each known by its seed.

Every run can be computed, but for a tolerance that its grid cannot hold: such a run fails, and says why.
Sizes are small, so that a thousand runs take half an hour on two cores.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from granstudy.model.densities import Maxwellian, named_density
from granstudy.model.kernel import VHS, hard_spheres
from granstudy.model.restitution import Restitution, Viscoelastic
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.labels.gaussians import Gaussians, StatedGaussians, known_moments
from granstudy.runs.labels.truths import width

Rng = np.random.Generator

METHODS = {
    "radial": 0.36,
    "auto": 0.1,
    "fast": 0.26,
    "literal": 0.06,
    "direct": 0.06,
    "carleman": 0.06,
    "dsmc": 0.1,
}
"""Methods, and how often each occurs."""

ANISOTROPIC = ("gaussians", "two_beams", "double_well", "moving", "three_gaussians")
ISOTROPIC = ("gaussians", "maxwellian", "bkw", "power_law", "uniform_ball")
"""Families of densities; ``moving`` is a Maxwellian with a bulk velocity."""

CONSERVED = (("mass",), ("mass", "momentum"), ("mass", "energy"), ("mass", "momentum", "energy"))
"""What a run may conserve."""

STEADY = 3.0
"""Time after which a heated gas no longer grows by much."""

T = TypeVar("T")


@dataclass(frozen=True)
class Case:
    """A random run.

    Attributes
    ----------
    scene : Scene
    solver : Solver
    time : mapping
        How it goes through time, as `granstudy.simulate` takes it.
    """

    scene: Scene
    solver: Solver
    time: Mapping[str, Any]


def random_case(seed: int) -> Case:
    """The random run of a seed."""
    rng = np.random.default_rng(seed)
    method = str(rng.choice(list(METHODS), p=list(METHODS.values())))
    cartesian = method not in ("radial", "dsmc")
    dim = 3 if rng.random() < (0.3 if cartesian else 0.5) else 2
    scene = _scene(rng, method, dim)
    is_large = cartesian and dim == 3
    t_final = _one(rng, (0.2, 0.5) if is_large else (0.2, 1.0, 3.0))
    if method == "radial" and rng.random() < 0.12:
        t_final = 30.0
    solver = _solver(rng, method, scene, _reach(rng, scene, t_final), seed)
    time = _time(rng, t_final, is_large)
    if method != "dsmc":
        time |= _frame(rng, scene, solver)
    return Case(scene, solver, time)


def _one(rng: Rng, values: Sequence[T]) -> T:
    """One of the values."""
    return values[int(rng.integers(len(values)))]


def _uniform(rng: Rng, low: float, high: float) -> float:
    """A number between two others, to three digits after the point."""
    return round(float(rng.uniform(low, high)), 3)


def _scene(rng: Rng, method: str, dim: int) -> Scene:
    """A gas that the method can do."""
    exponent = float(rng.choice([0.0, 0.5, 1.0], p=[0.45, 0.15, 0.4]))
    restitution: Restitution = _one(rng, (0.0, 0.3, 0.6, 0.9, 1.0, _uniform(rng, 0.0, 1.0)))
    if method == "carleman" and exponent != dim - 2:
        restitution = 1.0
    if method not in ("radial", "carleman") and rng.random() < 0.06:
        restitution = Viscoelastic(_one(rng, (0.05, 0.2)))
    diffusion = _one(rng, (0.0, 0.0, 0.02, 0.2, _uniform(rng, 0.0, 0.4)))
    kernel = VHS(exponent, hard_spheres(dim).strength)
    return Scene(dim, _density(rng, dim, method), kernel, restitution, diffusion)


def _density(rng: Rng, dim: int, method: str) -> Any:
    """A named density with random parameters, or a sum of Gaussians, of T = 1 about."""
    isotropic = method == "radial" or rng.random() < 0.4
    family = (
        str(rng.choice(ISOTROPIC, p=[0.35, 0.25, 0.2, 0.1, 0.1]))
        if isotropic
        else _one(rng, ANISOTROPIC[: dim + 2])
    )
    temperature = _one(rng, (0.5, 1.0, 2.0))
    if family == "gaussians":
        return _gaussians(rng, dim, isotropic)
    if family == "moving":
        velocity = tuple(_uniform(rng, -1.0, 1.0) for _ in range(dim))
        return Maxwellian(dim, temperature, velocity)
    words: dict[str, float] = {}
    if family in ("maxwellian", "power_law", "uniform_ball"):
        words["temperature"] = temperature
    if family == "power_law":
        words["tail"] = _one(rng, (10.0, 12.0, 20.0))
    if family == "two_beams":
        words = {"separation": _uniform(rng, 1.0, 4.0), "temperature": _uniform(rng, 0.3, 1.0)}
    return named_density(f"{family}{dim}d")(**words)


def _gaussians(rng: Rng, dim: int, isotropic: bool) -> Gaussians:
    """Two Gaussians of mean 0, which state their moments or not."""
    m, s = _uniform(rng, 0.2, 0.8), _uniform(rng, 0.3, 1.2)
    rest = (0.0,) * (dim - 1)
    centres = ((0.0, *rest),) * 2
    if not isotropic:
        offset = _uniform(rng, 0.3, 1.5)
        centres = ((offset * (1 - m), *rest), (-offset * m, *rest))
    kind = _one(rng, (Gaussians, StatedGaussians))
    return kind((m, 1 - m), centres, (s, _uniform(rng, 0.6, 1.4)))


def _reach(rng: Rng, scene: Scene, t_final: float) -> float:
    """R: from far too small to ample."""
    velocity = float(np.linalg.norm(known_moments(scene).velocity))
    return round(width(scene, min(t_final, STEADY)) * float(rng.uniform(5.0, 11.0)) + velocity, 2)


def _solver(rng: Rng, method: str, scene: Scene, R: float, seed: int) -> Solver:
    """Grid and quadrature, from far too coarse to ample."""
    make = {"radial": _radial, "dsmc": _particles}.get(method, _cartesian)
    return make(rng, method, scene, R, seed)


def _radial(rng: Rng, method: str, scene: Scene, R: float, seed: int) -> Solver:
    return Solver(N=_one(rng, (12, 16, 20, 24, 32, 40)), R=R, method=method)


def _particles(rng: Rng, method: str, scene: Scene, R: float, seed: int) -> Solver:
    particles = _one(rng, (10_000, 40_000, 100_000))
    N = 32 if scene.dim == 2 else 24
    return Solver(N=N, R=max(R, 7.0), method=method, particles=particles, seed=seed)


SIZES: dict[str, dict[int, Sequence[int]]] = {
    "auto": {2: (16, 24, 32), 3: (12, 16, 20)},
    "fast": {2: (16, 24, 32), 3: (12, 16, 20, 24)},
    "literal": {2: (16, 24), 3: (8, 12)},
    "direct": {2: (12, 16, 24), 3: (8, 10)},
    "carleman": {2: (16, 24, 32), 3: (12, 16)},
}
"""N of methods on Cartesian grids, by dimension."""


def _cartesian(rng: Rng, method: str, scene: Scene, R: float, seed: int) -> Solver:
    fields: dict[str, Any] = {"N": _one(rng, SIZES[method][scene.dim]), "R": R, "method": method}
    if method != "carleman":
        fields["variant"] = _one(rng, ("full", "separate"))
    if method in ("fast", "auto") and rng.random() < 0.3:
        fields["N"] = {2: 32, 3: 16}[scene.dim]
        tolerances = {2: (1e-1, 1e-2, 1e-3), 3: (1e-1, 1e-2)}[scene.dim]
        return Solver(**fields, rtol=_one(rng, tolerances), dealias=rng.random() < 0.7)
    if scene.dim == 2:
        nodes = _one(rng, (6, 10, 16, 24))
        return Solver(**fields, N_rho=nodes, M_cir=nodes)
    nodes = _one(rng, (6, 10, 14))
    return Solver(**fields, N_rho=nodes, M_sph=_one(rng, (6, 12, 32)))


def _time(rng: Rng, t_final: float, is_large: bool) -> dict[str, Any]:
    """Steps, from far too long to ample."""
    if rng.random() < 0.5:
        steps = (5, 10) if is_large else (5, 10, 30) if t_final <= 3.0 else (50, 100, 300)
        return {"t_final": t_final, "dt": t_final / _one(rng, steps)}
    tolerances = (1e-2, 1e-4) if is_large else (1e-2, 1e-4, 1e-7)
    inner = [t_final / 4, t_final / 2]
    return {"t_final": t_final, "time_rtol": _one(rng, tolerances), "times": inner}


def _frame(rng: Rng, scene: Scene, solver: Solver) -> dict[str, Any]:
    """Frame, scheme and what is conserved."""
    scheme = _one(rng, ("rk3", "dopri54", "exponential"))
    law = callable(scene.restitution)
    rescaled = rng.random() < 0.5 and not (law and solver.rtol is not None)
    found = {"frame": "rescaled" if rescaled else "fixed", "scheme": scheme}
    left_out = {"momentum"} if solver.method in ("radial", "auto") else set()
    if law and rescaled:
        left_out.add("energy")
    conserve = _one(rng, [names for names in CONSERVED if not left_out.intersection(names)])
    return {**found, "conserve": conserve} if rng.random() < 0.3 else found
