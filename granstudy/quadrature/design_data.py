"""The shipped symmetric spherical designs, data files beside this module."""

from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

DESIGN_DEGREE = {2: 1, 6: 3, 12: 5, 32: 7, 48: 9, 70: 11, 94: 13, 120: 15, 156: 17, 192: 19}
"""Degree of the shipped design of each size M_sph (docs/method.md §2)."""


def design_file(M_sph: int) -> str:
    """Name of the data file of the design with M_sph points."""
    return f"design_{DESIGN_DEGREE[M_sph]}_{M_sph}.txt"


def design_points(M_sph: int) -> NDArray:
    """Points of the shipped design, shape (M_sph, 3); row i + M_sph/2 is minus row i."""
    text = files(__package__).joinpath("data", design_file(M_sph)).read_text("utf-8")
    return np.loadtxt(text.splitlines())
