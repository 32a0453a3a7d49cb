"""The rule for the mean over the deflection angle χ of a collision."""

import numpy as np


def deflections(dim: int, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes u = sin(χ/2) in [0, 1] and weights of the mean over σ, fine enough for phases up to ``scale``.

    The measure of the mean is 2u du in 3D and (2/π) du/√(1−u²) = dχ/π in 2D.
    """
    x, w = np.polynomial.legendre.leggauss(48 + int(0.75 * scale))
    if dim == 2:
        return np.sin(np.pi / 4 * (x + 1)), w / 2
    u = (x + 1) / 2
    return u, w * u
