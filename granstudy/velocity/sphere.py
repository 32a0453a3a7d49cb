"""Means over the unit circle (2D) and the unit sphere (3D), and their areas."""

import numpy as np
from scipy.special import j0

PAPER_SHIFT = 1e-8
"""Shift s by which the paper's code avoids 0/0: it takes sin(x+s)/(x+s) for sinc x. The printed errors show
the shift: they come out to 1e-10 relative with it in every sinc, and to 1e-8 of max|Q| without."""


def sphere_mean(dim: int, x: np.ndarray) -> np.ndarray:
    """Mean of e^{iσ·x} over the unit sphere as a function of |x|: J0 in 2D, sin|x|/|x| in 3D."""
    return j0(x) if dim == 2 else np.sinc(x / np.pi)


def paper_sphere_mean(dim: int, x: np.ndarray) -> np.ndarray:
    """`sphere_mean` for x ≥ 0 as the paper's code evaluates it (docs/method.md §6)."""
    return sphere_mean(dim, x if dim == 2 else x + PAPER_SHIFT)


def sphere_area(dim: int) -> float:
    """Area of the unit circle (2π) or the unit sphere (4π)."""
    return 2.0 * np.pi if dim == 2 else 4.0 * np.pi
