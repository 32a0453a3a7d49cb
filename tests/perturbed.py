"""Collision moments of Gaussians with a Sonine perturbation, by `radial`, which is exact for them."""

from functools import cache

import numpy as np

import granstudy as gs


def sonine_density(a2, a3):
    """The Gaussian of T = 1 times 1 + a2 S_2 + a3 S_3, S_n(x) = L_n^{(d/2−1)}(x) with x = v²/2."""

    def density(*v):
        x, n = sum(vi**2 for vi in v) / 2, len(v)
        S2 = x**2 / 2 - (n + 2) / 2 * x + n * (n + 2) / 8
        S3 = (
            -(x**3) / 6
            + (n + 4) / 4 * x**2
            - (n + 2) * (n + 4) / 8 * x
            + n * (n + 2) * (n + 4) / 48
        )
        return np.exp(-x) * (1 + a2 * S2 + a3 * S3) / (2 * np.pi) ** (n / 2)

    return density


@cache
def collision_moments(dim, exponent, restitution, a2=0.0, a3=0.0):
    """∫|v|² Q dv and ∫|v|⁴ Q dv for |S|C_λ = 1."""
    kernel = gs.VHS(exponent, gs.maxwell(dim).strength)
    scene = gs.Scene(dim, sonine_density(a2, a3), kernel, restitution)
    operator = gs.collision_operator(scene, gs.Solver(N=32, R=10.5, method="radial"))
    moments = operator.grid.velocity_moments(operator(scene.density(operator.grid)))
    return 2 * float(moments.energy), float(moments.fourth)
