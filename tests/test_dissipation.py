"""The energy that all pairs of a density lose, against laws and against the energy of Q."""

import pytest
from comparison import asymmetric_scene

import granstudy as gs
from granstudy import theory
from granstudy.dissipation import Dissipation


def maxwellian(dim, exponent, restitution, temperature=1.0):
    kernel = gs.VHS(exponent, gs.hard_spheres(dim).strength)
    name = f"maxwellian{dim}d"
    return gs.load_scene(
        name, kernel=kernel, restitution=restitution, temperature=temperature, diffusion=0.0
    )


@pytest.mark.parametrize("exponent", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_maxwellian_cools_as_the_law_says(dim, exponent):
    scene = maxwellian(dim, exponent, 0.3, temperature=1.2)
    K = theory.gaussian_cooling_coefficient(scene.kernel, 0.3, dim)
    exact = -dim / 2 * K * 1.2 ** (1 + exponent / 2)
    for grid, error in (
        (gs.VelocityGrid(dim, 32, 9.0), 1e-4),
        (gs.RadialGrid(dim, 32, 9.0), 1e-5),
    ):
        found = Dissipation(scene, grid)(scene.density(grid))
        assert found == pytest.approx(exact, rel=error)


@pytest.mark.parametrize("restitution", [0.2, gs.Viscoelastic(0.3)], ids=str)
@pytest.mark.parametrize("exponent", [0.0, 1.0])
def test_the_energy_of_Q_balances_it(exponent, restitution):
    scene = asymmetric_scene(2, seed=2, exponent=exponent, restitution=restitution)
    solver = gs.Solver(N=40, R=9.0, N_rho=24, M_cir=48, radial_rule="jacobi")
    operator = gs.collision_operator(scene, solver)
    f = scene.density(operator.grid)
    energy = operator.grid.velocity_moments(operator(f)).energy
    assert Dissipation(scene, operator.grid)(f) == pytest.approx(energy, rel=2e-4)


def test_elastic_collisions_take_none():
    scene = maxwellian(3, 1.0, 1.0)
    grid = gs.RadialGrid(3, 16, 8.0)
    assert Dissipation(scene, grid)(scene.density(grid)) == 0.0


def test_it_sees_what_a_truncation_leaves_out():
    # At R = 4 collisions of the fastest pairs, which lose the most, are missing from Q.
    scene = maxwellian(3, 1.0, 0.2)
    operator = gs.collision_operator(scene, gs.Solver(N=16, R=4.0, method="radial"))
    f = scene.density(operator.grid)
    energy = operator.grid.velocity_moments(operator(f)).energy
    assert Dissipation(scene, operator.grid)(f) < 1.05 * energy < 0.0
