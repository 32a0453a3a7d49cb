"""Cooling and heated states: against exact moments, theory, marching, and one method against another."""

import json
from dataclasses import replace

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory
from granstudy.collision import collision_operator
from granstudy.states.equation import SteadyEquation
from granstudy.states.newton import newton
from granstudy.velocity.sphere import sphere_area

RADIAL = gs.Solver(N=32, R=10.0, method="radial")


def gas(restitution, exponent=1.0, diffusion=0.0, name="maxwellian3d", **overrides):
    kernel = gs.VHS(exponent, 1.0 / sphere_area(int(name[-2])))
    fields = {"kernel": kernel, "restitution": restitution, "diffusion": diffusion}
    return gs.load_scene(name, **fields | overrides)


def state(scene, solver=RADIAL, **settings):
    find = gs.heated_state if scene.diffusion else gs.cooling_state
    ds = find(scene, solver, **settings)
    assert int(ds["status"]) == 0, ds["status"].attrs["reason"]
    return ds


def simulated(scene, solver, t_final, **settings):
    ds = gs.simulate(scene, solver, t_final=t_final, progress=False, **settings)
    assert int(ds["status"]) == 0, ds["status"].attrs["reason"]
    return ds.isel(time=-1)


def cooling_equation(dim, exponent=1.0):
    """The equation of a cooling state, and that state."""
    scene = gas(0.8, exponent, name=f"maxwellian{dim}d")
    solver = gs.Solver(N=28, R=9.0, method="radial")
    operator = collision_operator(scene, solver)
    grid = operator.grid
    equation = SteadyEquation(grid, operator, grid.dilation, lambda g: g, 1.0, 1.0)
    found = newton(equation, equation.start(scene.density(grid)), 1e-12, 9)
    assert not found.reason, found.reason
    return equation, found.x


@pytest.mark.parametrize("dim", [2, 3])
def test_the_derivative_is_exact(dim):
    """F is at most quadratic in g, s, m: half its difference over x ± h is F'(x) h, to round-off."""
    equation, x = cooling_equation(dim)
    h = np.random.default_rng(1).normal(size=x.size) * np.max(x[:-2])
    difference = (equation.residual(x + h) - equation.residual(x - h)) / 2
    change = equation.derivative(x)(h)
    np.testing.assert_allclose(change, difference, rtol=0, atol=1e-12 * np.max(np.abs(change)))


@pytest.mark.parametrize("exponent", [0.0, 0.5, 1.0])
def test_what_changes_units_only_is_held(exponent):
    """More density, (g, s), and more temperature, (−∇c·(c g), λs), leave the equation as it is."""
    equation, x = cooling_equation(3, exponent)
    g, s, _ = equation.split(x)
    act = equation.derivative(x)
    for h, s_step, held in ((g, s, (1.0, 1.0)), (-equation.balance(g), exponent * s, (0.0, 2.0))):
        change = act(np.concatenate([h, [s_step, 0.0]]))
        np.testing.assert_allclose(change[-2:], held, atol=2e-3)
        assert np.max(np.abs(change[:-2])) < 2e-3 * np.max(np.abs(s * equation.balance(h)))


@pytest.mark.parametrize("diffusion", [0.0, 0.1])
@pytest.mark.parametrize("restitution", [0.0, 0.6, 0.95])
def test_the_residual_falls_quadratically(restitution, diffusion):
    ds = state(gas(restitution, diffusion=diffusion))
    sizes = ds["residual"].values
    assert 3 <= sizes.size <= 5
    fast = sizes[:-1] < 0.5
    assert np.all(sizes[1:][fast] < np.maximum(0.3 * sizes[:-1][fast] ** 2, 1e-12))


@pytest.mark.parametrize(("dim", "restitution"), [(2, 0.8), (2, 0.95), (3, 0.7), (3, 0.9)])
def test_maxwell_cooling_state_has_the_exact_kurtosis(dim, restitution):
    ds = state(gas(restitution, 0.0, name=f"maxwellian{dim}d"), replace(RADIAL, R=12.0))
    exact = theory.maxwell_cooling_moments(3, restitution, dim)
    a2, _ = theory.sonine_coefficients(exact)
    assert float(ds["a2"]) == pytest.approx(a2, abs=1e-4)
    assert float(ds["cooling_rate"]) == pytest.approx((1 - restitution**2) / 4, rel=1e-4)


