"""Runge–Kutta schemes: their orders, their limits, exact diffusion."""

import numpy as np
import pytest
from comparison import assert_order

import granstudy as gs
from granstudy.evolution.schemes import DOPRI_STAGES, SCHEMES, dopri54_weights, phi


class Riccati:
    """y' = −y² − κ(y) q² y, the diffusion of a wave of wavenumber q; exact by separation."""

    def __init__(self, kappa=0.0):
        self.kappa = kappa

    def rate(self, y, taken_off=0.0):
        return -(y**2) - (self.kappa - taken_off) * y

    def diffusivity(self, y):
        return self.kappa

    def laplacian_functions(self, x, terms):
        return sum(function(-x * np.ones(1)) * y for function, y in terms)

    def exact(self, t):
        k = self.kappa
        return 1 / (1 + t) if k == 0 else k / ((1 + k) * np.exp(k * t) - 1)


def march(equation, scheme, steps):
    made, y, h = SCHEMES[scheme], np.ones(1), 1.0 / steps
    for _ in range(steps):
        y = made.step(equation, y, h, made.first(equation, y)).state
    return y[0]


@pytest.mark.parametrize("kappa", [0.0, 1.5])
@pytest.mark.parametrize(("scheme", "order"), [("rk3", 3), ("dopri54", 5), ("exponential", 3)])
def test_orders(scheme, order, kappa):
    equation = Riccati(kappa)
    counts = np.array([8, 16, 32, 64] if order == 3 else [2, 4, 8, 16])
    errors = [abs(march(equation, scheme, n) - equation.exact(1.0)) for n in counts]
    assert_order(1.0 / counts, errors, order, 1e-5)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_error_of_a_step_has_the_lower_schemes_order(scheme):
    made, equation, y = SCHEMES[scheme], Riccati(1.0), np.ones(1)
    steps = np.array([0.1, 0.05, 0.025])
    errors = [made.step(equation, y, h, made.first(equation, y)).difference for h in steps]
    orders = np.diff(np.log(np.abs(errors).ravel())) / np.diff(np.log(steps))
    assert np.all(np.abs(orders - made.error_order - 1) < 0.2), orders


def test_the_exponential_scheme_without_diffusion_is_kuttas():
    equation, y = Riccati(), np.array([0.7])
    steps = [
        SCHEMES[name].step(equation, y, 0.3, equation.rate(y)) for name in ("rk3", "exponential")
    ]
    np.testing.assert_allclose(steps[1].state, steps[0].state, rtol=1e-15)
    np.testing.assert_allclose(steps[1].difference, steps[0].difference, rtol=1e-12)


def test_a_rate_that_does_not_change_is_kept_between_dopri54_steps():
    equation, y = Riccati(), np.array([0.7])
    made = SCHEMES["dopri54"].step(equation, y, 0.3, equation.rate(y))
    np.testing.assert_array_equal(made.last, equation.rate(made.state))


def test_the_interpolant_of_dopri54_meets_all_conditions_of_order_four():
    """Σ b_i(θ) Φ_i = θ^p/γ over the rooted trees, and nowhere an order more."""
    A = np.array([[*row, *[0.0] * (7 - len(row))] for row in ((), *DOPRI_STAGES)])
    c = A.sum(axis=1)
    trees = [
        (1, 1, c**0),
        (2, 2, c),
        (3, 3, c**2),
        (3, 6, A @ c),
        (4, 4, c**3),
        (4, 8, c * (A @ c)),
        (4, 12, A @ c**2),
        (4, 24, A @ A @ c),
    ]
    for theta in (0.1, 0.5, 0.9, 1.0):
        b = dopri54_weights(theta)
        for order, gamma, phi_i in trees:
            assert b @ phi_i == pytest.approx(theta**order / gamma, abs=1e-14)
        assert theta == 1.0 or abs(b @ c**4 - theta**5 / 5) > 1e-5
    assert dopri54_weights(1.0)[:6] == pytest.approx(DOPRI_STAGES[-1], abs=1e-15)


def test_the_interpolant_of_dopri54_has_errors_of_fifth_order_below_what_its_scheme_says():
    made, equation, y = SCHEMES["dopri54"], Riccati(), np.ones(1)
    sizes = np.array([0.2, 0.1, 0.05])
    for theta in (0.25, 0.7):
        errors = []
        for h in sizes:
            step = made.step(equation, y, h, equation.rate(y))
            errors.append(abs(step.inside(theta)[0] - equation.exact(theta * h)))
            assert errors[-1] < made.interpolation_error * abs(step.difference[0])
        orders = np.diff(np.log(errors)) / np.diff(np.log(sizes))
        assert np.all(np.abs(orders - 5) < 0.7), orders


