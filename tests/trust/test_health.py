"""Labels and estimated errors against runs whose errors are known."""

from functools import cache

import numpy as np
import pytest

import granstudy as gs
from granstudy.trust import health
from granstudy.trust.flags import Trust
from granstudy.trust.health import verdict
from granstudy.trust.truth import errors, maxwell_truth

LAWS = {
    "hard spheres": {"kernel": gs.hard_spheres(3), "restitution": 0.2, "diffusion": 0.0},
    "heated": {"kernel": gs.hard_spheres(3), "restitution": 0.5, "diffusion": 0.2},
    "Maxwell": {"kernel": gs.maxwell(3), "restitution": 0.8, "diffusion": 0.0},
    "elastic": {"kernel": gs.hard_spheres(3), "restitution": 1.0, "diffusion": 0.0},
}
TIMES = np.array([0.5, 1.0, 2.0, 3.0])


def run(law, N, R, **settings):
    scene = gs.load_scene("bkw3d", **LAWS[law])
    time = {"time_rtol": 1e-7, "times": TIMES} | settings
    solver = gs.Solver(N=N, R=R, method="radial")
    return gs.simulate(scene, solver, t_final=3.0, progress=False, **time)


@cache
def truth(law):
    return run(law, 48, 12.0, time_rtol=1e-9, frame="rescaled")


CASES = [
    (law, N, R, settings)
    for law in LAWS
    for N, R, settings in [
        (32, 10.0, {"frame": "rescaled"}),
        (18, 7.0, {"frame": "rescaled"}),
        (18, 7.0, {}),
        (12, 7.0, {}),
        (16, 10.0, {}),
        (16, 5.0, {}),
        (24, 8.0, {"time_rtol": None, "times": None, "dt": 0.25}),
        (24, 8.0, {"time_rtol": None, "times": None, "dt": 0.5}),
    ]
]


@pytest.mark.parametrize(("law", "N", "R", "settings"), CASES, ids=str)
def test_labels_and_estimates_are_right(law, N, R, settings):
    ds, exact = run(law, N, R, **settings), truth(law)
    trust = Trust(int(ds["trust"]))
    if int(ds["status"]) != 0:
        assert trust is Trust.UNTRUSTED
        return
    T_error, a2_error = (
        float(abs(ds[name][-1] - exact[name][-1])) for name in ("temperature", "a2")
    )
    T_error /= float(exact["temperature"][-1])
    if trust is Trust.TRUSTED:
        assert T_error < 1e-2 and a2_error < 1e-2
    if trust is Trust.UNTRUSTED:
        assert T_error > 1e-6 or a2_error > 1e-6
    # the estimates are of the errors' size, and not under them by much
    T_estimate, a2_estimate = (
        float(ds[f"{name}_error_estimate"][-1]) for name in ("temperature", "a2")
    )
    assert T_error < 3 * T_estimate + 1e-6
    # beyond an error of 1 the gas is lost, and the estimate says 1
    assert min(a2_error, 1.0) < 3 * a2_estimate + 1e-5


def power_law(N, R):
    scene = gs.load_scene("power_law3d", tail=10.0, restitution=0.8, diffusion=0.0)
    solver = gs.Solver(N=N, R=R, method="radial")
    return gs.simulate(scene, solver, t_final=2.0, time_rtol=1e-7, times=[1.0], progress=False)


@pytest.mark.parametrize(("N", "R"), [(32, 10.0), (48, 20.0)])
def test_what_the_grid_leaves_out_of_the_initial_density_is_estimated(N, R):
    ds = power_law(N, R)
    scene = gs.load_scene("power_law3d", tail=10.0, restitution=0.8, diffusion=0.0)
    exact = maxwell_truth(scene, ds["time"].values)
    T_error, a2_error = errors(ds, exact)
    assert T_error < 3 * float(ds["temperature_error_estimate"].max())
    assert a2_error < 3 * float(ds["a2_error_estimate"].max())
    # the tail is small at the border, so that nothing else shows what lies beyond it
    assert float(ds["edge"].max()) < 1e-4
    if R == 10.0:
        assert a2_error > 1e-2
        assert Trust(int(ds["trust"])) is not Trust.TRUSTED
        assert "a2 may be off" in ds["trust"].attrs["reasons"]


