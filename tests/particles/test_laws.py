"""Particles against exact laws and against methods that have nothing in common with them."""

import numpy as np
import pytest
from scipy.special import gamma

import granstudy as gs
from granstudy.particles import simulate_particles, time_average
from granstudy.theory import maxwell_anisotropy_rate

BOX = {"N": 16, "R": 7.0, "method": "dsmc"}


def simulate(scene, times, particles=20_000, **settings):
    return simulate_particles(scene, gs.Solver(particles=particles, **BOX | settings), times)


def scene_of(dim, exponent=0.0, restitution=1.0, diffusion=0.0, temperature=1.0, **settings):
    return gs.load_scene(
        f"maxwellian{dim}d",
        temperature=temperature,
        kernel=gs.VHS(exponent, gs.maxwell(dim).strength),
        restitution=restitution,
        diffusion=diffusion,
        **settings,
    )


def assert_within_errors(ds, name, exact, allowed=4.0, floor=0.0):
    """Every value lies within ``allowed`` standard errors of the exact one, and the ``floor``."""
    distance = np.abs(ds[name].values - exact)
    error = ds[f"{name}_standard_error"].values
    assert np.all(distance <= allowed * error + floor), (distance / (error + 1e-300)).round(1)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize(("e", "epsilon"), [(0.2, 0.0), (0.8, 0.0), (0.5, 0.1), (1.0, 0.1)])
def test_the_temperature_of_maxwell_molecules(dim, e, epsilon):
    scene = gs.load_scene(
        f"double_well{dim}d", restitution=e, diffusion=epsilon, kernel=gs.VHS(0.0, 0.2)
    )
    ds = simulate(scene, np.linspace(0.0, 2.0, 5))
    assert_within_errors(ds, "temperature", ds["temperature_exact"].values, floor=1e-12)
    assert ds["temperature_standard_error"][-1] > 0
    # The start is what the density states, whatever the grid makes of it.
    assert ds["temperature"][0] == pytest.approx(scene.moments.temperature, rel=1e-13)
    assert ds["density"][0] == scene.moments.density


@pytest.mark.parametrize(("dim", "exponent"), [(2, 0.0), (3, 0.5), (3, 1.0)])
def test_elastic_collisions_keep_energy_and_momentum(dim, exponent):
    scene = gs.load_scene(f"double_well{dim}d", kernel=gs.VHS(exponent, 0.3), diffusion=0.0)
    ds = simulate(scene, [0.0, 3.0], particles=4000)
    assert ds["collisions"][-1] > 1.0
    for name in ("temperature", "velocity", "energy"):
        assert np.abs(ds[name][-1] - ds[name][0]).max() < 1e-13
        assert ds[f"{name}_standard_error"].max() < 1e-13
    assert np.abs(ds["pressure"][-1] - ds["pressure"][0]).max() > 0.1


@pytest.mark.parametrize("dim", [2, 3])
def test_the_pressure_of_maxwell_molecules_relaxes(dim):
    e = 0.3
    ds = simulate(
        gs.load_scene(f"double_well{dim}d", restitution=e, diffusion=0.0), [0.0, 1.0, 2.5]
    )
    shear = ds["pressure"].values[:, 0, 1]
    exact = shear[0] * np.exp(
        -maxwell_anisotropy_rate(e, dim, float(ds["density"][0])) * ds["time"]
    )
    error = ds["pressure_standard_error"].values[:, 0, 1]
    assert error[0] < 1e-14 < shear[0]
    assert np.all(np.abs(shear - exact.values)[1:] < 4 * error[1:])


@pytest.mark.parametrize(("dim", "exponent"), [(2, 1.0), (3, 1.0), (3, 0.4), (3, 0.0)])
def test_how_often_particles_collide(dim, exponent):
    # ρ|S|C⟨|g|^λ⟩ of a Maxwellian, by ⟨|g|^λ⟩ = (2√T)^λ Γ((d+λ)/2)/Γ(d/2).
    temperature, t = 1.7, 2.0
    ds = simulate(scene_of(dim, exponent, temperature=temperature), [t], R=9.0)
    mean = (2 * np.sqrt(temperature)) ** exponent * gamma((dim + exponent) / 2) / gamma(dim / 2)
    assert_within_errors(ds, "collisions", mean * t)