@pytest.mark.parametrize("dim", [2, 3])
@pytest.mark.parametrize("restitution", [0.5, 0.7, 0.9])
def test_maxwell_heated_state_has_the_exact_kurtosis(dim, restitution):
    """And the exact temperature, 8ε/(1−e²), and a3: its tail is exponential."""
    scene = gas(restitution, 0.0, 0.05, name=f"maxwellian{dim}d")
    ds = state(scene, replace(RADIAL, R=12.0))
    a2, a3 = theory.sonine_coefficients(theory.maxwell_heated_moments(3, restitution, dim))
    assert float(ds["a2"]) == pytest.approx(a2, abs=1e-5)
    assert float(ds["a3"]) == pytest.approx(a3, abs=2e-4)
    assert float(ds["temperature"]) == pytest.approx(0.4 / (1 - restitution**2), rel=1e-6)


def test_what_a_power_law_tail_costs():
    """f ~ |v|^{−d−p}: what lies beyond the box takes V^{4−p} off a2, once V is in the tail."""
    restitution, dim = 0.2, 3
    scene = gas(restitution, 0.0)
    exact = theory.maxwell_cooling_moments(2, restitution, dim)[2] - 1.0
    R = np.array([8.0, 12.0, 18.0])
    errors = []
    for N, box in zip((24, 36, 54), R, strict=True):
        ds = state(scene, gs.Solver(N=N, R=box, method="radial"))
        errors.append(abs(float(ds["a2"]) - exact))
    rates = -np.diff(np.log(errors)) / np.diff(np.log(R))
    p = theory.maxwell_tail_exponent(restitution, dim)
    assert 0.4 * (p - 4.0) < rates[0] < rates[1] < 1.05 * (p - 4.0)
    assert rates[1] > 0.7 * (p - 4.0)
    # the tail itself, where pairs beyond R are not yet missed
    far = (ds["tail_speed"] > R[-1] / 4) & (ds["tail_speed"] < R[-1] / 3)
    slope = float(ds["tail_slope"].where(far).mean())
    assert slope == pytest.approx(dim + p, rel=0.1)


def test_hard_spheres_are_near_the_theories():
    """Kurtosis to 0.003 and the cooling rate to 0.1%; the heated state is the nearer one to a Gaussian."""
    for restitution in (0.2, 0.5, 0.8, 0.9):
        cooling = state(gas(restitution))
        a2 = float(cooling["a2"])
        assert a2 == pytest.approx(theory.montanero_santos_a2(restitution), abs=3e-3)
        assert float(cooling["a3"]) < 0.0
        heated = state(gas(restitution, diffusion=0.1))
        assert float(heated["a2"]) == pytest.approx(theory.heated_state_a2(restitution), abs=3e-3)
        assert abs(float(heated["a2"])) < abs(a2)
        correction = theory.cooling_correction(1.0, a2, float(cooling["a3"]))
        K = theory.gaussian_cooling_coefficient(gas(0.5).kernel, restitution, 3)
        assert float(cooling["cooling_coefficient"]) == pytest.approx(K * correction, rel=1e-3)


def test_kurtosis_changes_sign_near_one_over_root_two():
    below, above = (float(state(gas(e))["a2"]) for e in (0.69, 0.72))
    assert below > 0.0 > above


def test_tails_of_hard_spheres():
    """The slope of −ln f at the last speeds seen, against the leading order of theory."""
    cooling = state(gas(0.2))
    slope = cooling["tail_slope"]
    assert float(slope["tail_speed"][-1]) > 5.5
    A = theory.cooling_tail_rate(0.2, a2=float(cooling["a2"]))
    assert float(slope[-3:].mean()) == pytest.approx(A, rel=0.03)
    heated = state(gas(0.2, diffusion=0.1))
    B = theory.heated_tail_rate(0.2, a2=float(heated["a2"]))
    assert float(heated["tail_slope"][-3:].mean()) == pytest.approx(B, rel=0.03)
    assert slope.attrs["power"] == 1.0
    assert heated["tail_slope"].attrs["power"] == 1.5


