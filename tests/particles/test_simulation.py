"""Batches: their errors, their reproducibility, what a dataset says of them."""

import json

import numpy as np
import pytest
import xarray as xr

import granstudy as gs
from granstudy.particles import simulate_particles, time_average
from granstudy.theory import maxwell_a2, maxwell_anisotropy_rate
from granstudy.trust.flags import Trust

SCENE = gs.load_scene("double_well2d", restitution=0.3, diffusion=0.0)


def solver(**settings):
    return gs.Solver(**{"N": 16, "R": 8.0, "method": "dsmc", "particles": 2000} | settings)


def test_errors_fall_like_one_over_the_root_of_n():
    times = np.linspace(0.5, 2.0, 4)
    few, many = (
        simulate_particles(SCENE, solver(particles=n, batches=50), times) for n in (5000, 80_000)
    )
    for name in ("temperature", "a2"):
        ratio = few[f"{name}_standard_error"] / many[f"{name}_standard_error"]
        assert float(ratio.mean()) == pytest.approx(4.0, rel=0.25)


def test_errors_are_those_that_repetitions_show():
    # χ² over 25 runs of two moments with exact laws; 19/17 = 1.12 is the variance of Student's t.
    t, e = 1.5, SCENE.restitution
    scores = []
    for seed in range(25):
        ds = simulate_particles(SCENE, solver(seed=seed), [0.0, t])
        rate = maxwell_anisotropy_rate(e, 2, float(ds["density"][0]))
        shear = ds["pressure"][0, 0, 1] * np.exp(-rate * t)
        errors = ds["temperature_standard_error"][-1], ds["pressure_standard_error"][-1, 0, 1]
        distances = ds["temperature"] - ds["temperature_exact"], ds["pressure"][..., 0, 1] - shear
        scores.append([float(d[-1] / s) for d, s in zip(distances, errors, strict=True)])
    squares = np.mean(np.square(scores), axis=0)
    assert np.all((squares > 0.5) & (squares < 2.0)), squares
    assert np.all(np.abs(np.mean(scores, axis=0)) < 4 * np.sqrt(1.12 / 25))


def test_the_same_seed_gives_the_same_bytes_on_any_threads():
    scene = gs.load_scene("bkw2d", restitution=gs.Viscoelastic(0.3), diffusion=0.1)
    one, two, other = (
        gs.simulate(scene, solver(**settings), t_final=0.4, dt=0.2, save_every=1)
        for settings in ({"threads": 1}, {"threads": 2}, {"threads": 1, "seed": 1})
    )
    xr.testing.assert_identical(one, two)
    assert not np.any(one["temperature"][1:] == other["temperature"][1:])


def test_a_dataset():
    ds = gs.simulate(SCENE, solver(seed=3), t_final=0.6, dt=0.2, save_every=2)
    assert ds["status"] == 0 and ds["time"].values == pytest.approx([0.0, 0.2, 0.4, 0.6])
    assert ds["a2_by_batch"].dims == ("time", "batch") and ds.sizes["batch"] == 20
    assert ds["a2_by_batch"].mean("batch").values == pytest.approx(ds["a2"].values)
    assert ds["pressure_standard_error"].dims == ("time", "component", "component_")
    assert {"particles", "batches", "seed", "method", "e", "N", "R", "dt"} <= set(ds.coords)
    assert "variant" not in ds.coords
    assert json.loads(ds.attrs["solver"]) == {
        "N": 16, "R": 8.0, "method": "dsmc", "particles": 2000, "batches": 20, "seed": 3,
    }  # fmt: skip
    # The density counted in cells is the gas, and at t = 0 the initial density within its noise.
    assert ds["f"].dims == ("snapshot", "vx", "vy")
    assert ds["snapshot"].values == pytest.approx([0.0, 0.4, 0.6])
    grid = gs.VelocityGrid(2, 16, 8.0)
    assert ds["f"].sum(("vx", "vy")).values * grid.cell == pytest.approx(
        ds["density"].values[[0, 2, 3]]
    )
    peak = ds["f"][0].argmax(("vx", "vy"))
    exact = SCENE.density(grid)
    assert exact[peak["vx"], peak["vy"]] > 0.9 * exact.max()


@pytest.mark.parametrize(
    ("particles", "batches", "trust", "reason"),
    [
        (200_000, 20, "marginal", "a2 may be off by"),
        (2000, 20, "untrusted", "T has two standard errors of"),
        (800, 40, "untrusted", "a2 has a bias of about 5.0e-02"),
    ],
)
def test_labels_are_by_the_standard_errors(particles, batches, trust, reason):
    ds = simulate_particles(SCENE, solver(particles=particles, batches=batches), [0.0, 1.0])
    estimate = 2 * ds["temperature_standard_error"] / ds["temperature"]
    np.testing.assert_allclose(ds["temperature_error_estimate"], estimate)
    np.testing.assert_allclose(ds["a2_error_estimate"], 2 * ds["a2_standard_error"])
    assert Trust(int(ds["trust"])).name.lower() == trust
    assert reason in ds["trust"].attrs["reasons"]


def test_what_is_labelled_trusted_is_right():
    """T against its exact law to 1%, a2 against the exact moments to 0.01."""
    scene = gs.load_scene("maxwellian3d", restitution=0.6, diffusion=0.0)
    ds = simulate_particles(scene, solver(particles=1_000_000), [0.0, 1.0])
    assert Trust(int(ds["trust"])) is Trust.TRUSTED and ds["trust"].attrs["reasons"] == ""
    assert float(abs(ds["temperature"] / ds["temperature_exact"] - 1.0)[-1]) < 0.01
    (a2,) = maxwell_a2(np.array([1.0]), np.eye(3), 0.0, 0.6)
    assert float(ds["a2"][-1]) == pytest.approx(a2, abs=0.01)


