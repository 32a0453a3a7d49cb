"""Rates from all pairs, against exact laws and against the moments of Q."""

import numpy as np
import pytest
from comparison import asymmetric_scene

import granstudy as gs
from granstudy import theory
from granstudy.quadrature.deflection import deflections
from granstudy.trust.lattice_sums import lattice_excess
from granstudy.trust.pair_rates import CollisionRates, RatesAt, _mean_changes


def maxwellian(dim, exponent, restitution, temperature=1.0):
    kernel = gs.VHS(exponent, gs.hard_spheres(dim).strength)
    name = f"maxwellian{dim}d"
    return gs.load_scene(name, kernel=kernel, restitution=restitution, temperature=temperature)


@pytest.mark.parametrize("exponent", [0.0, 0.4, 0.5, 1.0])
@pytest.mark.parametrize("dim", [2, 3])
def test_a_maxwellian_cools_as_the_law_says(dim, exponent):
    scene = maxwellian(dim, exponent, 0.3, temperature=1.2)
    K = theory.gaussian_cooling_coefficient(scene.kernel, 0.3, dim)
    exact = -dim / 2 * K * 1.2 ** (1 + exponent / 2)
    # The kink at equal velocities is accounted for: sums over nodes alone are off by 1e-6 to 5e-5.
    for grid, error in (
        (gs.VelocityGrid(dim, 32, 9.0), 1e-10),
        (gs.RadialGrid(dim, 32, 9.0), 1e-7 if dim == 2 else 1e-9),
    ):
        rates = CollisionRates(scene, grid)(scene.density(grid))
        assert rates.energy == pytest.approx(exact, rel=error)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("exponent", [0.5, 1.0])
def test_the_fourth_moment_has_the_rate_of_a_fine_grid(dim, exponent):
    scene = gs.load_scene(f"bkw{dim}d", kernel=gs.VHS(exponent, 1.0), restitution=0.3)
    fine = gs.RadialGrid(dim, 120, 10.0)
    exact = CollisionRates(scene, fine)(scene.density(fine))
    for grid in (gs.VelocityGrid(dim, 36, 9.0), gs.RadialGrid(dim, 30, 9.0)):
        rates = CollisionRates(scene, grid)(scene.density(grid))
        assert rates.fourth == pytest.approx(exact.fourth, rel=5e-7)
        assert rates.frequency == pytest.approx(exact.frequency, rel=5e-7)


@pytest.mark.parametrize(
    ("dim", "s", "value"),
    [(2, 2.5, 0.02868684), (2, 3.0, 0.02939428), (3, 2.5, 0.03865902), (3, 3.0, 0.04118325)],
)
def test_the_excess_of_a_kink_begins_with_epsteins_zeta_function(dim, s, value):
    [excess] = lattice_excess(dim, 8, [s])
    assert excess.flat[0] == pytest.approx(value, abs=5e-9)
    # at even powers there is no kink
    assert all(not np.any(excess) for excess in lattice_excess(dim, 8, [0.0, 2.0, 4.0]))


@pytest.mark.fault("L2")
def test_energy_conserved_by_exact_rates_makes_a_resolved_run_better():
    """Rates without the excess of the kink made T 40 to 240 times worse (2D, λ = 0.5)."""
    kernel = gs.VHS(0.5, gs.hard_spheres(2).strength)
    scene = gs.load_scene("bkw2d", kernel=kernel, restitution=0.5, diffusion=0.0)
    time = {"t_final": 1.0, "time_rtol": 1e-9, "times": [0.5], "progress": False}
    truth = gs.simulate(scene, gs.Solver(N=48, R=12.0, method="radial"), **time)
    solver = gs.Solver(N=32, R=8.0, N_rho=24, M_cir=24)
    plain, kept = (
        gs.simulate(scene, solver, conserve=conserve, **time)
        for conserve in ((), ("mass", "energy"))
    )
    off = [abs(float(ds["temperature"][-1] / truth["temperature"][-1]) - 1) for ds in (plain, kept)]
    assert off[1] < 5e-7 and off[1] < 2 * off[0]


@pytest.mark.parametrize("dim", [2, 3])
def test_rates_of_maxwell_molecules_are_those_of_the_moment_equations(dim):
    scene = asymmetric_scene(dim, seed=2, exponent=0.0, restitution=0.3)
    grid = gs.VelocityGrid(dim, 24, 9.0)
    f = scene.density(grid)
    rates = CollisionRates(scene, grid)(f)
    moments = grid.velocity_moments(f)
    exact = theory.maxwell_moment_rates(
        moments.density,
        moments.pressure,
        np.zeros((dim,) * 3),
        fourth=moments.fourth,
        restitution=0.3,
    )
    assert rates.frequency == pytest.approx(moments.density, rel=1e-10)
    assert rates.energy == pytest.approx(exact.pressure.trace() / 2, rel=1e-8)
    assert rates.fourth == pytest.approx(exact.fourth, rel=1e-8)


