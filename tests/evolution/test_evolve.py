"""Time integration: order, exact laws, what a dataset says of good and bad runs."""

import numpy as np
import pytest
from comparison import assert_order

import granstudy as gs
from granstudy import theory
from granstudy.analysis.tables.fits import fit_order
from granstudy.evolution.frames.fixed import FixedFrame
from granstudy.evolution.schemes import rk3_step
from granstudy.evolution.unknowns import collisions, representation
from granstudy.reading.cooling import fit_haff


def small(**overrides):
    settings = {"N": 32, "R": 7.8, "N_rho": 16, "M_cir": 16} | overrides
    return gs.Solver(**settings)


def test_rk3_has_order_three_on_a_nonlinear_problem():
    steps = 1.0 / np.array([8, 16, 32, 64])
    errors = []
    for dt in steps:
        y = np.array([1.0])
        for _ in range(round(1.0 / dt)):
            y = rk3_step(lambda y: -(y**2), y, dt, -(y**2)).state
        errors.append(abs(y[0] - 0.5))
    assert_order(steps, errors, 3, 1e-6)


@pytest.mark.parametrize("variant", ["full", "separate"])
def test_maxwell_molecules_follow_the_exact_law_at_order_three(variant):
    scene = gs.load_scene("bkw2d", restitution=0.2)
    steps = [0.5, 0.25, 0.125]
    errors = [
        float(
            gs.simulate(
                scene,
                small(N=64, N_rho=30, M_cir=30, variant=variant),
                t_final=2.0,
                dt=dt,
                progress=False,
            )["paper_temperature_error"][-1]
        )
        for dt in steps
    ]
    assert abs(fit_order(steps, errors)[0] - 3.0) < 0.1, errors


def equation(operator, diffusion):
    form = representation(operator, gs.Symmetry.named(2, "full"))
    scene = gs.load_scene("maxwellian2d", restitution=0.5, diffusion=diffusion)
    return FixedFrame(form, collisions(operator), scene)


@pytest.mark.parametrize("method", ["fast", "literal"])
def test_the_laplacian_is_exact_for_both_kinds_of_state(method):
    scene = gs.load_scene("maxwellian2d", temperature=0.8, restitution=0.5)
    solver = gs.Solver(N=48, R=9.0, N_rho=4, M_cir=4, method=method)
    operator = gs.collision_operator(scene, solver)
    f = scene.density(operator.grid)
    still, heated = equation(operator, 0.0), equation(operator, 1.0)
    state = heated.start(f)
    assert np.max(np.abs(heated.density(state) - f)) < 1e-15
    v2 = sum(v**2 for v in operator.grid.velocities())
    laplacian = heated.density(heated.rate(state) - still.rate(state))
    assert np.max(np.abs(laplacian - f * (v2 / 0.8**2 - 2 / 0.8))) < 1e-9


def test_no_diffusion_costs_nothing(monkeypatch):
    operator = gs.collision_operator(gs.load_scene("bkw2d", restitution=0.5), small())
    f = gs.load_scene("bkw2d").density(operator.grid)
    calls = []
    monkeypatch.setattr(gs.VelocityGrid, "laplacian", lambda grid, f: calls.append(1) or 0.0)
    equation(operator, 0.0).rate(f)
    assert not calls
    equation(operator, 1e-6).rate(f)
    assert calls


def test_heating_at_e_1_is_linear_in_time():
    scene = gs.load_scene("maxwellian2d", restitution=1.0, diffusion=0.05)
    ds = gs.simulate(scene, small(R=9.0, M_cir=20), t_final=1.0, dt=0.1, progress=False)
    T = ds["temperature"]
    assert np.max(np.abs(T - (T[0] + 2 * 0.05 * ds["time"]))) < 1e-5


def test_anisotropy_decays_at_the_exact_rate():
    scene = gs.load_scene("double_well2d", restitution=0.4, diffusion=0.0)
    solver = small(N=64, R=8.0, N_rho=24, M_cir=24)
    ds = gs.simulate(scene, solver, t_final=1.0, dt=0.05, progress=False)
    P = ds["pressure"].sel(component="x", component_="y")
    rate = -np.log(float(P[-1] / P[0]))
    assert rate == pytest.approx(theory.maxwell_anisotropy_rate(0.4, 2), rel=1e-4)


def test_the_dataset_holds_moments_parameters_and_densities():
    scene = gs.load_scene("bkw2d", restitution=0.5)
    ds = gs.simulate(scene, small(), t_final=0.5, dt=0.1, save_every=2, progress=False)
    assert ds["density"].sizes == {"time": 6}
    assert ds["f"].dims == ("snapshot", "vx", "vy")
    np.testing.assert_allclose(ds["snapshot"], [0.0, 0.2, 0.4, 0.5])
    assert float(ds["e"]) == 0.5 and int(ds["N"]) == 32 and str(ds["method"].values) == "fast"
    assert int(ds["status"]) == 0 and ds["status"].attrs["warnings"] == ""
    for name, variable in ds.data_vars.items():
        assert variable.attrs["long_name"], name
        if name not in ("status", "trust"):
            assert variable.attrs["units"] == "1"
    last = gs.moments(ds["f"].values[-1], gs.VelocityGrid(2, 32, 7.8))
    assert float(last["temperature"]) == float(ds["temperature"][-1])


