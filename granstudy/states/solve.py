"""The states that granular gases approach, cooling and heated, solved for directly (docs/states.md)."""

import numpy as np
import xarray as xr

from granstudy.collision import collision_operator, concrete
from granstudy.collision.protocol import wisdom_attributes
from granstudy.datasets.run_dataset import Header
from granstudy.evolution.unknowns import representation
from granstudy.model.densities import Maxwellian
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.states.dataset import state_dataset
from granstudy.states.equation import SteadyEquation, gas_of
from granstudy.states.newton import DENSE, Solution, newton
from granstudy.support.checks import check_count, is_real
from granstudy.support.machine import one_blas_thread
from granstudy.support.progress import Progress, watched
from granstudy.trust.changes import change_of_moments
from granstudy.trust.error_estimate import a2_relaxation, imbalance
from granstudy.trust.health import state_of_health
from granstudy.trust.pair_rates import CollisionRates
from granstudy.velocity.moments import moment_values

STEPS = 4
"""Steps of Newton's method, about."""

VECTORS = 40
"""Vectors of GMRES in a step of Newton's method, about; each takes two evaluations of Q."""


SECONDS, SECONDS_PER_CUBE = 0.03, 5.0e-7
"""Seconds of a state beside evaluations of Q: whatever its size, and over N³ (exact steps)."""


def cooling_state(
    scene: Scene,
    solver: Solver,
    tolerance: float = 1e-9,
    max_iterations: int = 20,
    progress: Progress = None,
) -> xr.Dataset:
    """`granstudy.cooling_state` with a solver; parameters and errors are explained there."""
    return _state(scene, solver, False, tolerance, max_iterations, progress)


def heated_state(
    scene: Scene,
    solver: Solver,
    tolerance: float = 1e-9,
    max_iterations: int = 20,
    progress: Progress = None,
) -> xr.Dataset:
    """`granstudy.heated_state` with a solver; parameters and errors are explained there."""
    return _state(scene, solver, True, tolerance, max_iterations, progress)


FIND = {"cooling": cooling_state, "heated": heated_state}
"""The function that finds a state, by the state's name in study files."""


def check_state(scene: Scene, solver: Solver, heated: bool) -> None:
    """Raise ValueError for a scene without a cooling or heated state, or a solver that cannot find it."""
    if callable(scene.restitution):
        raise ValueError(
            f"restitution={scene.restitution!r}: must be a number between 0 and 1, not a law of the "
            "impact speed"
        )
    if scene.restitution == 1.0:
        raise ValueError("restitution=1.0: must be below 1, as elastic collisions take no energy")
    if heated and scene.diffusion == 0.0:
        raise ValueError(
            "diffusion=0.0: must be positive for a heated state, or take cooling_state"
        )
    if not heated and scene.diffusion != 0.0:
        raise ValueError(
            f"diffusion={scene.diffusion!r}: a cooling state has none; give diffusion=0, or take "
            "heated_state"
        )
    _check_solver(solver)


def gaussian_scene(scene: Scene, temperature: float = 1.0) -> Scene:
    """The scene that the operator of a state is made for: a Maxwellian gas at u = 0, with full symmetry."""
    gaussian = Maxwellian(scene.dim, temperature)
    return Scene(scene.dim, gaussian, scene.kernel, scene.restitution, scene.diffusion)


def state_evaluations(solver: SizedSolver) -> int:
    """Evaluations of Q for finding a state, within a factor 3 (docs/states.md §2)."""
    if solver.traits.radial and solver.N + 2 <= DENSE:
        return 2 * STEPS * (solver.N + 2)
    return 2 * STEPS * VECTORS


def solving_seconds(solver: SizedSolver) -> float:
    """Seconds of finding a state beside evaluations of Q, about."""
    exact = solver.traits.radial and solver.N + 2 <= DENSE
    return SECONDS + SECONDS_PER_CUBE * solver.N**3 * exact


@one_blas_thread()
def _state(
    scene: Scene,
    solver: Solver,
    heated: bool,
    tolerance: float,
    max_iterations: int,
    progress: Progress,
) -> xr.Dataset:
    """Solve for the heated, or the cooling state."""
    check_state(scene, solver, heated)
    _check_settings(tolerance, max_iterations)
    choice = concrete(gaussian_scene(scene), solver)
    gas = gas_of(scene, solver)
    gaussian = gaussian_scene(scene, gas.temperature)
    operator = collision_operator(gaussian, choice.solver)
    grid = operator.grid
    equation = SteadyEquation(
        grid, operator, grid.laplacian if heated else grid.dilation,
        representation(operator, gaussian.symmetry).symmetrise, gas.density, gas.temperature,
    )  # fmt: skip
    start = equation.start(gas.density * gaussian.density(grid))
    # `newton` looks for overflow and NaN of iterates that run away.
    with (
        np.errstate(over="ignore", invalid="ignore", divide="ignore"),
        watched(progress, max_iterations) as report,
    ):
        found = newton(equation, start, tolerance, max_iterations, report)
    examined = _health(gaussian, equation, found, heated)
    header = Header.of("heated state" if heated else "cooling state", scene, choice)
    ds = state_dataset(header, gas, equation, found, examined, heated)
    return ds.assign_attrs(wisdom_attributes(operator))


def _check_solver(solver: Solver) -> None:
    """Raise ValueError for a solver that cannot find a state.

    A tolerance is met for the density that the quadrature is planned with, not for the state.
    """
    if solver.traits.by_particles:
        raise ValueError(
            f"method={solver.method!r}: particles have no equation to solve; take another method"
        )
    if solver.N is None:
        raise ValueError("N=None: a state is not known before it is found; give N and R")
    if solver.rtol is not None and not (solver.traits.radial or solver.traits.chooses):
        raise ValueError(
            f"rtol={solver.rtol!r}: holds for a density that is known; give N_rho and M_sph (M_cir)"
        )


def _check_settings(tolerance: object, max_iterations: object) -> None:
    """Raise ValueError for a bad tolerance or number of steps."""
    if not is_real(tolerance) or not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance={tolerance!r}: must be a number between 0 and 1")
    check_count("max_iterations", max_iterations)


def _health(
    scene: Scene, equation: SteadyEquation, found: Solution, heated: bool
) -> dict[str, float]:
    """Signs of a density that the grid cannot hold, and estimated errors of T and a2.

    Energy and fourth moment change by Q at other rates than by all pairs of g. The error of a steady state
    is the difference of these rates, over the rate at which errors decay (docs/method.md §10).
    """
    grid, exponent = equation.grid, scene.kernel.exponent
    g, _, _ = equation.split(found.x)
    values = moment_values(g, grid)
    found_rates = change_of_moments(grid, g, equation.collisions(g))
    off = imbalance(CollisionRates(scene, grid), g, found_rates)
    cooling = abs(off.cooling)
    heating = cooling if heated else 0.0
    output = state_of_health(g, values, values, grid)
    relaxation = off.frequency * a2_relaxation(scene.restitution, grid.dim, exponent)
    output["a2"] = abs(off.a2) / (2 * heating + relaxation)
    if heated:
        output["temperature"] = abs(off.temperature) / (cooling * (1 + exponent / 2))
    return output
