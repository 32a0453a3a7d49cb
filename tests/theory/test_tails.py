"""Tail rates: the exact heated tail of Maxwell molecules, and the equations at large speed."""

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("e", [0.0, 0.5, 0.9])
def test_heated_maxwell_tail_is_that_of_the_exact_moments(dim, e):
    """Of e^{−Bc} the moments grow as μ_n/(n μ_{n−1}) → 2/B², apart from 1/n and higher powers."""
    n, (low, high) = np.array([80, 160]), (0, 1)
    moments = np.array([theory.maxwell_heated_moments(k, e, dim)[-2:] for k in n])
    ratios = moments[:, 1] / (n * moments[:, 0])
    # the prefactor's power of c makes (1 + β/n^q): Richardson in n^{−1/2} (2D) or n^{−1} (3D)
    weight = np.sqrt(2.0) if dim == 2 else 2.0
    limit = (weight * ratios[high] - ratios[low]) / (weight - 1)
    assert limit == pytest.approx(2 / theory.heated_tail_rate(e, dim, 0.0) ** 2, rel=0.02)


def test_hard_spheres_in_3D():
    e, a2 = 0.4, 0.08
    A = 3 * np.sqrt(np.pi) / (2 * (1 - e**2) * (1 + 3 * a2 / 16))
    assert theory.cooling_tail_rate(e, a2=a2) == pytest.approx(A, rel=1e-14)
    assert theory.heated_tail_rate(e, a2=a2) == pytest.approx(2 / 3 * np.sqrt(2 * A / 2), rel=1e-14)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("exponent", [0.3, 1.0])
def test_they_solve_the_equations_at_large_speed_for_any_strength_and_density(dim, exponent):
    e, rho, strength, T, c, h = 0.6, 1.7, 0.3, 2.3, 1e5, 1e-3
    kernel, area = gs.VHS(exponent, strength), 2 * np.pi if dim == 2 else 4 * np.pi
    loss = rho * area * strength * (np.sqrt(T) * c) ** exponent
    cooling = rho * theory.gaussian_cooling_coefficient(kernel, e, dim) * T ** (exponent / 2)
    A = theory.cooling_tail_rate(e, dim, exponent)
    assert 0.5 * cooling * c * A * exponent * c ** (exponent - 1) == pytest.approx(loss, rel=1e-12)
    # f'' = (log f)'² f to leading order, by differences of log f in v = √T c
    B, epsilon = theory.heated_tail_rate(e, dim, exponent), cooling * T / 2
    slope = B * ((c + h) ** (1 + exponent / 2) - c ** (1 + exponent / 2)) / (h * np.sqrt(T))
    assert epsilon * slope**2 == pytest.approx(loss, rel=1e-6)


def test_arguments_outside_their_range():
    assert theory.cooling_tail_rate(1.0) == theory.heated_tail_rate(1.0) == np.inf
    with pytest.raises(ValueError, match="exponent=0: Maxwell molecules have a power-law tail"):
        theory.cooling_tail_rate(0.5, 2, 0.0)
    for law in (theory.cooling_tail_rate, theory.heated_tail_rate):
        with pytest.raises(ValueError, match="restitution=1.2"):
            law(1.2)
        with pytest.raises(ValueError, match="exponent=1.5"):
            law(0.2, 3, 1.5)


def steady_state(state, dim, e, N, R):
    """Hard spheres at T = 1, cooling or heated, by `radial` and Newton's method, and their grid."""
    scene = gs.load_scene(f"maxwellian{dim}d", kernel=gs.hard_spheres(dim), restitution=e)
    operator = gs.collision_operator(scene, gs.Solver(N=N, R=R, method="radial"))
    grid, h = operator.grid, 1e-5
    r, w = grid.nodes, grid.weights
    differences = (grid.mode_values(r + h) - grid.mode_values(r - h)) / (2 * h)
    derivative = differences @ grid.analysis
    diffusion = grid.laplacian(np.eye(N))

    def residual(f):
        Q = operator(f)
        cooling = -(w * r**2 @ Q) / dim  # −T'/T
        change = diffusion @ f if state == "heated" else -dim * f - r * (derivative @ f)
        return np.concatenate([Q + cooling / 2 * change, [w @ f - 1, w * r**2 @ f / dim - 1]])

    f, step = scene.density(grid), 1e-6 * np.eye(N)
    for _ in range(6):
        jacobian = np.transpose([(residual(f + s) - residual(f - s)) / 2e-6 for s in step])
        f = f - np.linalg.lstsq(jacobian, residual(f), rcond=1e-13)[0]
    assert np.max(np.abs(residual(f))) < 1e-10
    return f, grid


@pytest.mark.parametrize(
    ("state", "R", "linear", "rate", "power", "speeds", "tolerance"),
    [
        ("cooling", 14.0, theory.montanero_santos_a2, theory.cooling_tail_rate, 1.0, (4, 6), 0.02),
        ("heated", 10.5, theory.heated_state_a2, theory.heated_tail_rate, 1.5, (5, 6), 0.01),
    ],
)
def test_computed_states_of_hard_spheres(state, R, linear, rate, power, speeds, tolerance):
    e, c = 0.2, np.array(speeds)
    f, grid = steady_state(state, 3, e, 40, R)
    a2 = grid.velocity_moments(f).fourth / 15 - 1
    assert a2 == pytest.approx(linear(e), abs=4e-3)
    slope = -np.diff(np.log(grid.evaluate(f, c)))[0] / np.diff(c**power)[0]
    assert slope == pytest.approx(rate(e, a2=a2), rel=tolerance)
