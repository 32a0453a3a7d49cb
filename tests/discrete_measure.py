"""Moments of Maxwell molecules' collision operator for sums of delta functions, exact to round-off."""

import numpy as np

from granstudy.quadrature import circle_rule, sphere_rule


def random_measure(dim, seed, count=7):
    """Weights and velocities of a random measure about v = 0, of no symmetry."""
    rng = np.random.default_rng(seed)
    weights, v = rng.uniform(0.1, 0.3, count), rng.normal(size=(count, dim))
    return weights, v - weights @ v / weights.sum()


def moment_tensor(order):
    """The function v → v_i v_j ... with ``order`` factors, of velocities on the last axis."""

    def moment(v):
        product = v
        for _ in range(order - 1):
            product = product[..., None] * v.reshape(
                *v.shape[:-1], *[1] * (product.ndim - v.ndim + 1), -1
            )
        return product

    return moment


def directions(dim):
    """Points on the sphere whose mean is exact for polynomials of degree 7, shape (count, dim)."""
    return circle_rule(9).points if dim == 2 else sphere_rule(32).points


def collision_rate(measure, moment, restitution, cross_section=1.0):
    """∫ moment Q dv = |S|C Σ_ij w_i w_j [mean over σ of moment(v') − moment(v_i)], degree 7 at most."""
    weights, v = measure
    alpha = (1 + restitution) / 4
    g = v[:, None] - v[None, :]
    sigma = directions(v.shape[1])
    scattered = np.linalg.norm(g, axis=-1)[..., None, None] * sigma
    after = moment((v[:, None] - alpha * g)[:, :, None] + alpha * scattered).mean(axis=2)
    change = after - moment(v)[:, None]
    return cross_section * np.einsum("i,j,ij...->...", weights, weights, change)
