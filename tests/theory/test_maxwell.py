"""Moment equations of Maxwell molecules against sums over discrete measures, `direct` and simulations."""

import numpy as np
import pytest
from comparison import Gaussians
from discrete_measure import collision_rate, moment_tensor, random_measure
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

import granstudy as gs
from granstudy import theory

E = st.floats(0.0, 1.0)
each_dim = pytest.mark.parametrize("dim", [2, 3])


def fourth_moment(v):
    return np.sum(v**2, axis=-1) ** 2


@given(E, st.floats(0.1, 5.0), st.floats(0.0, 0.5), st.floats(0.5, 2.0), st.floats(0.5, 2.0))
def test_temperature_solves_its_equation(e, T0, epsilon, density, cross_section):
    def T(t):
        return theory.maxwell_temperature(t, T0, e, epsilon, density, cross_section)

    assert T(0.0) == pytest.approx(T0, rel=1e-6)
    h = 1e-4
    derivative = (T(1.0 + h) - T(1.0 - h)) / (2 * h)
    law = 2 * epsilon - (1 - e**2) / 4 * density * cross_section * T(1.0)
    assert derivative == pytest.approx(law, abs=1e-6)


def test_temperature_as_the_paper_writes_it():
    t, e, epsilon, T0 = np.linspace(0, 3, 7), 0.2, 1e-6, 1.425
    steady = 8 * epsilon / (1 - e**2)
    expected = (T0 - steady) * np.exp(-(1 - e**2) * t / 4) + steady
    np.testing.assert_allclose(theory.maxwell_temperature(t, T0, e, epsilon), expected, rtol=1e-15)
    np.testing.assert_array_equal(theory.maxwell_temperature(t, T0, 1.0, 0.1), T0 + 0.2 * t)


def test_anisotropy_rate():
    assert theory.maxwell_anisotropy_rate(1.0, 3) == pytest.approx(0.5)
    assert theory.maxwell_anisotropy_rate(0.0, 2) == pytest.approx(2 * 0.25 * 0.75)
    assert theory.maxwell_anisotropy_rate(0.5, 3, density=2.0) == 2 * (
        theory.maxwell_anisotropy_rate(0.5, 3)
    )


@each_dim
@pytest.mark.parametrize("e", [0.0, 0.37, 1.0])
def test_rates_of_a_discrete_measure_are_exact(dim, e):
    measure = random_measure(dim, seed=int(10 * e) + dim)
    weights, v = measure
    moments = [moment_tensor(order)(v) for order in (2, 3)] + [fourth_moment(v)]
    moments = [np.tensordot(weights, m, 1) for m in moments]
    rates = theory.maxwell_moment_rates(weights.sum(), *moments, e, cross_section=0.7)
    sums = [collision_rate(measure, moment_tensor(order), e, 0.7) for order in (2, 3)]
    np.testing.assert_allclose(rates.pressure, sums[0], rtol=0, atol=1e-13)
    np.testing.assert_allclose(rates.third, sums[1], rtol=0, atol=1e-13)
    assert rates.fourth == pytest.approx(collision_rate(measure, fourth_moment, e, 0.7), rel=1e-12)


@pytest.mark.parametrize(
    ("dim", "N", "R", "orders", "tolerance"),
    [(2, 40, 7.5, (2, 3, 4), 1e-4), (3, 24, 7.0, (2, 4), 1e-3)],  # 3rd in 3D: N = 24 is too few
)
def test_rates_of_a_density_are_those_of_direct_and_diffusion(dim, N, R, orders, tolerance):
    widths, spread = ((0.8, 0.9), 0.6) if dim == 2 else ((0.9, 1.0), 0.5)
    density, e, epsilon = Gaussians(dim, 0, widths, spread), 0.4, 0.3
    scene = gs.Scene(dim, density, gs.maxwell(dim), e)
    operator = gs.collision_operator(scene, gs.Solver(N=N, R=R, method="direct"))
    grid = operator.grid
    f = scene.density(grid)
    start = grid.velocity_moments(f)
    v = np.stack(np.broadcast_arrays(*grid.velocities()), axis=-1) - start.momentum / start.density
    moments = {2: moment_tensor(2), 3: moment_tensor(3), 4: fourth_moment}

    def integral(order, density):
        return np.tensordot(density, moments[order](v), dim) * grid.cell

    rates = theory.maxwell_moment_rates(
        start.density, *(integral(order, f) for order in (2, 3, 4)), e, epsilon
    )
    change = operator(f) + epsilon * grid.laplacian(f)
    for order in orders:
        scale = np.max(np.abs(integral(order, np.abs(change))))
        difference = np.max(np.abs(rates[order - 2] - integral(order, change)))
        assert difference < tolerance * scale, (order, difference / scale)


