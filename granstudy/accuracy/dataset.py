"""The dataset of a run to an accuracy."""

import json

import numpy as np
import xarray as xr

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.run import Outcome
from granstudy.datasets.parameters import parameter
from granstudy.datasets.run_dataset import Header
from granstudy.evolution.dataset import evolution_dataset
from granstudy.support.variables import Variable, labelled
from granstudy.trust.flags import Status, Trust, flag_variable
from granstudy.velocity.radial import RadialGrid

UNTRUSTED = 3.0
"""Estimated error over the error asked for, above which a run is untrusted."""

LEG_VARIABLES = {
    "leg_start": "time at which the leg began",
    "leg_N": "grid points in each dimension; radial: speeds",
    "leg_R": "truncation radius of relative velocities",
    "leg_rtol": "tolerance of the quadrature; 0 for radial, which has none",
    "leg_time_rtol": "tolerance of the time steps",
    "leg_radial": "1 where the method is radial, 0 where it is fast",
    "leg_evaluations": "evaluations of Q in the leg",
}
"""What a dataset says of each leg of a run, over ``leg``."""


def accuracy_dataset(
    header: Header, asked: Accuracy, outcome: Outcome, rescaled: bool
) -> xr.Dataset:
    """Dataset of a run to an accuracy.

    Beside what every run has (`granstudy.evolution.dataset`):

    =====================================  =========================================================
    `accuracy`, `a2_accuracy`              what was asked for, coordinates
    `temperature_error_by_grid`, ...       estimated errors by source over ``time``: grid, steps,
                                           changes (of the grid)
    `leg_start`, `leg_N`, `leg_R`, ...     what was chosen when, over ``leg``
    attribute ``choices``                  the same with the reasons, as JSON
    attribute ``reached``                  largest estimated errors, as JSON
    attribute ``needed``                   what the accuracy would have taken, where it was missed
    =====================================  =========================================================
    """
    grid = RadialGrid(header.scene.dim, 4, 1.0)  # no density is kept
    ds = evolution_dataset(header, grid, outcome.record, rescaled)
    data = {}
    for source, errors in outcome.sources.items():
        for name in ("temperature", "a2"):
            values = np.array([getattr(error, name) for error in errors])
            text = f"estimated error of {name} by {source}"
            data[f"{name}_error_by_{source}"] = labelled(values, text, "time")
    legs = outcome.legs
    columns = {
        "leg_start": [leg.start for leg in legs],
        "leg_N": [leg.solver.N for leg in legs],
        "leg_R": [leg.solver.R for leg in legs],
        "leg_rtol": [leg.solver.rtol or 0.0 for leg in legs],
        "leg_time_rtol": [leg.time_rtol for leg in legs],
        "leg_radial": [int(leg.solver.method == "radial") for leg in legs],
        "leg_evaluations": [leg.evaluations for leg in legs],
    }
    for name, column in columns.items():
        data[name] = labelled(np.array(column), LEG_VARIABLES[name], "leg")
    ds = ds.assign(data)
    ds = ds.assign_coords(
        {
            name: ((), value, parameter(name).attributes)
            for name, value in asked.coordinates().items()
        }
    )
    choices = [
        {
            "time": leg.start,
            "method": leg.solver.method,
            "N": leg.solver.N,
            "R": leg.solver.R,
            "rtol": leg.solver.rtol,
            "time_rtol": leg.time_rtol,
            "reason": leg.reason,
        }
        for leg in legs
    ]
    reached = {name: _largest(ds, name) for name in ("temperature", "a2")}
    missed = [
        f"{name} was asked to {getattr(asked, name):.1e} and reached to {error:.1e}"
        for name, error in reached.items()
        if not error <= getattr(asked, name)
    ]
    if outcome.record.status is not Status.OK:
        missed.append(f"the run ended early: {outcome.record.reason}")
    attrs = {
        "asked": json.dumps(asked.describe(), sort_keys=True),
        "reached": json.dumps(reached, sort_keys=True),
        "choices": json.dumps(choices, sort_keys=True),
        "steps": json.dumps(outcome.steps, sort_keys=True),
    }
    reasons = "; ".join([*missed, *filter(None, [outcome.needed])]) if missed else ""
    if reasons:
        attrs["needed"] = reasons
    off = max(error / getattr(asked, name) for name, error in reached.items())
    ds["trust"] = trust_as_asked(off, outcome.record.status, reasons)
    return ds.assign_attrs(attrs)


def trust_as_asked(off: float, status: Status, reasons: str) -> Variable:
    """The label of a run or state, by its largest error over the error asked for.

    It is trusted where that is at most 1, untrusted above `UNTRUSTED` and where it had to stop.
    """
    trust = Trust.TRUSTED if off <= 1.0 else Trust.MARGINAL if off <= UNTRUSTED else Trust.UNTRUSTED
    if status is not Status.OK:
        trust = Trust.UNTRUSTED
    long_name = "how far temperature and kurtosis can be trusted to be as accurate as asked"
    return flag_variable(trust, long_name, reasons=reasons)


def _largest(ds: xr.Dataset, name: str) -> float:
    """Largest estimated error over the outputs; 1, that of a gas that is lost, without any."""
    variable = f"{name}_error_estimate"
    return float(ds[variable].max()) if variable in ds else 1.0