def test_phi_is_smooth_through_the_change_from_series_to_quotient():
    z = -np.array([0.0, 1e-9, 1e-3, 0.5, 1.0 - 1e-12, 1.0 + 1e-12, 3.0, 50.0])
    x, w = np.polynomial.legendre.leggauss(60)
    s, w = (x + 1) / 2, w / 2
    np.testing.assert_allclose(phi(0)(z), np.exp(z), rtol=1e-14)
    for k, factor in ((1, 1.0), (2, s), (3, s**2 / 2)):
        integral = np.exp(np.multiply.outer(z, 1 - s)) @ (w * factor)
        np.testing.assert_allclose(phi(k)(z), integral, rtol=1e-12)


@pytest.mark.parametrize("scheme", ["rk3", "dopri54"])
@pytest.mark.parametrize("part", ["real", "imaginary"])
def test_limits_are_those_of_the_stability_polynomial(scheme, part):
    made = SCHEMES[scheme]
    limit, unit = (made.real_limit, -1.0) if part == "real" else (made.imaginary_limit, 1j)

    class Linear:
        def rate(self, y):
            return unit * y

    def growth(h):
        y = np.ones(1, dtype=complex)
        return abs(made.step(Linear(), y, h, unit * y).state[0])

    assert max(growth(h) for h in np.linspace(0.01, 1.0, 50) * limit) <= 1.0 + 1e-9
    assert growth(limit * 1.01) > 1.0 + 1e-9


STRONG = gs.VHS(0.0, 4.0 / (4.0 * np.pi))
HEATED = gs.Scene(dim=3, initial="bkw3d", kernel=STRONG, restitution=0.2, diffusion=0.4)
RADIAL = gs.Solver(N=32, R=9.0, method="radial")


def limit(scheme):
    grid = gs.RadialGrid(3, 32, 9.0)
    return gs.stability_limit(scheme, grid, diffusion=0.4, collision_frequency=4.0)


@pytest.mark.parametrize("scheme", ["rk3", "dopri54"])
def test_explicit_schemes_blow_up_just_above_their_limit_and_not_below(scheme):
    runs = {}
    for part in (0.97, 1.03):
        dt = part * limit(scheme)
        runs[part] = gs.simulate(
            HEATED, RADIAL, t_final=500 * dt, dt=dt, scheme=scheme, progress=False
        )
    below, above = runs[0.97], runs[1.03]
    assert int(below["status"]) == 0 and not below["status"].attrs["warnings"]
    assert float(below["temperature"][-1]) == pytest.approx(2 * 0.4 / 0.96, rel=1e-4)
    assert int(above["status"]) == 2
    assert f"scheme {scheme!r} is stable" in above["status"].attrs["warnings"]


def test_the_exponential_scheme_is_stable_far_beyond_and_of_order_three():
    steps = np.array([0.4, 0.2, 0.1])
    assert 5 * limit("rk3") < steps[0] < limit("exponential")
    runs = [
        gs.simulate(HEATED, RADIAL, t_final=2.0, dt=dt, scheme="exponential", progress=False)
        for dt in steps
    ]
    exact = gs.simulate(HEATED, RADIAL, t_final=2.0, time_rtol=1e-9, times=[1.0], progress=False)
    for name in ("temperature", "a2"):
        errors = [abs(float(ds[name][-1] - exact[name][-1])) for ds in runs]
        assert_order(steps, errors, 3, 1e-4)
    assert float(runs[-1]["temperature_error"][-1]) < 1e-5


@pytest.mark.parametrize("method", ["fast", "literal"])
def test_exact_diffusion_of_values_and_spectra(method):
    """Without collisions to speak of one step of any size takes a Gaussian to T + 2εt."""
    kernel = gs.VHS(0.0, 1e-12)
    scene = gs.load_scene("maxwellian2d", restitution=0.5, kernel=kernel, diffusion=0.5)
    solver = gs.Solver(N=48, R=9.0, N_rho=4, M_cir=4, method=method)
    ds = gs.simulate(
        scene, solver, t_final=0.5, dt=0.5, scheme="exponential", save_every=1, progress=False
    )
    later = gs.load_scene("maxwellian2d", temperature=1.5)
    f = later.density(gs.VelocityGrid(2, 48, 9.0))
    assert np.max(np.abs(ds["f"].values[-1] - f)) < 1e-8


def test_an_unknown_scheme_has_no_limit():
    with pytest.raises(ValueError, match="unknown scheme 'rk4'.*did you mean 'rk3'"):
        gs.stability_limit("rk4", gs.RadialGrid(3, 16, 7.0))
