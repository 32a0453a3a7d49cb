"""Estimated errors of T and a2 against true ones, where one part of the estimate is all that counts."""

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory
from granstudy.trust.balance_times import balance_times
from granstudy.trust.error_estimate import RELAXATION, Imbalance, balance_of, grown
from granstudy.trust.flags import Trust
from granstudy.trust.truth import errors, truth_of_dataset

FINE = gs.Solver(N=48, R=12.0, method="radial")
RESOLVED = gs.Solver(N=40, R=10.0, method="radial")


def run(scene, solver, t_final, **time):
    return gs.simulate(scene, solver, t_final=t_final, progress=False, **time)


def against(scene, ds, fine=FINE, frame="fixed"):
    """Errors of T and a2 of a run, and their estimates: the largest over time."""
    times = ds["time"].values
    truth = run(scene, fine, times[-1], time_rtol=1e-10, times=times[1:], frame=frame)
    true = errors(ds, truth_of_dataset(truth))
    estimates = [float(ds[f"{name}_error_estimate"].max()) for name in ("temperature", "a2")]
    return list(zip(true, estimates, strict=True))


def assert_estimated(pairs):
    for true, estimate in pairs:
        assert true < 3 * estimate + 1e-6
        assert true < 1e-6 or estimate < 100 * true


@pytest.mark.fault("L1")
@pytest.mark.parametrize(("e", "epsilon", "t"), [(1.0, 0.11, 1.0), (0.5, 0.05, 1.0)])
def test_the_motion_of_the_frame_and_the_diffusion_count(e, epsilon, t):
    scene = gs.load_scene("bkw2d", restitution=e, diffusion=epsilon)
    time = {"time_rtol": 1e-6, "times": [0.1, 0.5], "frame": "rescaled"}
    ds = run(scene, gs.Solver(N=24, R=9.5, method="radial"), t, **time)
    pairs = against(scene, ds)
    assert_estimated(pairs)
    assert pairs[1][0] > 1e-5


@pytest.mark.fault("L2")
@pytest.mark.parametrize("conserve", [(), ("mass", "energy")])
def test_energy_that_is_conserved_does_not_silence_the_estimate_of_T(conserve):
    """Collisions beyond R are missing: T was off by 1e-3, estimated at 7e-8."""
    scene = gs.load_scene("maxwellian3d", kernel=gs.hard_spheres(3), restitution=0.0, diffusion=0.0)
    solver = gs.Solver(N=32, R=5.0, method="radial")
    ds = run(scene, solver, 1.0, time_rtol=1e-7, times=[0.5], conserve=conserve)
    pairs = against(scene, ds)
    assert_estimated(pairs)
    assert pairs[0][0] > 8e-4 and Trust(int(ds["trust"])) is not Trust.TRUSTED


@pytest.mark.parametrize("scheme", ["dopri54", "rk3"])
def test_an_error_that_grows_between_few_outputs_is_followed(scheme):
    """Long steps feed the tail: T was off by 3e-6, estimated at 7e-4 by balances at the outputs alone."""
    scene = gs.load_scene("maxwellian3d", kernel=gs.hard_spheres(3), restitution=0.0, diffusion=0.0)
    solver = gs.Solver(N=40, R=10.49, method="radial")
    time = {"time_rtol": 1e-2, "times": [0.75, 1.5], "frame": "rescaled", "scheme": scheme}
    pairs = against(scene, run(scene, solver, 3.0, **time), frame="rescaled")
    assert_estimated(pairs)
    assert pairs[1][0] > 5e-5


def test_balances_are_about_twenty_however_few_the_outputs():
    few = np.array([0.0, 0.5, 1.0, 3.0])
    assert np.allclose(balance_times(np.array([0.0, 2.0])), np.arange(21) / 10)
    assert len(balance_times(few)) == 4 + 3 * 6 and set(few) < set(balance_times(few))
    for outputs in (21, 41, 46):
        times = np.linspace(0.0, 1.0, outputs)
        assert 21 <= len(balance_times(times)) <= 24
        assert set(balance_times(times)) <= set(times) and balance_times(times)[-1] == 1.0
    assert balance_times(np.array([0.0])).tolist() == [0.0]


@pytest.mark.fault("L3")
def test_a_steady_run_stays_trusted():
    """Errors are forgotten while they grow: the estimate was 1e-4, 8e-4, 8e-3, 8e-2 for T off by 4.5e-5."""
    gas = {"kernel": gs.hard_spheres(3), "restitution": 0.5, "diffusion": 0.2}
    steady = gs.heated_state(
        gs.load_scene("maxwellian3d", **gas), gs.Solver(N=40, R=9.0, method="radial")
    )
    T = float(steady["temperature"])
    scene = gs.load_scene("maxwellian3d", temperature=T, **gas)
    for t_final in (10.0, 1e4):
        ds = run(scene, gs.Solver(N=24, R=7.0, method="radial"), t_final, time_rtol=1e-6)
        error = abs(float(ds["temperature"][-1]) / T - 1.0)
        estimate = float(ds["temperature_error_estimate"].max())
        assert 1e-5 < error < 3 * estimate and estimate < 3e-4
        assert Trust(int(ds["trust"])) is Trust.TRUSTED


