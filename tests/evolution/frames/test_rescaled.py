"""Rescaled velocities: the same gas as on fixed ones, and long after they have lost it."""

from dataclasses import replace

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory
from granstudy.collision import collision_operator
from granstudy.evolution.frames.rescaled import RescaledFrame, balance
from granstudy.evolution.frames.scaled_collisions import SPACING, InterpolatedCollisions
from granstudy.evolution.unknowns import collisions, representation
from granstudy.model.restitution import ScaledRestitution
from granstudy.trust.flags import Status
from granstudy.velocity.sphere import sphere_area

RADIAL = gs.Solver(N=28, R=8.0, method="radial")


def cooling(name="maxwellian3d", exponent=1.0, **overrides):
    dim = int(name[-2])
    kernel = gs.VHS(exponent, 1.0 / sphere_area(dim))
    return gs.load_scene(
        name, kernel=kernel, **({"restitution": 0.5, "diffusion": 0.0} | overrides)
    )


def run(scene, solver, t_final, frame="rescaled", **time):
    time = {"time_rtol": 1e-6, "times": [t_final / 2], "progress": False} | time
    ds = gs.simulate(scene, solver, t_final=t_final, frame=frame, **time)
    assert int(ds["status"]) == 0, ds["status"].attrs["reason"]
    return ds


FRAMES_CASES = {
    # method, exponent: restitution, settings, tolerance
    ("fast", 0.0): (0.5, {"N": 40, "N_rho": 14, "M_cir": 14}, 1e-5),
    ("fast", 1.0): (0.5, {"N": 40, "N_rho": 14, "M_cir": 14}, 1e-5),
    ("literal", 1.0): (0.5, {"N": 40, "N_rho": 14, "M_cir": 14}, 1e-5),
    ("carleman", 0.0): (0.95, {"N": 40, "M_cir": 24}, 1e-6),
    ("radial", 1.0): (0.5, {"N": 32}, 1e-5),
    ("direct", 0.5): (0.5, {"N": 16, "N_rho": 14, "R": 6.0}, 5e-3),
}


@pytest.mark.parametrize(("method", "exponent"), FRAMES_CASES)
def test_both_frames_see_the_same_gas(method, exponent):
    """T(t), a2(t) and the density itself, heated, and moving where the method can."""
    restitution, settings, tolerance = FRAMES_CASES[method, exponent]
    moves = {} if method == "radial" else {"velocity": (0.4, -0.2)}
    scene = cooling("maxwellian2d", exponent, restitution=restitution, diffusion=0.01, **moves)
    solver = gs.Solver(**{"R": 9.0} | settings, method=method)
    fixed, rescaled = (
        gs.simulate(scene, solver, t_final=0.5, dt=0.1, save_every=5, frame=frame, progress=False)
        for frame in ("fixed", "rescaled")
    )
    if method != "carleman":
        assert float(rescaled["velocity_scale"][-1]) < 0.99
    for name in ("temperature", "velocity", "pressure", "energy", "density"):
        assert float(abs(fixed[name] - rescaled[name]).max()) < tolerance, name
    assert float(abs(fixed["a2"] - rescaled["a2"]).max()) < 10 * tolerance
    # f on the rescaled run's own velocities, by the fixed run's interpolating series
    f = gs.physical_density(rescaled).isel(snapshot=-1)
    assert_same_density(f, fixed["f"].isel(snapshot=-1), scene, solver, 3 * tolerance)


def assert_same_density(f, expected, scene, solver, tolerance):
    if solver.method == "radial":
        grid = gs.RadialGrid(2, solver.N, solver.R)
        values = grid.evaluate(expected.values, f["r"].values)
    else:
        grid = gs.VelocityGrid(2, solver.N, solver.R)
        coefficients = np.fft.fft2(expected.values) / expected.size
        waves = [
            np.exp(1j * np.pi / grid.L * np.outer(f[axis].values - grid.nodes[0], grid.wavenumbers))
            for axis in ("vx", "vy")
        ]
        values = (waves[0] @ coefficients @ waves[1].T).real
    assert np.max(np.abs(f.values - values)) < tolerance


def test_the_temperature_of_g_stays_to_round_off_and_to_the_steps_error_where_diffusion_is_exact():
    scene = cooling("double_well2d", 1.0, diffusion=0.05)
    solver = gs.Solver(N=32, R=8.0, N_rho=12, M_cir=12, variant="full")
    drift = {}
    for scheme, dt in (("rk3", 0.025), ("exponential", 0.05), ("exponential", 0.025)):
        ds = gs.simulate(
            scene, solver, t_final=0.5, dt=dt, frame="rescaled", scheme=scheme, progress=False
        )
        T_g = ds["temperature"] / ds["velocity_scale"] ** 2
        drift[scheme, dt] = float(abs(T_g / T_g[0] - 1).max())
    assert drift["rk3", 0.025] < 1e-12
    assert drift["exponential", 0.025] < 1e-5
    assert drift["exponential", 0.05] / drift["exponential", 0.025] > 6.0