def test_cooling_state_is_where_marching_ends():
    scene = gas(0.5, name="bkw3d")
    found = state(scene)
    late = simulated(scene, RADIAL, 300.0, frame="rescaled", time_rtol=1e-9, save_every=100)
    assert float(late["a2"]) == pytest.approx(float(found["a2"]), abs=1e-6)
    g = late["g"].isel(snapshot=-1).values
    np.testing.assert_allclose(g, found["g"].values, rtol=0, atol=1e-6 * np.max(g))


@pytest.mark.parametrize("exponent", [0.5, 1.0])
def test_heated_state_from_hot_and_from_cold(exponent):
    """By marching on one grid for both, and by direct solves from either temperature."""
    solver = gs.Solver(N=36, R=11.0, method="radial")
    K = theory.gaussian_cooling_coefficient(gas(0.4, exponent).kernel, 0.4, 3)
    found = []
    for temperature in (0.5, 2.0):
        scene = gas(0.4, exponent, K / 2, temperature=temperature)  # so that T is about 1
        found.append(simulated(scene, solver, 40.0, dt=0.05))
        found.append(state(scene, replace(solver, R=11.0 * np.sqrt(temperature))))
    for name in ("temperature", "a2"):
        values = [float(ds[name]) for ds in found]
        assert np.ptp(values) < 1e-6, (name, values)


@pytest.mark.parametrize("diffusion", [0.0, 0.1])
@pytest.mark.parametrize(
    ("method", "restitution", "exponent"), [("fast", 0.7, 1.0), ("carleman", 0.9, 0.0)]
)
def test_radial_and_cartesian_agree(method, restitution, exponent, diffusion):
    """Also for a gas that moves and is not isotropic: its ρ, u and T alone matter.

    To a few times what aliasing at this N, and in `carleman` truncation at 0.854 R, leave of Q.
    """
    tolerance = {"fast": 1e-4, "carleman": 4e-4}[method]
    scene = gas(restitution, exponent, diffusion, "double_well2d")
    solver = gs.Solver(N=36, R=9.0, N_rho=14, M_cir=24, method=method)
    cartesian = state(scene, solver)
    grid = solver.grid(2)
    asked = gs.moments(scene.density(grid), grid)
    density, T = float(asked["density"]), float(asked["temperature"])
    np.testing.assert_allclose(cartesian["velocity"], asked["velocity"], atol=1e-12)
    radial = gs.Solver(N=28, R=9.0, method="radial")
    isotropic = gas(restitution, exponent, diffusion, "maxwellian2d", temperature=T)
    expected = state(isotropic, radial)
    for name in ("a2", "cooling_coefficient"):
        assert float(cartesian[name]) == pytest.approx(float(expected[name]), abs=tolerance), name
    g = density * gs.RadialGrid(2, 28, 9.0).to_cartesian(expected["g"].values, grid)
    assert np.max(np.abs(cartesian["g"].values - g)) < tolerance * np.max(g)


def test_temperature_and_strength_only_set_units():
    scene = gas(0.3)
    one = state(scene)
    stronger = replace(scene, kernel=gs.VHS(1.0, 5.0 / sphere_area(3)))
    hot = replace(stronger, initial=gas(0.3, temperature=4.0).initial)
    other = state(hot, replace(RADIAL, R=20.0))
    for name in ("a2", "a3"):
        assert float(other[name]) == pytest.approx(float(one[name]), rel=1e-9)
    assert float(other["temperature"]) == pytest.approx(4.0, rel=1e-9)
    assert float(other["cooling_rate"]) == pytest.approx(
        10.0 * float(one["cooling_rate"]), rel=1e-9
    )


def test_dataset_says_what_it_is(tmp_path):
    ds = state(gas(0.5, diffusion=0.1), gs.Solver(N=40, R=8.0, method="auto"))
    gs.write_dataset(ds, tmp_path / "state.nc")
    again = gs.read_dataset(tmp_path / "state.nc")
    assert again["g"].dims == ("c",)
    assert again.attrs["title"] == "granstudy heated state"
    assert json.loads(again.attrs["solver"])["method"] == "radial"
    assert json.loads(again.attrs["asked_solver"])["method"] == "auto"
    assert float(again["e"]) == 0.5
    theta, T = float(again["velocity_scale"]), float(again["temperature"])
    assert theta**2 == pytest.approx(T, rel=1e-9)
    assert float(again["cooling_rate"]) == pytest.approx(0.2 / T, rel=1e-9)


