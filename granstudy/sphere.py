"""Means over the unit circle and sphere."""

import numpy as np
from scipy.special import j0


def sphere_mean(dim: int, x: np.ndarray) -> np.ndarray:
    """Mean of e^{iσ·x} over the unit sphere as a function of |x|: J0 in 2D, sin|x|/|x| in 3D."""
    return j0(x) if dim == 2 else np.sinc(x / np.pi)