@pytest.mark.parametrize("exponent", [0.5, 1.0])
@pytest.mark.parametrize("dim", [2, 3])
def test_moments_of_the_radial_Q_balance_them(dim, exponent):
    kernel = gs.VHS(exponent, gs.hard_spheres(dim).strength)
    scene = gs.load_scene(f"bkw{dim}d", kernel=kernel, restitution=0.2)
    operator = gs.collision_operator(scene, gs.Solver(N=40, R=11.0, method="radial"))
    f = scene.density(operator.grid)
    moments = operator.grid.velocity_moments(operator(f))
    rates = CollisionRates(scene, operator.grid)(f)
    assert rates.energy == pytest.approx(moments.energy, rel=2e-6)
    assert rates.fourth == pytest.approx(moments.fourth, rel=2e-5)


@pytest.mark.parametrize("restitution", [0.2, gs.Viscoelastic(0.3)], ids=str)
def test_moments_of_Q_without_symmetry_balance_them(restitution):
    scene = asymmetric_scene(2, seed=2, exponent=1.0, restitution=restitution)
    solver = gs.Solver(N=40, R=9.0, N_rho=24, M_cir=48, radial_rule="jacobi")
    operator = gs.collision_operator(scene, solver)
    f, grid = scene.density(operator.grid), operator.grid
    rates = CollisionRates(scene, grid)(f)
    Q = operator(f)
    u = grid.velocity_moments(f).momentum / grid.velocity_moments(f).density
    V = sum((v - ui) ** 2 for v, ui in zip(grid.velocities(), u, strict=True))
    assert rates.energy == pytest.approx((V / 2 * Q).sum() * grid.cell, rel=2e-4)
    assert rates.fourth == pytest.approx((V**2 * Q).sum() * grid.cell, rel=1e-2)


def test_elastic_collisions_take_no_energy():
    scene = maxwellian(3, 1.0, 1.0)
    grid = gs.RadialGrid(3, 16, 8.0)
    rates = CollisionRates(scene, grid)(scene.density(grid))
    assert abs(rates.energy) < 1e-14 and abs(rates.fourth) < 1e-4
    # ρ|S|C⟨|g|⟩ = 4/√π at T = 1
    assert rates.frequency == pytest.approx(4.0 / np.sqrt(np.pi), rel=1e-3)


def test_they_see_what_a_truncation_leaves_out():
    # At R = 4 collisions of the fastest pairs, which lose the most, are missing from Q.
    scene = maxwellian(3, 1.0, 0.2)
    operator = gs.collision_operator(scene, gs.Solver(N=16, R=4.0, method="radial"))
    f = scene.density(operator.grid)
    energy = operator.grid.velocity_moments(operator(f)).energy
    assert CollisionRates(scene, operator.grid)(f).energy < 1.05 * energy < 0.0


def test_weights_are_kept_until_another_restitution_asks_for_its_own():
    scene = maxwellian(2, 1.0, 0.3)
    grid = gs.RadialGrid(2, 16, 9.0)
    f = scene.density(grid)
    rates = RatesAt(scene, grid)
    first, other = rates(0.3), rates(0.8)
    assert other is rates(0.8) and first(f) == CollisionRates(scene, grid)(f)
    assert other(f) == CollisionRates(maxwellian(2, 1.0, 0.8), grid)(f) != first(f)


@pytest.mark.parametrize("restitution", [0.5, gs.Viscoelastic(0.1)], ids=str)
def test_a_run_that_keeps_energy_computes_them_once(monkeypatch, restitution):
    made = []

    class Counted(CollisionRates):
        def __init__(self, *given):
            made.append(given)
            super().__init__(*given)

    monkeypatch.setattr("granstudy.trust.pair_rates.CollisionRates", Counted)
    solver = gs.Solver(N=16, R=8.0, N_rho=4, M_cir=4)
    scene = gs.load_scene("bkw2d", restitution=restitution)
    gs.simulate(scene, solver, t_final=0.2, dt=0.1, conserve=("mass", "energy"), progress=False)
    assert len(made) == 1


@pytest.mark.parametrize("dim", [2, 3])
def test_a_collision_takes_the_part_of_its_normal_velocity(dim):
    """|g'|² − |g|² = −(1−e²)(g·n)² with (g·n)² = u²|g|², whatever e does with u; and what is left of |g|²
    is spread evenly across g."""
    u, mean = deflections(dim, 0.0)
    e = np.array([0.3 + 0.7 * u, np.exp(-3 * u), np.ones(len(u))])
    loss2, w2, wg2, length4 = _mean_changes(dim, e)
    np.testing.assert_allclose(loss2, -((1 - e**2) * u**2) @ mean, atol=1e-14)
    np.testing.assert_allclose(length4, (1 - (1 - e**2) * u**2) ** 2 @ mean, atol=1e-14)
    # averaged over directions of w, the change of the fourth moment is that of |g|², (d+2)/d times
    np.testing.assert_allclose(dim * w2 + wg2, (dim + 2) * loss2, atol=1e-14)
