"""A gas of one's own. An edit of a function computes anew what uses it, and nothing else."""

import numpy as np


def anisotropic(vx, vy, ratio=1.0):
    """Two-temperature Maxwellian: Tx/Ty = ratio, (Tx + Ty)/2 = 1."""
    Ty = 2.0 / (1.0 + ratio)
    Tx = ratio * Ty
    return np.exp(-(vx**2) / (2 * Tx) - vy**2 / (2 * Ty)) / (2 * np.pi * np.sqrt(Tx * Ty))


def softening(v, kappa=0.1):
    """Restitution at the normal impact speed v: 1 at rest, falling with the speed."""
    return 1.0 / (1.0 + kappa * v)