@each_dim
@pytest.mark.parametrize(("e", "epsilon"), [(0.0, 0.0), (0.6, 0.2), (0.9999999, 0.1), (1.0, 0.1)])
def test_evolution_solves_the_equations(dim, e, epsilon):
    weights, v = random_measure(dim, seed=7)
    rho, cross_section, t = weights.sum(), 0.7, np.array([0.0, 0.5, 2.0, 9.0])
    P, M3 = (np.tensordot(weights, moment_tensor(order)(v), 1) for order in (2, 3))
    M = weights @ fourth_moment(v)

    def slope(_, y):
        state = y[: dim**2].reshape(P.shape), y[dim**2 : -1].reshape(M3.shape), y[-1]
        rates = theory.maxwell_moment_rates(rho, *state, e, epsilon, cross_section)
        return np.concatenate([np.ravel(rate) for rate in rates])

    start = np.concatenate([P.ravel(), M3.ravel(), [M]])
    y = solve_ivp(slope, (0, 9), start, "DOP853", t, rtol=1e-12, atol=1e-13).y
    law = {"restitution": e, "density": rho, "cross_section": cross_section}
    pressure = theory.maxwell_pressure(t, P, diffusion=epsilon, **law)
    third = theory.maxwell_third_moments(t, M3, **law)
    np.testing.assert_allclose(pressure.reshape(4, -1).T, y[: dim**2], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(third.reshape(4, -1).T, y[dim**2 : -1], rtol=1e-9, atol=1e-11)
    T = np.trace(pressure, axis1=1, axis2=2) / (dim * rho)
    a2 = y[-1] / (dim * (dim + 2) * rho * T**2) - 1.0
    got = theory.maxwell_a2(t, P, a2[0], diffusion=epsilon, **law)
    np.testing.assert_allclose(got, a2, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("dim", "e", "epsilon"), [(2, 0.3, 0.0), (3, 0.6, 0.05)])
def test_kurtosis_of_a_simulation(dim, e, epsilon):
    scene = gs.load_scene(f"bkw{dim}d", restitution=e, diffusion=epsilon)
    solver = gs.Solver(N=32, R=9.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=1.0, dt=0.02, progress=False)
    exact = theory.maxwell_a2(ds["time"], ds["pressure"][0], float(ds["a2"][0]), e, epsilon)
    np.testing.assert_allclose(ds["a2"], exact, rtol=0, atol=1e-5)
    assert np.ptp(exact.values) > 0.02


def test_kurtosis_at_the_initial_time():
    np.testing.assert_array_equal(theory.maxwell_a2([0.0], np.eye(2), 0.3, 0.5), [0.3])


def test_kurtosis_keeps_its_accuracy_when_hardly_any_temperature_is_left():
    t = np.array([2000.0])
    end = theory.maxwell_a2(t, np.eye(3), 0.0, 0.5)[0]
    assert theory.maxwell_temperature(t, 1.0, 0.5)[0] < 1e-160
    assert end == pytest.approx(theory.maxwell_cooling_moments(2, 0.5, 3)[2] - 1.0, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: theory.maxwell_anisotropy_rate(0.5, 4), "dim=4: allowed are 2 and 3"),
        (lambda: theory.maxwell_pressure(1.0, np.eye(3), 1.1), "restitution=1.1: must be a number"),
        (lambda: theory.maxwell_pressure(1.0, np.eye(3), gs.Viscoelastic(0.1)), "must be a number"),
        (lambda: theory.maxwell_third_moments(1.0, np.eye(3), 0.5), r"third has shape \(3, 3\)"),
        (lambda: theory.maxwell_pressure(1.0, np.eye(4), 0.5), r"shape \(4, 4\): must be \(2, 2\)"),
        (lambda: theory.maxwell_a2([1.0, 0.5], np.eye(2), 0.0, 0.5), "must be times from 0 on"),
        (lambda: theory.maxwell_a2([-1.0], np.eye(2), 0.0, 0.5), "must be times from 0 on"),
        (lambda: theory.maxwell_a2([1.0], np.zeros((2, 2)), 0.0, 0.5), "must be positive"),
        (lambda: theory.maxwell_a2([1e5], np.eye(2), 0.0, 0.5), "smallest number there is"),
    ],
)
def test_arguments_outside_their_range(call, message):
    with pytest.raises(ValueError, match=message):
        call()
