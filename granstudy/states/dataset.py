"""The dataset of a cooling or heated state."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.datasets.run_dataset import on_scaled_velocities, stamped
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.states.equation import Gas, SteadyEquation
from granstudy.states.newton import Solution
from granstudy.states.tail import tail_slope
from granstudy.trust.flags import Status
from granstudy.trust.health import HEALTH_NAMES, trust_variable, verdict
from granstudy.velocity.moments import COMPONENTS
from granstudy.velocity.space import VelocitySpace


def state_dataset(
    ds: xr.Dataset,
    scene: Scene,
    solver: Solver,
    reason: str,
    health: dict[str, float],
    title: str,
) -> xr.Dataset:
    """The variables of a state that was solved for, with a run's coordinates, health and attributes.

    ``reason``: why it is no state, empty where it is one. ``health`` by the names of `HEALTH_NAMES`.
    """
    status = Status.FAILED if reason else Status.OK
    measured = {
        variable: ((), health[name], {"long_name": long_name, "units": "1"})
        for name, (variable, long_name) in HEALTH_NAMES.items()
        if name in health
    }
    _, warnings = verdict([health], "")
    ds = ds.assign(measured | trust_variable([health], reason))
    return stamped(ds, scene, solver, None, status, reason, warnings, title, ())


LONG_NAMES = {
    "density": "density ρ",
    "velocity": "bulk velocity u",
    "temperature": "temperature T",
    "a2": "kurtosis excess a2",
    "a3": "sixth-order Sonine coefficient a3 = 1 + 3a2 − ⟨|v−u|⁶⟩/(d(d+2)(d+4)T³)",
    "cooling_rate": "rate −T'/T of the cooling by collisions",
    "cooling_coefficient": "K of the cooling by collisions, T' = −ρK T^{1+λ/2}",
    "velocity_scale": "velocity scale θ, v = u + θc",
    "mass_loss": "rate at which mass leaves the grid, over s: what is put back in the shape of g",
    "minimum": "smallest value of the density on the grid",
}


def state_variables(
    scene: Scene, gas: Gas, equation: SteadyEquation, found: Solution, heated: bool
) -> tuple[xr.Dataset, str]:
    """The state as labelled variables, and why it is none."""
    grid, exponent = equation.grid, scene.kernel.exponent
    g, s, m = equation.split(found.x)
    reason = found.reason
    # T_Q = 2sT_g balances ∇c·(c g), T_Q = −2s balances Δg: collisions cool where s < 0, s > 0.
    cooling_rate = 2.0 * s / gas.temperature if heated else -2.0 * s
    if not reason and cooling_rate <= 0.0:
        reason = f"the density found is heated by collisions, −T'/T = {cooling_rate:.3g}"
    K = cooling_rate / (gas.density * gas.temperature ** (exponent / 2))
    theta = float((scene.diffusion / s) ** (1.0 / (2.0 + exponent))) if heated and s > 0.0 else 1.0
    power = 1.0 + exponent / 2 if heated else exponent
    tail = tail_slope(g, grid, gas.temperature, power)
    a2, a3 = theory.sonine_coefficients(_even_moments(g, grid))
    values: dict[str, Any] = {
        "density": gas.density,
        "velocity": gas.velocity,
        "temperature": theta**2 * gas.temperature,
        "a2": a2,
        "a3": a3,
        "cooling_rate": theta**exponent * cooling_rate,
        "cooling_coefficient": K,
        "velocity_scale": theta,
        "mass_loss": m / s,
        "minimum": float(g.min()),
    }
    dimensions = {"velocity": ("component",)}
    attributes = {"long_name": "density g = θ^d f over c = (v−u)/θ", "units": "1"}
    held = xr.Dataset({"g": (grid.axes, g, attributes)}, coords=grid.coordinates())
    ds = on_scaled_velocities(held, grid.axes).assign(
        {
            name: (dimensions.get(name, ()), values[name], {"long_name": long_name, "units": "1"})
            for name, long_name in LONG_NAMES.items()
        }
    )
    against = "ln c" if power == 0.0 else f"c^{power:g}"
    ds["tail_slope"] = (
        "tail_speed",
        tail.slopes,
        {
            "long_name": f"−d ln g/d {against} between nodes where g is above the error's floor",
            "units": "1",
            "power": power,
            "floor": tail.floor,
        },
    )
    ds["residual"] = (
        "iteration",
        np.array(found.sizes),
        {"long_name": "largest residual over that of what balances collisions", "units": "1"},
    )
    ds = ds.assign_coords(
        component=list(COMPONENTS[: grid.dim]),
        tail_speed=("tail_speed", tail.speeds, {"long_name": "|v−u|/√T", "units": "1"}),
        iteration=np.arange(len(found.sizes)),
    )
    return ds, reason


def _even_moments(g: np.ndarray, grid: VelocitySpace) -> np.ndarray:
    """⟨|c|^{2n}⟩ over their value for a Gaussian of the same temperature, n = 0..3."""
    d = grid.dim
    c2 = np.broadcast_to(np.asarray(sum(np.square(v) for v in grid.velocities())), grid.shape)
    M = np.array([np.sum(c2**n * g * grid.measure) for n in range(4)])
    T = M[1] / (d * M[0])
    gaussian = np.array([1.0, d * T, d * (d + 2) * T**2, d * (d + 2) * (d + 4) * T**3])
    return np.asarray(M / M[0] / gaussian)