def test_cooling_hard_spheres_against_the_radial_method():
    scene = scene_of(3, exponent=1.0, restitution=0.8)
    ds = simulate(scene, [0.0, 1.0, 3.0], particles=100_000)
    radial = gs.simulate(scene, gs.Solver(N=24, R=7.0, method="radial"), t_final=3.0, dt=0.05)
    radial = radial.sel(time=[0.0, 1.0, 3.0], method="nearest")
    assert ds["temperature"][-1] < 0.6
    # Truncation at R = 7 and the grid change T by less than the floor.
    assert_within_errors(ds, "temperature", radial["temperature"].values, floor=5e-5)
    assert_within_errors(ds, "a2", radial["a2"].values, floor=2e-4)


@pytest.mark.parametrize("start", [0.5, 2.0])
def test_heated_hard_spheres_against_the_radial_method(start):
    scene = scene_of(3, exponent=1.0, restitution=0.4, diffusion=0.2, temperature=start)
    times = np.array([2.0, 6.0])
    ds = simulate(scene, times, particles=20_000, R=9.0)
    radial = gs.simulate(scene, gs.Solver(N=20, R=9.0, method="radial"), t_final=6.0, dt=0.05)
    radial = radial.sel(time=times, method="nearest")
    assert_within_errors(ds, "temperature", radial["temperature"].values, floor=2e-4)
    assert_within_errors(ds, "a2", radial["a2"].values, floor=3e-4)


@pytest.mark.parametrize("dim", [2, 3])
def test_viscoelastic_particles_lose_energy_as_the_operator_says(dim):
    scene = scene_of(dim, restitution=gs.Viscoelastic(0.6))
    t = 0.1
    ds = simulate(scene, [0.0, t], particles=100_000)
    operator = gs.collision_operator(
        scene, gs.Solver(N=16, R=7.0, N_rho=10, M_cir=12, M_sph=12, method="fast")
    )
    f = scene.density(operator.grid)
    # The midpoint rule: from t/2, with what Q is there.
    end = gs.moments(f + t * operator(f + t / 2 * operator(f)), operator.grid)
    assert_within_errors(ds.isel(time=[1]), "temperature", float(end["temperature"]), floor=1e-4)
    assert float(end["temperature"]) < 0.99


def test_a_law_that_is_constant_is_a_constant():
    times = [0.5]
    law = simulate(scene_of(3, 1.0, lambda v: 0.5 + 0 * v), times, particles=2000)
    constant = simulate(scene_of(3, 1.0, 0.5), times, particles=2000)
    assert law["a2"].values == pytest.approx(constant["a2"].values, rel=1e-9)
    assert law["collisions"].values == constant["collisions"].values


def test_twelve_orders_of_magnitude():
    # A gas 2^20 times slower lives 2^20 times slower.
    times = np.array([0.0, 1.0, 5.0])
    scale = 2.0**-20
    usual = simulate(scene_of(3, 1.0, 0.5), times, particles=2000)
    slow = simulate(
        scene_of(3, 1.0, 0.5, temperature=scale**2), times / scale, particles=2000, R=7.0 * scale
    )
    assert slow["temperature"].values / scale**2 == pytest.approx(
        usual["temperature"].values, rel=1e-9
    )
    assert slow["a2"].values == pytest.approx(usual["a2"].values, rel=1e-6, abs=1e-9)
    # Haff's law to the same temperature: T t² comes to rest.
    late = simulate(scene_of(3, 1.0, 0.2), [1e5, 1e6], particles=4000)
    law = late["temperature"] * late["time"] ** 2
    assert late["temperature"][-1] < 1e-11
    error = late["temperature_standard_error"] * late["time"] ** 2
    assert abs(float(law[1] - law[0])) < 4 * float(error.max()) + 1e-4 * float(law[0])


def test_the_kurtosis_of_few_particles():
    # n particles of given momentum and energy are spread over a sphere of D = d(n−1) dimensions, on which
    # a2 = D/(D+2) − 1 exactly: the bias of a batch.
    dim, n = 3, 10
    ds = simulate(scene_of(dim, 1.0), [4.0, 6.0], particles=1000 * n, batches=1000)
    exact = -2 / (dim * (n - 1) + 2)
    assert_within_errors(ds, "a2", exact)
    assert ds["a2_standard_error"].max() < 0.1 * abs(exact)
    mean, error = time_average(ds, "a2", 4.0)
    assert abs(mean - exact) < 4 * error
    assert "a2 has a bias of about 6.7e-02" in ds["status"].attrs["warnings"]
