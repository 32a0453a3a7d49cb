"""Restitution laws as tables over the normal impact speed: compiled loops cannot call Python."""

import numpy as np

from granstudy.collision.weights import alpha
from granstudy.model.restitution import Restitution, check_restitution, restitution_at
from granstudy.particles.collisions import OCTAVES, PER_OCTAVE

LARGEST_SPEED = 4.0
"""Largest speed of the table over the truncation radius R: velocities in the box differ by 3.83 R at most."""


def alpha_table(restitution: Restitution, R: float) -> tuple[np.ndarray, float]:
    """Table of α = (1+e)/4 over impact speeds, and the largest of its speeds.

    Parameters
    ----------
    restitution : float or callable
    R : float
        Truncation radius; the largest speed is 4R.

    Returns
    -------
    alphas : ndarray
        α at the speeds of `granstudy.particles.collisions.alpha_at`; one value for constant e.
    largest : float

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
    return np.asarray(alpha(restitution_at(restitution, speeds))), top