def test_the_scale_follows_the_energy_at_any_density():
    """θ'/θ = (T_Q + 2ε)/(2T_g) with T_Q = ∫|c|²Q/(dρ) (docs/method.md §5)."""
    scene = cooling("maxwellian2d", 1.0, restitution=0.3, diffusion=0.07)
    operator = collision_operator(scene, gs.Solver(N=32, R=9.0, N_rho=14, M_cir=14))
    grid = operator.grid
    frame = RescaledFrame(
        representation(operator, scene.symmetry),
        lambda g, scale: operator(g),
        scene,
        np.zeros(2),
    )
    g = 1.7 * scene.density(grid)
    rate = frame.rate(frame.start(g))[grid.N**2 :]
    c2 = sum(v**2 for v in grid.velocities())
    T_Q = np.sum(c2 * operator(g)) * grid.cell / (2 * 1.7)
    assert rate[0] == pytest.approx((T_Q + 2 * 0.07) / 2.0, rel=1e-6)
    assert rate[1] == 1.0 and np.all(np.abs(rate[2:]) < 1e-10)


def test_balance_is_the_derivative_of_temperature_and_velocity():
    M = np.array([1.3, 0.4, -0.2, 2.1])
    change = np.array([0.3, -0.5, 0.7, -0.4])

    def temperature_and_velocity(M):
        u = M[1:3] / M[0]
        return (2 * M[3] / M[0] - u @ u) / 2, u

    h = 1e-6
    (T1, u1), (T0, u0) = (temperature_and_velocity(M + s * h * change) for s in (1, -1))
    shrinking, drift = balance(M, change, 2)
    assert shrinking == pytest.approx(
        (T1 - T0) / (4 * h) / temperature_and_velocity(M)[0], rel=1e-8
    )
    np.testing.assert_allclose(drift, (u1 - u0) / (2 * h), rtol=1e-8)


def test_maxwell_molecules_follow_the_exact_law_over_a_hundred_collisions():
    scene = cooling(exponent=0.0, restitution=0.9)
    ds = run(scene, gs.Solver(N=40, R=11.0, method="radial"), 100.0, time_rtol=1e-10)
    assert float(ds["temperature"][-1]) < 0.01
    assert float((ds["temperature_error"] / ds["temperature_exact"]).max()) < 1e-8


@pytest.mark.parametrize("exponent", [1.0, 0.5])
def test_haffs_law_over_eight_decades(exponent):
    scene = cooling(exponent=exponent, restitution=0.8)
    ds = gs.simulate(
        scene, replace(RADIAL, N=20), t_final=1e6, time_rtol=1e-6, frame="rescaled", progress=False
    )
    assert ds["time"].values[1] == 1e-2 and ds.sizes["time"] == 82
    T, t = np.log(ds["temperature"].values[-3:]), np.log(ds["time"].values[-3:])
    assert np.all(np.abs(np.diff(T) / np.diff(t) + 2.0 / exponent) < 1e-3)
    a2 = ds["a2"].values[-5:]
    assert np.ptp(a2) < 1e-5
    assert float(abs(ds["density"] - 1.0).max()) < 1e-12
    if exponent == 1.0:
        assert a2[-1] == pytest.approx(theory.cooling_state_a2(0.8), abs=3e-3)


def test_the_cooling_state_is_steady_and_the_same_for_radial_and_fast():
    scene = cooling("maxwellian2d")
    radial = run(scene, RADIAL, 200.0, time_rtol=1e-5)
    fast = run(scene, gs.Solver(N=36, R=8.0, N_rho=14, M_cir=14), 200.0, time_rtol=1e-5)
    for ds in (radial, fast):
        assert abs(float(ds["a2"][-1] - ds["a2"][-2])) < 1e-4
    assert float(fast["a2"][-1]) == pytest.approx(float(radial["a2"][-1]), abs=1e-4)
    T = [float(ds["temperature"][-1]) for ds in (radial, fast)]
    assert T[0] == pytest.approx(T[1], rel=1e-4)


def test_a_heated_gas_comes_to_the_steady_state_of_the_fixed_frame_from_hot_and_from_cold():
    end = {"exponent": 1.0, "diffusion": 0.1}
    fixed = run(cooling(**end), replace(RADIAL, N=32), 30.0, "fixed", scheme="exponential")
    ends = [
        run(cooling(**end, temperature=T), replace(RADIAL, R=9.0 * T**0.5), 30.0)
        for T in (0.25, 2.0)
    ]
    for ds in ends:
        assert float(ds["temperature"][-1]) == pytest.approx(
            float(fixed["temperature"][-1]), rel=2e-5
        )
    T, a2 = ([float(ds[name][-1]) for ds in ends] for name in ("temperature", "a2"))
    assert T[0] == pytest.approx(T[1], rel=1e-5) and a2[0] == pytest.approx(a2[1], abs=1e-5)


