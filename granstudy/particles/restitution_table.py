"""Restitution by the normal impact speed as a table: compiled loops cannot call a law in Python."""

import numpy as np

from granstudy.collision.weights import alpha
from granstudy.model.restitution import Restitution, check_restitution
from granstudy.particles.collisions import OCTAVES, PER_OCTAVE

LARGEST_SPEED = 4.0
"""Largest speed of the table over the truncation radius R; two particles in the box are within 3.83 R."""


def alpha_table(restitution: Restitution, R: float) -> tuple[np.ndarray, float]:
    """α = (1+e)/4 at speeds up to the returned largest one; one value for constant e.

    Raises
    ------
    ValueError
        If the law leaves [0, 1] at speeds up to 4R.
    """
    top = LARGEST_SPEED * R
    check_restitution(restitution, largest_speed=top)
    if not callable(restitution):
        return np.array([alpha(restitution)]), top
    octave = np.repeat(np.arange(-OCTAVES, 0), PER_OCTAVE)
    within = np.tile(1.0 + np.arange(PER_OCTAVE) / PER_OCTAVE, OCTAVES)
    speeds = top * np.append(np.ldexp(within, octave), 1.0)
    return np.asarray(alpha(np.asarray(restitution(speeds), dtype=float))), top
