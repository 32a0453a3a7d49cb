"""Restitution by the normal impact speed as a table: compiled loops cannot call a law in Python."""

import math

import numba
import numpy as np

from granstudy.collision.weights import alpha
from granstudy.kernel import Restitution, check_restitution

OCTAVES = 64
"""The table goes down to 2^−64 of its largest speed; below that the law keeps its value there."""

PER_OCTAVE = 128
"""Linear pieces an octave: an error of at most 8e-6 · max|v² e''(v)|, for `granstudy.Viscoelastic` 1e-6."""

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


@numba.njit(nogil=True, cache=True)
def alpha_at(speed, alphas, top):
    """α at a speed: linear between the table's speeds top · 2^−k (1 + m/128), constant beyond its ends."""
    mantissa, octave = math.frexp(speed / top)  # mantissa in [½, 1)
    place = (octave - 1 + OCTAVES) * PER_OCTAVE + (2.0 * mantissa - 1.0) * PER_OCTAVE
    if place <= 0.0 or speed == 0.0:
        return alphas[0]
    k = int(place)
    if k >= alphas.size - 1:
        return alphas[-1]
    part = place - k
    return (1.0 - part) * alphas[k] + part * alphas[k + 1]