def test_it_is_written_and_read(tmp_path):
    ds = gs.simulate(SCENE, solver(), t_final=0.2, dt=0.1)
    gs.write_dataset(ds, tmp_path / "run.nc")
    xr.testing.assert_equal(gs.read_dataset(tmp_path / "run.nc"), ds)


def test_an_impact_beyond_the_speeds_checked_ends_the_run():
    scene = gs.load_scene(
        "maxwellian2d", temperature=0.1, restitution=lambda v: 1 - v / 20, diffusion=1000.0
    )
    ds = simulate_particles(scene, solver(R=4.0), [0.0, 0.01, 5.0])
    assert ds["status"] == 2 and ds.sizes["time"] == 2
    assert Trust(int(ds["trust"])) is Trust.UNTRUSTED
    assert ds["trust"].attrs["reasons"].startswith(ds["status"].attrs["reason"])
    assert "is beyond 4R = 16" in ds["status"].attrs["reason"]
    assert ds["status"].attrs["reason"].startswith("t = 5: ")


@pytest.mark.parametrize("overrides", [{"R": 4.0}, {"R": 4.0, "batches": 2, "particles": 20}])
def test_a_run_that_ends_before_its_first_time_is_an_error(overrides):
    scene = gs.load_scene(
        "maxwellian2d", temperature=0.1, restitution=lambda v: 1 - v / 20, diffusion=1000.0
    )
    with pytest.raises(ValueError, match=r"t = 5: .*beyond 4R = 16.*nothing was recorded before"):
        simulate_particles(scene, solver(**overrides), [5.0])


def test_a_gas_at_rest_ends_the_run():
    scene = gs.load_scene("bkw2d", restitution=0.0, diffusion=0.0)
    ds = simulate_particles(scene, solver(particles=200), [0.0, 500.0, 6000.0])
    assert ds["temperature"][-1] < 1e-50
    assert ds["status"] == 2 and ds.sizes["time"] == 2
    assert (
        ds["status"].attrs["reason"]
        == "t = 6000: the temperature fell below 1e-150: the gas is at rest"
    )


def test_averages_over_time():
    ds = simulate_particles(SCENE, solver(), np.linspace(0.0, 1.0, 11))
    mean, error = time_average(ds, "a2", 0.5)
    late = ds["a2_by_batch"].sel(time=slice(0.5, None)).mean("time")
    assert mean == pytest.approx(float(late.mean()))
    assert error == pytest.approx(float(late.std(ddof=1)) / np.sqrt(20))
    with pytest.raises(ValueError, match="unknown moment by batch 'energy': allowed are a2, temp"):
        time_average(ds, "energy", 0.5)
    with pytest.raises(ValueError, match="start=2.0: the dataset ends at t = 1"):
        time_average(ds, "a2", 2.0)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"particles": None}, "particles=None: must be a positive integer"),
        ({"particles": 2010}, "particles=2010: must be a multiple of batches=20, at least 200"),
        ({"particles": 100}, "particles=100: must be a multiple of batches=20, at least 200"),
        ({"batches": 1}, "batches=1: must be at least 2, for standard errors"),
        ({"seed": -1}, "seed=-1: must be an integer of at least 0"),
        ({"seed": 0.5}, "seed=0.5: must be an integer of at least 0"),
        ({"method": "fast"}, "particles=2000: only method 'dsmc' takes it, not 'fast'"),
        ({"method": "fast", "particles": None, "seed": 1}, "seed=1: only method 'dsmc' takes it"),
        ({"rtol": 1e-3}, "rtol=0.001: only methods 'auto', 'fast', 'radial' take it, not 'dsmc'"),
        ({"method": "dmsc"}, "unknown method 'dmsc' .did you mean 'dsmc'"),
    ],
)
def test_mistakes(settings, message):
    with pytest.raises(ValueError, match=message):
        solver(**settings)


@pytest.mark.parametrize("times", [[], [0.0, 0.0], [1.0, 0.5], [-1.0], [np.inf], [[0.0]]])
def test_mistaken_times(times):
    with pytest.raises(ValueError, match="must be increasing finite numbers of at least 0"):
        simulate_particles(SCENE, solver(), times)


def test_there_is_no_operator():
    with pytest.raises(ValueError, match="method='dsmc': particles have no collision operator"):
        gs.collision_operator(SCENE, solver())
    with pytest.raises(ValueError, match="method='fast': simulate_particles needs method 'dsmc'"):
        simulate_particles(SCENE, gs.Solver(N=16, R=8.0), [1.0])


@pytest.mark.fault("A8")
@pytest.mark.parametrize(
    ("R", "overrides", "cut"),
    [(2.0, {}, 0.131), (3.0, {}, 0.023), (4.0, {"velocity": (2.0, 0.0)}, 0.025), (8.0, {}, 0.0)],
)
def test_a_density_that_the_box_cuts_is_not_trusted(R, overrides, cut):
    scene = gs.load_scene("maxwellian2d", restitution=0.9, **overrides)
    solver = gs.Solver(N=16, R=R, method="dsmc", particles=400_000, batches=4, seed=1)
    ds = gs.simulate(scene, solver, t_final=0.1, dt=0.1, progress=False)
    estimate = float(ds["a2_error_estimate"][0])
    assert abs(float(ds["a2"][0])) < estimate < cut + 0.02
    assert (
        (int(ds["trust"]) == 2)
        == (cut < 4e-3)
        == ("the box cuts" not in ds["trust"].attrs["reasons"])
    )
