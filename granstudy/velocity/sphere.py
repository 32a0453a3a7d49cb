"""Means over the unit circle and sphere."""

import numpy as np
from scipy.special import j0, j1

PAPER_SHIFT = 1e-8
"""The paper's code takes sin(x+s)/(x+s) for sinc, s = 1e-8, against 0/0. Its printed errors show it: they
come out to 1e-10 relative with this shift in every sinc, and to 1e-8 of max|Q| without."""


def sphere_mean(dim: int, x: np.ndarray) -> np.ndarray:
    """Mean of e^{iσ·x} over the unit sphere as a function of |x|: J0 in 2D, sin|x|/|x| in 3D."""
    return j0(x) if dim == 2 else np.sinc(x / np.pi)


def sphere_mean_slope(dim: int, x: np.ndarray) -> np.ndarray:
    """X M'(x) of M = `sphere_mean`: −x J1(x) in 2D, cos x − sin x/x in 3D."""
    return -x * j1(x) if dim == 2 else np.cos(x) - np.sinc(x / np.pi)


def paper_sphere_mean(dim: int, x: np.ndarray) -> np.ndarray:
    """`sphere_mean` as the paper's code evaluates it, x ≥ 0 (docs/method.md §6)."""
    return sphere_mean(dim, x if dim == 2 else x + PAPER_SHIFT)


def sphere_area(dim: int) -> float:
    """Area of the unit circle (2π) or the unit sphere (4π)."""
    return 2.0 * np.pi if dim == 2 else 4.0 * np.pi