@pytest.mark.parametrize("method", ["fast", "literal"])
def test_a_run_that_blows_up_keeps_what_it_had_and_says_why(method):
    scene = gs.load_scene("bkw2d", restitution=0.5, diffusion=5.0)
    solver = small(N=16, N_rho=4, M_cir=4, method=method)
    ds = gs.simulate(scene, solver, t_final=500.0, dt=1.0, progress=False)
    assert int(ds["status"]) == 2
    assert "smaller dt" in ds["status"].attrs["reason"] or "fell to" in ds["status"].attrs["reason"]
    assert 1 <= ds.sizes["time"] < 501
    assert np.all(np.isfinite(ds["temperature"]))


@pytest.mark.parametrize(
    ("scene", "solver", "warning"),
    [
        (("double_well3d", {}), {"N": 16, "R": 7.0, "N_rho": 8, "M_sph": 6}, "mass has drifted"),
        (("maxwellian2d", {"temperature": 0.05}), {"N": 16}, "quarter of the wavenumbers"),
        (("maxwellian2d", {"temperature": 4.0}), {"R": 5.0}, "grid's border"),
    ],
)
def test_what_the_grid_cannot_hold_is_recorded(scene, solver, warning):
    name, overrides = scene
    scene = gs.load_scene(name, restitution=0.2, **overrides)
    ds = gs.simulate(scene, small(**solver), t_final=0.2, dt=0.05, progress=False)
    assert warning in ds["status"].attrs["warnings"]


def test_hard_spheres_cool_by_haffs_law():
    """The paper's Figure 4 on a coarse grid; its digits are checked by the study."""
    scene = gs.load_scene(
        "maxwellian3d",
        temperature=2.0,
        velocity=(0.5, -0.5, 0.0),
        kernel=gs.hard_spheres(3),
        restitution=0.8,
        diffusion=0.0,
    )
    solver = gs.Solver(N=20, R=8.0, N_rho=12, M_sph=12)
    ds = gs.simulate(scene, solver, t_final=2.0, dt=0.1, progress=False)
    C0 = fit_haff(ds["time"].values, ds["temperature"].values).C0
    assert C0 == pytest.approx(0.1906, rel=0.03)


@pytest.mark.fault("B2")
@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
@pytest.mark.parametrize("scheme", ["rk3", "dopri54", "exponential"])
@pytest.mark.parametrize("conserve", [(), ("mass", "energy")])
@pytest.mark.parametrize("dt", [2.0, 10.0])
def test_a_run_that_blows_up_ends_with_a_dataset(frame, scheme, conserve, dt):
    """Overflow, division by zero and singular projections were errors that lost all that was computed."""
    kernel = gs.hard_spheres(2)
    scene = gs.load_scene("bkw2d", kernel=kernel, restitution=0.5, diffusion=0.1)
    solver = gs.Solver(N=16, R=7.0, method="radial")
    ds = gs.simulate(
        scene,
        solver,
        t_final=40.0,
        dt=dt,
        frame=frame,
        scheme=scheme,
        conserve=conserve,
        progress=False,
    )
    if int(ds["status"]) != 0:
        assert ds["status"].attrs["reason"].startswith("step ")
        assert "take a" in ds["status"].attrs["reason"]
    assert ds["time"].values[0] == 0.0 and float(ds["temperature"][0]) == pytest.approx(1.0)
    assert np.all(np.isfinite(ds["temperature"])) and int(ds["trust"]) == 0


@pytest.mark.fault("B2")
def test_a_run_that_blows_up_late_keeps_what_came_before():
    kernel = gs.hard_spheres(2)
    scene = gs.load_scene("bkw2d", kernel=kernel, restitution=0.5, diffusion=0.0)
    solver = gs.Solver(N=16, R=7.0, N_rho=8, M_cir=8)
    ds = gs.simulate(scene, solver, t_final=20.0, dt=0.5, progress=False)
    assert int(ds["status"]) == 2 and ds.sizes["time"] > 10
    assert "t = 11.5" in ds["status"].attrs["reason"]


@pytest.mark.fault("B3")
@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
def test_a_density_without_temperature_ends_with_its_moments(frame):
    def negative(*v):
        c2 = sum(vi**2 for vi in v)
        return np.exp(-c2 / 2) * (2.2 - c2)

    scene = gs.Scene(2, negative, gs.maxwell(2), restitution=0.5)
    ds = gs.simulate(scene, small(N=16), t_final=1.0, dt=0.5, frame=frame, progress=False)
    assert int(ds["status"]) == 2 and ds.sizes["time"] == 1 and int(ds["trust"]) == 0
    assert float(ds["temperature"][0]) == pytest.approx(-9.0, rel=1e-3)
    assert "t = 0: the temperature fell to -9" in ds["status"].attrs["reason"]


@pytest.mark.fault("B4")
def test_round_off_that_grows_within_a_step_does_not_break_the_symmetry():
    """The run died of 'density does not have the symmetry, 1.1e-10 for 1e-10'."""
    kernel = gs.VHS(0.5, gs.hard_spheres(2).strength)
    scene = gs.load_scene(
        "maxwellian2d", temperature=0.3, kernel=kernel, restitution=0.8, diffusion=0.1
    )
    time = {"t_final": 6.0, "progress": False}
    solver = gs.Solver(N=48, R=8.0, N_rho=20, M_cir=16)
    ds = gs.simulate(scene, solver, time_rtol=1e-4, **time)
    truth = gs.simulate(scene, gs.Solver(N=40, R=8.0, method="radial"), time_rtol=1e-8, **time)
    assert int(ds["status"]) == 0
    assert float(ds["temperature"][-1]) == pytest.approx(float(truth["temperature"][-1]), rel=1e-7)
    assert float(ds["a2"][-1]) == pytest.approx(float(truth["a2"][-1]), abs=1e-6)