def test_a_density_that_states_nothing_is_compared_with_a_finer_grid():
    named = gs.load_scene("bkw3d", **LAWS["Maxwell"])

    def density(*v):
        return named.initial(*v)

    plain = gs.Scene(3, density, named.kernel, 0.8)
    solver = gs.Solver(N=8, R=7.0, method="radial")
    first = [
        float(gs.simulate(scene, solver, t_final=0.1, dt=0.1, progress=False)[name][0])
        for scene in (named, plain)
        for name in ("temperature_error_estimate", "temperature")
    ]
    assert first[0] == pytest.approx(abs(first[1] - 1.0)) and first[0] > 1e-3
    assert first[2] == pytest.approx(first[0], rel=1e-9)


def test_every_label_is_given():
    found = {Trust(int(run(law, N, R, **settings)["trust"])) for law, N, R, settings in CASES[:8]}
    assert found == set(Trust)


def test_a_verdict_names_what_is_wrong_and_the_remedy():
    well = {"mass_drift": 0.0, "a2": 1e-4}
    assert verdict([well, well], "") == (Trust.TRUSTED, [])
    trust, reasons = verdict([well, well | {"mass_drift": 5e-3}, well], "")
    assert trust is Trust.MARGINAL
    assert reasons == [
        "mass has drifted by 5.0e-03 of its start: take more directions or variant 'full'"
    ]
    assert verdict([well | {"a2": np.nan}], "")[0] is Trust.UNTRUSTED
    assert verdict([well], "step 3: stopped") == (Trust.UNTRUSTED, ["step 3: stopped"])
    assert verdict([], "step 0: stopped")[0] is Trust.UNTRUSTED


def test_what_is_recorded_of_a_resolved_run_is_small():
    ds = run("hard spheres", 32, 10.0, frame="rescaled")
    assert Trust(int(ds["trust"])) is Trust.TRUSTED and ds["trust"].attrs["reasons"] == ""
    for name in ("mass_drift", "momentum_drift", "edge"):
        assert float(ds[name].max()) < 1e-6
    assert set(ds["trust"].attrs["flag_meanings"].split()) == {t.name.lower() for t in Trust}


@pytest.mark.parametrize("grid", [gs.VelocityGrid(2, 16, 6.0), gs.RadialGrid(2, 16, 6.0)], ids=str)
def test_the_spectral_tail_is_the_part_of_the_square(grid):
    if isinstance(grid, gs.VelocityGrid):
        x = np.pi * np.arange(16) / 8
        low, high = np.cos(3 * x), np.cos(7 * x)
        f = (low + 0.5 * high)[:, None] + np.zeros((16, 16))
        assert grid.spectral_tail(f) == pytest.approx(0.25 / 1.25)
    else:
        modes = grid.mode_values(grid.nodes)
        norms = grid.weights @ modes**2
        f = modes[:, 2] + 0.5 * modes[:, 14]
        part = 0.25 * norms[14] / (norms[2] + 0.25 * norms[14])
        assert grid.spectral_tail(f) == pytest.approx(part)


def test_a_temperature_below_zero_names_the_remedy():
    values = {"density": 1.0, "temperature": -0.1}
    assert "frame='rescaled'" in health.failure(values)


@pytest.mark.parametrize(("least", "sign"), [(-0.2, 0.1), (0.0, 0.0), (0.4, 0.0)])
def test_how_far_a_density_is_negative_is_a_part_of_its_largest_value(least, sign):
    grid = gs.VelocityGrid(2, 8, 6.0)
    f = np.full(grid.shape, 2.0)
    f[3, 4] = least
    moments = {"velocity": np.zeros(2), "temperature": 1.0, "density": 1.0, "minimum": least}
    assert health.state_of_health(f, moments, moments, grid)["negative"] == pytest.approx(sign)


def test_a_run_of_one_output_has_all_variables():
    output = dict.fromkeys(health.SIGNS, 1e-09)
    one, two = (health.health_variables([output] * count, "") for count in (1, 2))
    assert one.keys() == two.keys() and "trust" in one and "edge" in one
