"""The truth of T and a2, an exact law or another run, and a run's errors against the truth."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.model.scene import Scene
from granstudy.trust.exact_law import check_maxwell_law
from granstudy.trust.flags import Status, flag_word
from granstudy.velocity.sphere import sphere_area

SAME_TIME = 1e-9
"""Largest relative difference of two output times that count as the same."""


@dataclass(frozen=True)
class Truth:
    """True T and a2 over time, with their own uncertainties.

    Attributes
    ----------
    time, temperature, a2 : ndarray, shape (n,)
    temperature_uncertainty, a2_uncertainty : float
        Largest uncertainty over time, for T relative to T: 0 for a law, standard errors for particles,
        estimated errors for another run.
    source : str
        Where the truth comes from, in a few words.
    """

    time: np.ndarray
    temperature: np.ndarray
    a2: np.ndarray
    temperature_uncertainty: float
    a2_uncertainty: float
    source: str


class Errors(NamedTuple):
    """Largest distances from the truth over the common times; for T, relative to the truth."""

    temperature: float
    a2: float


def maxwell_truth(scene: Scene, times: np.ndarray) -> Truth:
    """Exact T and a2 of Maxwell molecules, from the stated moments of the initial density.

    An error that a grid makes in the initial density so counts as an error of the run (docs/theory.md §1).

    Raises
    ------
    ValueError
        For a scene without an exact law (`check_maxwell_law`).
    """
    check_maxwell_law(scene)
    start = scene.moments
    assert start is not None and not callable(scene.restitution)
    gas = {
        "restitution": float(scene.restitution),
        "diffusion": float(scene.diffusion),
        "density": start.density,
        "cross_section": sphere_area(scene.dim) * scene.kernel.strength,
    }
    temperature = theory.maxwell_temperature(times, start.temperature, **gas)
    a2 = theory.maxwell_a2(times, start.pressure, start.a2, **gas)
    return Truth(times, temperature, a2, 0.0, 0.0, "exact law")


def truth_of_dataset(ds: xr.Dataset) -> Truth:
    """T and a2 of another run as the truth.

    Raises
    ------
    ValueError
        If the other run ended early.
    """
    status = Status(int(ds["status"]))
    if status is not Status.OK:
        raise ValueError(f"truth: its run {status.name.lower()}: {ds['status'].attrs['reason']}")
    by_particles = "temperature_standard_error" in ds
    kind = "standard_error" if by_particles else "error_estimate"
    T_off, a2_off = ds[f"temperature_{kind}"], ds[f"a2_{kind}"]
    if by_particles:
        T_off = T_off / ds["temperature"]
        source = f"dsmc, {int(ds['particles']):,} particles"
    else:
        label = flag_word("trust", ds["trust"])
        grid = f"N = {int(ds['N'])}, R = {float(ds['R']):g}"
        source = f"{ds['method'].item()}, {grid}, {label}"
    return Truth(
        ds["time"].values, ds["temperature"].values, ds["a2"].values,
        float(T_off.max()), float(a2_off.max()), source,
    )  # fmt: skip


def errors(ds: xr.Dataset, truth: Truth) -> Errors:
    """Errors of a run against its truth, over the times that both have.

    For a run that ended early, the times up to its end count.

    Raises
    ------
    ValueError
        If the run went beyond t = 0, and has only t = 0 in common with its truth.
    """
    time = ds["time"].values
    mine, its = np.nonzero(np.isclose(time[:, None], truth.time, rtol=SAME_TIME, atol=0.0))
    if not time[mine].any() and time.any():
        raise ValueError(
            f"truth: has no time in common with the run, whose times are {time[1:4].tolist()}, ...; "
            "give time.times"
        )
    T, exact = ds["temperature"].values[mine], truth.temperature[its]
    a2 = ds["a2"].values[mine] - truth.a2[its]
    return Errors(_largest(T / exact - 1.0), _largest(a2))


def _largest(errors: np.ndarray) -> float:
    """Largest absolute value; NaN where there is none."""
    return float(np.max(np.abs(errors))) if errors.size else float("nan")