@pytest.mark.parametrize(
    ("scene", "solver"),
    [
        (gas(0.6, diffusion=0.02), RADIAL),
        (gas(0.9, 0.0, 0.03, "double_well2d"), gs.Solver(N=28, R=9.0, M_cir=12, N_rho=10)),
    ],
)
def test_the_density_over_velocities(scene, solver):
    """f(v) from g(c): its moments about v = 0 are ρ, ρu and ½ρ(|u|² + dT), whatever θ is."""
    ds = state(scene, solver)
    f, theta, d = gs.physical_density(ds), float(ds["velocity_scale"]), ds.sizes["component"]
    assert abs(theta - 1.0) > 0.05
    if "c" in f.dims:
        V2 = np.square(f["r"])
        measure = theta**d * ds["c_weight"]
    else:
        v = [f[f"v{axis}"] for axis in "xy"]
        V2 = sum(np.square(vi) for vi in v)
        measure = float(np.prod([vi[1] - vi[0] for vi in v]))
        for i, vi in enumerate(v):
            u = (vi * f * measure).sum() / ds["density"]
            assert float(u) == pytest.approx(float(ds["velocity"][i]), abs=1e-10)
    assert float((f * measure).sum()) == pytest.approx(float(ds["density"]), rel=1e-9)
    energy = float(ds["density"] * (np.sum(ds["velocity"] ** 2) + d * ds["temperature"]))
    assert float((V2 * f * measure).sum()) == pytest.approx(energy, rel=1e-9)


def test_what_is_not_found_is_not_passed_off():
    ds = gs.cooling_state(gas(0.5), RADIAL, tolerance=1e-30, max_iterations=4)
    assert int(ds["status"]) == 1
    assert "after 4 steps, the tolerance 1e-30" in ds["status"].attrs["reason"]
    assert ds["residual"].size == 5


@pytest.mark.parametrize(
    ("find", "scene", "solver", "message"),
    [
        (
            gs.cooling_state,
            gas(0.5, diffusion=0.1),
            RADIAL,
            "diffusion=0.1: a cooling state has none",
        ),
        (gs.heated_state, gas(0.5), RADIAL, "diffusion=0.0: must be positive"),
        (gs.cooling_state, gas(1.0), RADIAL, "restitution=1.0: must be below 1"),
        (gs.cooling_state, gas(gs.Viscoelastic(0.1)), RADIAL, "restitution=Viscoelastic.*a number"),
        (gs.cooling_state, gas(0.5), gs.Solver(method="dsmc", N=16, R=8.0, particles=1000), "dsmc"),
        (gs.cooling_state, gas(0.5), gs.Solver(rtol=1e-3), "N=None: a state is not known"),
        (gs.cooling_state, gas(0.5), gs.Solver(N=16, R=8.0, rtol=1e-3), "rtol=0.001: holds for"),
    ],
)
def test_what_has_no_state(find, scene, solver, message):
    with pytest.raises(ValueError, match=message):
        find(scene, solver)


@pytest.mark.parametrize(
    ("name", "value"), [("tolerance", 0.0), ("tolerance", "tight"), ("max_iterations", 0)]
)
def test_wrong_settings(name, value):
    with pytest.raises(ValueError, match=f"{name}={value!r}: must be"):
        gs.cooling_state(gas(0.5), RADIAL, **{name: value})


@pytest.mark.parametrize(
    ("scene", "N", "R", "a2"),
    [
        (gas(0.2, 0.0), 32, 12.0, 16 / 17),  # a tail that no box holds
        (gas(0.5), 16, 10.0, 0.047612),  # too few speeds
        (gas(0.5), 24, 5.0, 0.047612),  # too small a box
        (gas(0.5), 32, 10.0, 0.047612),
        (gas(0.5, diffusion=0.1), 32, 10.0, 0.025015),
    ],
)
def test_trust_is_earned(scene, N, R, a2):
    """The estimated error is no less than the true one, and an error of 0.01 is not trusted."""
    ds = state(scene, gs.Solver(N=N, R=R, method="radial"))
    error = abs(float(ds["a2"]) - a2)
    assert error < float(ds["a2_error_estimate"]) + 1e-6
    assert int(ds["trust"]) == (0 if error > 0.01 else 2), ds["trust"].attrs["reasons"]