MOTION_CASES = {
    # name, exponent, e, ε, t: settings; error of a2 that is left
    ("bkw2d", 0.0, 1.0, 0.11, 0.1): ({"N": 24, "R": 9.5, "method": "radial"}, 2e-4),
    ("bkw2d", 0.0, 0.5, 0.05, 1.0): ({"N": 24, "R": 9.5, "method": "radial"}, 1e-4),
    ("bkw2d", 1.0, 1.0, 0.11, 1.0): ({"N": 40, "R": 9.0, "N_rho": 24, "M_cir": 24}, 2e-6),
}


@pytest.mark.fault("L1")
@pytest.mark.parametrize("case", MOTION_CASES, ids=str)
def test_the_motion_of_the_frame_does_not_carry_noise_into_a2(case):
    """A spectral ∇·(c g) moved what f does between nodes onto nodes: 0.17, 3e-3 and 2.4e-2 in a2."""
    name, exponent, e, epsilon, t = case
    settings, error = MOTION_CASES[case]
    scene = cooling(name, exponent, restitution=e, diffusion=epsilon)
    truth = run(scene, gs.Solver(N=44, R=12.0, method="radial"), t, "fixed", time_rtol=1e-9)
    ds = run(scene, gs.Solver(**settings), t, time_rtol=1e-7)
    assert abs(float(ds["a2"][-1] - truth["a2"][-1])) < error
    assert float(ds["temperature"][-1]) == pytest.approx(float(truth["temperature"][-1]), rel=1e-5)


def test_the_cooling_state_of_disks_is_right_on_a_small_grid():
    scene = cooling("maxwellian2d", restitution=0.2)
    ds = run(scene, gs.Solver(N=40, R=12.0, method="radial"), 1e6, times=[1e5])
    # the limit of finer and larger grids
    assert float(ds["a2"][-1]) == pytest.approx(0.1464426, abs=2e-6)


def test_a_drift_of_momentum_moves_the_frame():
    """Four directions keep neither momentum nor mass; the gas stays on the grid all the same."""
    scene = cooling("double_well2d", symmetry="none")
    solver = gs.Solver(N=32, R=8.0, N_rho=10, M_cir=5)
    ds = run(scene, solver, 20.0, time_rtol=1e-4)
    moved = float(abs(ds["frame_velocity"][-1] - ds["frame_velocity"][0]).max())
    assert moved > 1e-3
    u_g = (ds["velocity"] - ds["frame_velocity"]) / ds["velocity_scale"]
    assert float(ds["velocity_scale"][-1]) < 0.5
    assert float(abs(u_g - u_g[0]).max()) < 1e-10


def test_restitution_that_depends_on_the_impact_speed():
    scene = cooling("maxwellian2d", restitution=gs.Viscoelastic(0.3))
    solver = gs.Solver(N=24, R=7.0, N_rho=10, M_cir=10)
    fixed, rescaled = (
        gs.simulate(scene, solver, t_final=0.6, dt=0.1, frame=frame, progress=False)
        for frame in ("fixed", "rescaled")
    )
    assert float(rescaled["velocity_scale"][-1]) < 0.98
    assert float(abs(fixed["temperature"] - rescaled["temperature"]).max()) < 5e-4


def test_q_is_interpolated_in_the_scale_at_order_four(monkeypatch):
    scene = cooling("bkw2d", restitution=lambda v: 0.6 + 0.2 * np.tanh(1.0 - 0.5 * v))
    solver = gs.Solver(N=16, R=7.0, N_rho=8, M_cir=8)
    operator = collision_operator(scene, solver)
    f = scene.density(operator.grid)
    spacings = np.array([1.0, 0.5, SPACING])
    errors = []
    for spacing in spacings:
        monkeypatch.setattr("granstudy.evolution.frames.scaled_collisions.SPACING", spacing)
        scale = float(np.exp(-0.5 * spacing))
        scaled = replace(scene, restitution=ScaledRestitution(scene.restitution, scale))
        exact = collision_operator(scaled, solver)(f)
        Q = InterpolatedCollisions(scene, solver, collisions(operator))(f, scale)
        errors.append(np.max(np.abs(Q - exact)) / np.max(np.abs(exact)))
    orders = np.diff(np.log(errors)) / np.diff(np.log(spacings))
    assert orders[-1] > 3.5 and errors[-1] < 1e-3, (orders, errors)


def test_a_gas_that_outgrows_its_law_ends_with_a_dataset():
    law = gs.Viscoelastic(0.3)
    scene = gs.load_scene("maxwellian2d", restitution=law, exponent=1.0, diffusion=20.0)
    solver = gs.Solver(N=16, R=7.0, N_rho=4, M_cir=4, method="fast")
    ds = gs.simulate(scene, solver, t_final=10.0, dt=0.1, frame="rescaled", progress=False)
    assert ds["status"] == Status.DIVERGED and 1 < ds.sizes["time"] < 101
    assert "must lie between 0 and 1" in ds["status"].attrs["reason"]
