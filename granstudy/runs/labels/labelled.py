"""The dataset of a random run: its case, its errors against the truth, what it says of itself."""

import json

import numpy as np
import xarray as xr

from granstudy.datasets.run_dataset import Ending, Header, stamped
from granstudy.evolution.times import TimeSettings
from granstudy.model.choice import Choice
from granstudy.model.scene import Scene
from granstudy.runs.labels.gaussians import told
from granstudy.support.variables import labelled
from granstudy.trust.flags import Status
from granstudy.trust.rules import STANDARD_ERRORS, UNDER
from granstudy.trust.truth import Errors, errors, maxwell_truth, truth_of_dataset

NAMES = {"temperature": "of T, relative", "a2": "of a2"}
"""Quantities whose errors a random run has."""


def labelled_run(
    scene: Scene,
    choice: Choice,
    settings: TimeSettings,
    run: xr.Dataset,
    finer: xr.Dataset | None,
) -> xr.Dataset:
    """A run beside its truth, in numbers over no dimension.

    Parameters
    ----------
    scene, choice, settings
        What the run was made with.
    run : xarray.Dataset
        The run (`granstudy.simulate`).
    finer : xarray.Dataset or None
        The run that is its truth; None where the exact law is.

    Returns
    -------
    xarray.Dataset
        With x for `temperature` and `a2`:

        ========================  ==============================================================
        `largest_x_error`         largest error over the output times reached
        `x_error_estimate`        the run's own largest estimate of it
        `x_known_to`              how well the truth is known: 0 by a law; `STANDARD_ERRORS` of
                                  particles; `UNDER` times the estimated error of a finer run
        `trust`                   the run's label
        `ended`                   whether it reached the final time
        attributes                `time`, `truth`, `reason`: times and steps as JSON, where the
                                  truth comes from, why the run ended early
        ========================  ==============================================================

    Raises
    ------
    ValueError
        If the finer run ended early.
    """
    if finer is None:
        truth = maxwell_truth(told(scene), run["time"].values)
    else:
        truth = truth_of_dataset(finer)
    by_particles = finer is not None and "temperature_standard_error" in finer
    factor = STANDARD_ERRORS if by_particles else UNDER
    known = Errors(factor * truth.temperature_uncertainty, factor * truth.a2_uncertainty)
    found = errors(run, truth)
    numbers: dict[str, tuple[float, str]] = {}
    for (name, of), error, uncertain in zip(NAMES.items(), found, known, strict=True):
        estimates = run[f"{name}_error_estimate"].values
        estimate = float(np.max(estimates)) if estimates.size else np.nan
        numbers |= {
            f"largest_{name}_error": (error, f"largest error {of}, over the output times reached"),
            f"{name}_error_estimate": (estimate, f"largest error {of} that the run estimated"),
            f"{name}_known_to": (uncertain, f"largest error {of} that the truth may have"),
        }
    ds = xr.Dataset({name: labelled(*number, ()) for name, number in numbers.items()})
    ds["trust"] = run["trust"]
    ended = int(run["status"]) == Status.OK
    ds["ended"] = labelled(ended, "whether the run reached its final time", ())
    times = settings.coordinates()
    if choice.solver.traits.by_particles:  # the rest has no meaning there
        times = {"t_final": times["t_final"]}
    header = Header.of("labels", scene, choice, times)
    return stamped(ds, header, Ending()).assign_attrs(
        time=json.dumps(settings.describe(), sort_keys=True),
        truth=truth.source,
        reason=str(run["status"].attrs["reason"]),
    )
