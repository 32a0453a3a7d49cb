"""Sums over lattices with a kink, against the integrals that they stand for."""

import numpy as np
import pytest
from scipy.special import gamma

import granstudy as gs
from granstudy.trust.lattice_sums import radial_excess


@pytest.mark.parametrize("s", [0.5, 1.0, 2.5, 3.0, 4.5])
@pytest.mark.parametrize("dim", [2, 3])
def test_pairs_of_speeds_less_the_excess_give_the_mean_of_a_power(dim, s):
    """⟨|v − v*|^s⟩ of a Maxwellian is (4T)^{s/2} Γ((d+s)/2)/Γ(d/2)."""
    grid = gs.RadialGrid(dim, 24, 8.0)
    T = 0.9
    f = np.exp(-(grid.nodes**2) / (2 * T)) / (2 * np.pi * T) ** (dim / 2) * grid.weights
    if dim == 3:
        a, b = np.add.outer(grid.nodes, grid.nodes), np.subtract.outer(grid.nodes, grid.nodes)
        product = np.multiply.outer(grid.nodes, grid.nodes)
        power = (a ** (s + 2) - np.abs(b) ** (s + 2)) / (2 * (s + 2) * product)
    else:
        x, w = np.polynomial.legendre.leggauss(400)
        theta = np.pi * ((x + 1) / 2) ** 3  # gathered at 0, where equal speeds have a kink
        w = w * 1.5 * ((x + 1) / 2) ** 2
        r2 = np.add.outer(grid.nodes**2, grid.nodes**2)[..., None]
        product = 2 * np.multiply.outer(grid.nodes, grid.nodes)[..., None]
        power = np.maximum(r2 - product * np.cos(theta), 0.0) ** (s / 2) @ w
    exact = (4 * T) ** (s / 2) * gamma((dim + s) / 2) / gamma(dim / 2)
    off = abs(f @ power @ f / exact - 1.0)
    mended = abs(f @ (power - radial_excess(dim, grid.nodes, s)) @ f / exact - 1.0)
    # in 2D an error of a higher order in h/r is left
    assert off > 1e-9 and mended < (1e-14 if dim == 3 else off / 3)
