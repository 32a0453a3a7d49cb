"""The truth of a random run: an exact law, a finer run, or particles."""

from typing import Any

import numpy as np

from granstudy.model.densities import DoubleWell2D, Maxwellian, PowerLaw, UniformBall
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation
from granstudy.runs.labels.gaussians import known_moments, told
from granstudy.trust.exact_law import has_exact_law
from granstudy.velocity.symmetry import Symmetry

FULLY = "full"
"""Symmetry of a density that is isotropic about v = 0."""

PARTICLES = 1_000_000
"""Particles of a truth."""

LONG = 3.0
"""Final time from which on the frame of a truth follows the gas."""

DETAILED = {True: (64, 9.0), False: (56, 11.0)}
"""N, and R over the thermal speed, of method `fast`: of the narrow beams of `DoubleWell2D`, and of others."""


def width(scene: Scene, t_final: float) -> float:
    """Thermal speed that diffusion alone would lead to."""
    return float(np.sqrt(known_moments(scene).temperature + 2.0 * scene.diffusion * t_final))


def truth_of(run: Computation) -> Computation | None:
    """The evolution that is the truth of another one; None where an exact law is.

    ========================================================  =====================================
    gas                                                       truth
    ========================================================  =====================================
    Maxwell molecules, constant e                             the exact law
    isotropic and smooth, constant e; a moving Maxwellian     `radial`, N = 48
    2D, smooth                                                `fast`, N = 56 or 64
    others                                                    particles, `PARTICLES` of them
    ========================================================  =====================================
    """
    if has_exact_law(run.scene):
        return None
    assert run.time is not None
    scene, settings = _at_rest(told(run.scene)), run.time
    follows = settings.t_final >= LONG and not callable(scene.restitution)
    solver = _solver(scene, width(scene, 0.0 if follows else settings.t_final))
    recorded = settings.recorded
    time: dict[str, Any] = {
        "t_final": settings.t_final,
        "time_rtol": 1e-9 if solver.traits.radial else 1e-7,
        "times": [float(t) for t in recorded if 0.0 < t < settings.t_final],
    }
    if follows and not solver.traits.by_particles:
        time["frame"] = "rescaled"
    return Computation("evolution", scene, solver, time)


def _at_rest(scene: Scene) -> Scene:
    """The scene in velocities in which a Maxwellian does not move."""
    if not isinstance(scene.initial, Maxwellian):
        return scene
    initial = Maxwellian(scene.dim, scene.initial.temperature)
    return Scene(scene.dim, initial, scene.kernel, scene.restitution, scene.diffusion)


def _solver(scene: Scene, speed: float) -> Solver:
    """The solver of a truth, for a gas of that thermal speed on its grid."""
    initial = scene.initial
    smooth = not isinstance(initial, PowerLaw | UniformBall)
    isotropic = scene.symmetry == Symmetry.named(scene.dim, FULLY)
    if smooth and isotropic and not callable(scene.restitution):
        return Solver(N=48, R=round(12.0 * speed, 2), method="radial")
    if smooth and scene.dim == 2:
        N, R = DETAILED[isinstance(initial, DoubleWell2D)]
        return Solver(N=N, R=round(R * speed, 2), N_rho=24, M_cir=28, method="fast")
    N = 64 if scene.dim == 2 else 32
    R = 24.0 if isinstance(initial, PowerLaw) else 12.0
    return Solver(N=N, R=round(R * speed, 2), method="dsmc", particles=PARTICLES)
