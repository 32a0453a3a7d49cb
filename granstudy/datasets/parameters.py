"""Every parameter of a run: its coordinate's name, symbol, absent value and place in the order of sweeps."""

from typing import Any

SWEPT = (
    "e",
    "exponent",
    "epsilon",
    "symmetry",
    "N",
    "R",
    "N_rho",
    "M_sph",
    "M_cir",
    "rtol",
    "particles",
    "batches",
    "seed",
    "variant",
    "method",
    "sphere_rule",
    "radial_rule",
    "dealias",
    "precision",
    "device",
    "frame",
    "scheme",
    "conserve",
    "time_rtol",
    "dt",
)
"""What a study can sweep, in the order of a run's path."""


ABSENT: dict[str, Any] = {
    "N_rho": -1,
    "M_sph": -1,
    "N_theta": -1,
    "N_phi": -1,
    "M_cir": -1,
    "rtol": -1.0,
    "particles": -1,
    "batches": -1,
    "seed": -1,
    "variant": "",
    "sphere_rule": "",
    "radial_rule": "",
    "dealias": False,
    "precision": "",
    "device": "cpu",
    "frame": "",
    "scheme": "",
    "conserve": "",
    "time_rtol": -1.0,
}
"""What stands for a parameter that a run does not have, beside runs that have it."""