@pytest.mark.fault("L5")
@pytest.mark.parametrize("scheme", ["rk3", "dopri54", "exponential"])
@pytest.mark.parametrize(
    "step", [{"dt": 0.5}, {"dt": 0.25}, {"time_rtol": 1e-2}, {"time_rtol": 1e-4}], ids=str
)
def test_the_error_of_the_steps_counts_in_every_scheme(scheme, step):
    scene = gs.load_scene("bkw2d", restitution=0.0, diffusion=0.0)
    times = {} if "dt" in step else {"times": [0.5, 1.0]}
    ds = run(scene, RESOLVED, 2.0, scheme=scheme, **step, **times)
    assert_estimated(against(scene, ds, RESOLVED))


@pytest.mark.fault("L4")
def test_a_large_step_of_high_order_is_not_blamed_for_that_of_low_order():
    """bkw2d, e = 1: the estimate of a2 was 6e-4 for a true 7e-10."""
    scene = gs.load_scene("bkw2d", restitution=1.0, diffusion=0.0)
    ds = run(scene, RESOLVED, 2.0, dt=0.5, scheme="dopri54")
    (_, (true, estimate)) = against(scene, ds, RESOLVED)
    assert true < 1e-8 and estimate < 1e-7


@pytest.mark.parametrize("forgetting", [0.0, 1e-6, 0.7, 300.0])
def test_an_error_grows_and_is_forgotten(forgetting):
    # y' = −r y + a + (b − a) s/h by many small steps
    a, b, h, y = 0.2, 0.5, 2.0, 0.1
    n = 200_000
    for s in (np.arange(n) + 0.5) / n:
        k = a + (b - a) * s
        y = (y * (1 - forgetting * h / (2 * n)) + k * h / n) / (1 + forgetting * h / (2 * n))
    assert grown(0.1, a, b, forgetting, h) == pytest.approx(y, rel=1e-6)


def test_a_law_makes_cooling_depend_on_the_shape_of_maxwell_molecules_too():
    now = Imbalance(temperature=0.0, a2=1e-3, cooling=-0.1, frequency=1.0, shaping=0.0)
    fixed = balance_of(now, 0.0, 0.0, 0.9, 2, 0.0, 0.0)
    law = balance_of(now, 0.0, 0.0, gs.Viscoelastic(0.2), 2, 0.0, 0.0)
    assert fixed.shape == 0.0 and law.shape == pytest.approx(0.1 * 3 / 16)
    assert fixed.cooling == 0.0 and law.cooling == pytest.approx(0.05)
    assert (law.temperature, law.a2, law.forgetting) == (0.0, 1e-3, 0.0)


@pytest.mark.parametrize("exponent", [0.0, 0.5, 1.0])
def test_an_error_of_T_is_forgotten_as_fast_as_its_rate_falls_with_T(exponent):
    """T' = h − c T^{1+λ/2}: an error of ln T decays at −d(T'/T)/d ln T."""
    T, h, c = 1.4, 0.2, 0.3

    def rate(T):
        return h / T - c * T ** (exponent / 2)

    now = Imbalance(0.0, 0.0, cooling=rate(T) - h / T, frequency=1.0, shaping=0.0)
    slope = (rate(T * np.exp(1e-5)) - rate(T * np.exp(-1e-5))) / 2e-5
    assert balance_of(now, 0.0, 0.0, 0.9, 2, exponent, h / T).forgetting == pytest.approx(-slope)


@pytest.mark.parametrize("dim", [2, 3])
def test_an_error_of_a2_is_forgotten_as_the_moments_of_maxwell_molecules_tell(dim):
    """Heating forgets it at its full rate, collisions at a part of theirs (`RELAXATION`)."""
    e, nu, T, rho, t = 0.6, 3.0, 1.2, 1.5, 1e-2

    def true_and_taken(epsilon):
        gas = {"restitution": e, "diffusion": epsilon, "density": rho, "cross_section": nu / rho}
        pressure = rho * T * np.eye(dim)
        one, other = (theory.maxwell_a2([0.0, t], pressure, a2, **gas)[1] for a2 in (0.0, 1.0))
        middle = theory.maxwell_temperature([0.0, t / 2], T, **gas)[1]
        now = Imbalance(0.0, 0.0, cooling=-0.1, frequency=nu, shaping=0.0)
        balance = balance_of(now, 0.0, 0.0, e, dim, 0.0, 2 * epsilon / middle)
        return np.array([-np.log(other - one) / t, balance.relaxing])

    collisions, all_of_it = true_and_taken(0.0), true_and_taken(0.5)
    assert collisions[1] == pytest.approx(RELAXATION * collisions[0], rel=1e-6)
    heating = all_of_it - collisions
    assert heating[1] == pytest.approx(heating[0], rel=1e-4)


@pytest.mark.parametrize("conserve", [(), ("mass", "momentum", "energy")], ids=["none", "all"])
def test_a_dense_gas_in_a_shorter_time_has_the_same_estimates(conserve):
    """The collisions of 2f are twice as many: f(t) and 2f(t/2) are one solution."""

    def estimates(density):
        scene = gs.Scene(
            2,
            lambda vx, vy: density * np.exp(-(vx**2 + vy**2) / 2) / (2 * np.pi),
            gs.hard_spheres(2),
            0.5,
        )
        solver = gs.Solver(N=16, R=7.0, N_rho=6, M_cir=6)
        ds = run(scene, solver, 1.0 / density, dt=0.1 / density, conserve=conserve)
        return [ds[f"{name}_error_estimate"].values for name in ("temperature", "a2")]

    for one, two in zip(estimates(1.0), estimates(2.0), strict=True):
        assert one[-1] > 1e-6
        np.testing.assert_allclose(two, one, rtol=1e-6)
