"""The dataset of a cooling or heated state."""

from typing import Any

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.datasets.run_dataset import (
    Ending,
    Header,
    on_scaled_velocities,
    stamped,
)
from granstudy.model.scene import Scene
from granstudy.states.equation import Gas, SteadyEquation
from granstudy.states.newton import Solution
from granstudy.states.tail import tail_slope
from granstudy.support.variables import labelled
from granstudy.trust.flags import Status
from granstudy.trust.health import sign_variables, trust_variable, verdict
from granstudy.velocity.moments import A3, COMPONENTS, Quantity
from granstudy.velocity.space import VelocitySpace

QUANTITIES = {
    "density": Quantity("density", symbol=r"$\rho$"),
    "velocity": Quantity("bulk velocity", ("component",), symbol="$u$"),
    "temperature": Quantity("temperature", symbol="$T$"),
    "a2": Quantity("kurtosis excess", symbol="$a_2$"),
    "a3": A3,
    "cooling_rate": Quantity(
        "rate of the cooling by collisions", definition="−T'/T", symbol=r"$-\dot T/T$"
    ),
    "cooling_coefficient": Quantity(
        "coefficient of the cooling by collisions",
        definition="K in T' = −ρK T^{1+λ/2}",
        symbol="$K$",
    ),
    "velocity_scale": Quantity("velocity scale", definition="θ in v = u + θc", symbol=r"$\theta$"),
    "mass_loss": Quantity(
        "rate at which mass leaves the grid, over s: what is put back in the shape of g"
    ),
    "minimum": Quantity("smallest value of the density on the grid"),
}
"""The numbers of a state, and their long names."""


def state_dataset(
    header: Header,
    gas: Gas,
    equation: SteadyEquation,
    found: Solution,
    health: dict[str, float],
    heated: bool,
) -> xr.Dataset:
    """Dataset of a state, with coordinates, health and attributes as of a run.

    Parameters
    ----------
    header : Header
    gas : Gas
        Density, bulk velocity and temperature asked for.
    equation : SteadyEquation
    found : Solution
        The last iterate, and how it was found.
    health : dict
        Signs of health, by the names of `granstudy.trust.health.SIGNS`.
    heated : bool
        Whether the state is the heated one.
    """
    grid, exponent = equation.grid, header.scene.kernel.exponent
    g, _, _ = equation.split(found.x)
    values = state_values(header.scene, gas, equation, found, heated)
    reason = found.reason or _heated_by_collisions(values["cooling_rate"])
    held = xr.Dataset(
        {"g": labelled(g, "density g = θ^d f over c = (v−u)/θ", grid.axes)},
        coords=grid.coordinates(),
    )
    ds = on_scaled_velocities(held, grid.axes).assign(
        {name: quantity.labelled(values[name]) for name, quantity in QUANTITIES.items()}
    )
    ds = ds.assign_coords(component=list(COMPONENTS[: grid.dim]))
    ds = _with_tail(ds, g, grid, gas.temperature, 1.0 + exponent / 2 if heated else exponent)
    ds["residual"] = labelled(
        np.array(found.sizes),
        "largest residual over that of what balances collisions",
        "iteration",
    )
    ds = ds.assign_coords(iteration=np.arange(len(found.sizes)))
    ds = ds.assign(sign_variables(health) | trust_variable([health], reason))
    _, warnings = verdict([health], "")
    status = Status.FAILED if reason else Status.OK
    return stamped(ds, header, Ending(status, reason, warnings))


def state_values(
    scene: Scene, gas: Gas, equation: SteadyEquation, found: Solution, heated: bool
) -> dict[str, Any]:
    """The numbers of a state, by the names of `QUANTITIES`."""
    exponent = scene.kernel.exponent
    g, s, m = equation.split(found.x)
    # T_Q = 2sT_g balances s∇c·(c g): collisions cool at s < 0. T_Q = −2s balances sΔg: they cool at s > 0.
    cooling_rate = 2.0 * s / gas.temperature if heated else -2.0 * s
    theta = float((scene.diffusion / s) ** (1.0 / (2.0 + exponent))) if heated and s > 0.0 else 1.0
    a2, a3 = theory.sonine_coefficients(_even_moments(g, equation.grid))
    return {
        "density": gas.density,
        "velocity": gas.velocity,
        "temperature": theta**2 * gas.temperature,
        "a2": a2,
        "a3": a3,
        "cooling_rate": theta**exponent * cooling_rate,
        "cooling_coefficient": cooling_rate / (gas.density * gas.temperature ** (exponent / 2)),
        "velocity_scale": theta,
        "mass_loss": m / s,
        "minimum": float(g.min()),
    }


def _heated_by_collisions(cooling_rate: float) -> str:
    """Why a solution of the equation is no state; "" where it is one."""
    if cooling_rate <= 0.0:
        return f"the density found is heated by collisions, −T'/T = {cooling_rate:.3g}"
    return ""


def _with_tail(
    ds: xr.Dataset, g: np.ndarray, grid: VelocitySpace, temperature: float, power: float
) -> xr.Dataset:
    """The dataset with local slopes of −ln g against c^power; against ln c where the power is 0."""
    tail = tail_slope(g, grid, temperature, power)
    against = "ln c" if power == 0.0 else f"c^{power:g}"
    ds["tail_slope"] = labelled(
        tail.slopes,
        f"−d ln g/d {against} between nodes where g is above the error's floor",
        "tail_speed",
        power=power,
        floor=tail.floor,
    )
    return ds.assign_coords(tail_speed=labelled(tail.speeds, "|v−u|/√T", "tail_speed"))


def _even_moments(g: np.ndarray, grid: VelocitySpace) -> np.ndarray:
    """⟨|c|^{2n}⟩ for n = 0 to 3, over their values for a Gaussian of the same temperature."""
    d = grid.dim
    c2 = np.broadcast_to(np.asarray(sum(np.square(v) for v in grid.velocities())), grid.shape)
    M = np.array([np.sum(c2**n * g * grid.measure) for n in range(4)])
    T = M[1] / (d * M[0])
    gaussian = np.array([1.0, d * T, d * (d + 2) * T**2, d * (d + 2) * (d + 4) * T**3])
    return np.asarray(M / M[0] / gaussian)
