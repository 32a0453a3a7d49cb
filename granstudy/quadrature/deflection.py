"""The Gauss–Legendre rule, and what it gives for the mean over the deflection angle χ of a collision."""

from functools import lru_cache

import numpy as np


@lru_cache(maxsize=256)
def gauss_legendre(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes in (−1, 1) and weights, read-only: the rules of a few sizes are asked for again and again."""
    rule = np.polynomial.legendre.leggauss(count)
    for array in rule:
        array.flags.writeable = False
    return rule


def deflections(dim: int, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes u = sin(χ/2) in [0, 1] and weights of the mean over σ, fine enough for phases up to ``scale``.

    The measure of the mean is 2u du in 3D and (2/π) du/√(1−u²) = dχ/π in 2D.
    """
    x, w = gauss_legendre(48 + int(0.75 * scale))
    if dim == 2:
        return np.sin(np.pi / 4 * (x + 1)), w / 2
    u = (x + 1) / 2
    return u, w * u
