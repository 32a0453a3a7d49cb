"""The states that granular gases approach, solved for directly: cooling, and heated (docs/states.md)."""

import numpy as np
import xarray as xr

from granstudy.collision import collision_operator, concrete
from granstudy.datasets.run_dataset import Header
from granstudy.evolution.unknowns import representation
from granstudy.model.densities import Maxwellian
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver, Solver
from granstudy.states.dataset import state_dataset
from granstudy.states.equation import SteadyEquation, gas_of
from granstudy.states.newton import DENSE, Solution, newton
from granstudy.theory.checks import check_restitution
from granstudy.trust.error_estimate import SLOWEST, imbalance
from granstudy.trust.health import state_of_health
from granstudy.trust.pair_rates import CollisionRates
from granstudy.velocity.moments import moment_values

STEPS = 4
"""Steps of Newton's method, about."""

VECTORS = 40
"""Vectors of GMRES in such a step, about: each takes two evaluations of Q."""


def cooling_state(
    scene: Scene, solver: Solver, *, tolerance: float = 1e-9, max_iterations: int = 20
) -> xr.Dataset:
    """The homogeneous cooling state: f = θ^{−d} g((v−u)/θ) with a g that stays as it is.

    It solves Q(g,g) + (θ'/θ) ∇c·(c g) = 0 at the density, bulk velocity and temperature that the scene's
    initial density has on the grid; that temperature alone decides how much of g the grid holds. θ = 1.

    Parameters
    ----------
    scene : Scene
        With a constant e < 1 and ε = 0.
    solver : Solver
        Of any method; where ``method="auto"``, `radial` is taken, as the state is isotropic. No ``rtol`` but
        with these two.
    tolerance : float
        Largest residual over the largest value of (θ'/θ)∇c·(c g).
    max_iterations : int
        Steps of Newton's method after which to give up.

    Returns
    -------
    xarray.Dataset
        `g` over the scaled velocities; `temperature`, `a2`, `a3`, `cooling_rate` and others; `tail_slope`
        over ``tail_speed`` = |v−u|/√T: of −ln f against c^λ, against ln c where λ = 0; `residual` over
        ``iteration``; `status`, failed with the reason where none was found: the last iterate is then
        given as it is. `trust` and its reasons, and attributes, as those of a run.

    Raises
    ------
    ValueError
        For a scene that has no such state, or a solver that cannot find it, before any work starts.
    """
    return _state(scene, solver, False, tolerance, max_iterations)


def heated_state(
    scene: Scene, solver: Solver, *, tolerance: float = 1e-9, max_iterations: int = 20
) -> xr.Dataset:
    """The steady state of a gas heated by diffusion, Q(f,f) + εΔf = 0.

    f = θ^{−d} g((v−u)/θ), where Q(g,g) + sΔg = 0 at the temperature T_g of the scene's initial density on
    the grid and θ^{2+λ} = ε/s; so T = θ²T_g comes out, and the grid holds the state whatever ε.

    Parameters, what is returned and raised are those of `cooling_state`, but that ε must be above 0, and
    `tail_slope` is that of −ln f against c^{1+λ/2}.
    """
    return _state(scene, solver, True, tolerance, max_iterations)


FIND = {"cooling": cooling_state, "heated": heated_state}
"""What finds a state, by its name in study files."""


def check_state(scene: Scene, solver: Solver, heated: bool) -> None:
    """Raise ValueError for a scene that has no such state, or a solver that cannot find it."""
    check_restitution(scene.restitution)  # type: ignore[arg-type]
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
    """What a state's operator is planned for: an isotropic gas at u = 0, with all its symmetry."""
    gaussian = Maxwellian(scene.dim, temperature)
    return Scene(scene.dim, gaussian, scene.kernel, scene.restitution, scene.diffusion)


def state_evaluations(solver: SizedSolver) -> int:
    """Evaluations of Q that finding a state takes, within a factor 3 (docs/states.md §2)."""
    if solver.traits.radial and solver.N + 2 <= DENSE:
        return 2 * STEPS * (solver.N + 2)
    return 2 * STEPS * VECTORS


def _state(
    scene: Scene, solver: Solver, heated: bool, tolerance: float, max_iterations: int
) -> xr.Dataset:
    check_state(scene, solver, heated)
    _check_settings(tolerance, max_iterations)
    gas = gas_of(scene, solver)
    gaussian = gaussian_scene(scene, gas.temperature)
    choice = concrete(gaussian, solver)
    operator = collision_operator(gaussian, choice.solver)
    grid = operator.grid
    equation = SteadyEquation(
        grid, operator, grid.laplacian if heated else grid.dilation,
        representation(operator, gaussian.symmetry).symmetrise, gas.density, gas.temperature,
    )  # fmt: skip
    start = equation.start(gas.density * gaussian.density(grid))
    # Overflow and NaN of iterates that run away are looked for by `newton`.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        found = newton(equation, start, tolerance, max_iterations)
    examined = _health(gaussian, equation, found, heated)
    header = Header.of("heated state" if heated else "cooling state", scene, choice)
    return state_dataset(header, gas, equation, found, examined, heated)


def _check_solver(solver: Solver) -> None:
    """A tolerance is met for the density that the quadrature is planned with: not that of the state."""
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
    if not isinstance(tolerance, (int, float)) or not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance={tolerance!r}: must be a number between 0 and 1")
    if not isinstance(max_iterations, int) or max_iterations < 1:
        raise ValueError(f"max_iterations={max_iterations!r}: must be a positive integer")


def _health(
    scene: Scene, equation: SteadyEquation, found: Solution, heated: bool
) -> dict[str, float]:
    """Signs of a density that the grid cannot hold, and what T and a2 may be off by.

    Q of g does not change energy and fourth moment as all pairs of g would. What a steady state is off by
    is that rate over the one at which it is forgotten (docs/method.md §10).
    """
    grid, exponent = equation.grid, scene.kernel.exponent
    g, _, _ = equation.split(found.x)
    values = moment_values(g, grid)
    off = imbalance(CollisionRates(scene, grid), g, equation.collisions(g))
    cooling = abs(off.cooling)
    heating = cooling if heated else 0.0
    output = state_of_health(g, values, values, grid)
    output["a2"] = abs(off.a2) / (2 * heating + SLOWEST[grid.dim] * off.frequency)
    if heated:
        output["temperature"] = abs(off.temperature) / (cooling * (1 + exponent / 2))
    return output
