"""Particles in a study: runs beside other methods, their cost, what a study refuses."""

import numpy as np
import pytest

import granstudy as gs
from granstudy.analysis.tables.plan import study_forecasts
from granstudy.runs.estimates import estimate_run
from granstudy.runs.execute import execute
from granstudy.runs.run_key import run_key

STUDY = """
title: cooling
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0, restitution: 0.5}
    solver: {method: dsmc, N: 16, R: 7.0, seed: 1}
    time: {t_final: 0.4, dt: 0.1}
    sweep:
      - {particles: [1000, 2000], batches: [10, 20]}
"""


def test_runs_are_written_and_opened_together(load, tmp_path):
    runs = load().runs["cooling"]
    assert next(iter(runs)) == "particles~1000/batches~10"
    assert len({run_key(run.computation) for run in runs.values()}) == 4
    for name, run in runs.items():
        gs.write_dataset(execute(run.computation, threads=1), tmp_path / "runs" / f"{name}.nc")
    runs = gs.unstack_runs(gs.open_runs(tmp_path / "runs"))
    assert dict(runs["temperature"].sizes) == {"particles": 2, "batches": 2, "time": 5}
    error = runs["temperature_standard_error"].isel(time=-1).mean("batches")
    assert 0 < float(error.sel(particles=2000)) < float(error.sel(particles=1000))
    assert gs.final_values(tmp_path / "runs")["method"].values.tolist() == ["dsmc"] * 4


def test_seeds_are_swept(load):
    runs = load("{particles: [1000, 2000], batches: [10, 20]}", "{particles: 1000, seed: [1, 2]}")
    runs = runs.runs["cooling"]
    assert list(runs) == ["particles~1000/seed~1", "particles~1000/seed~2"]
    assert [run.solver.seed for run in runs.values()] == [1, 2]
    assert len({run_key(run.computation) for run in runs.values()}) == 2


def test_collisions_are_counted_before_they_happen(load):
    run = load().run("cooling", "particles~2000/batches~20")
    ds = execute(run.computation, threads=1)
    forecast = dict(study_forecasts(load()))["cooling/particles~2000/batches~20"]
    assert forecast.collisions == pytest.approx(2000 / 2 * float(ds["collisions"][-1]), rel=0.1)
    assert forecast.seconds > 0 and estimate_run(run.computation).cost.seconds > 0
    assert f"{forecast.collisions:.2g} collisions" in repr(forecast)


@pytest.mark.parametrize(
    ("scene", "t_final"),
    [
        (gs.load_scene("bkw2d", restitution=0.3, diffusion=0.0), 5.0),
        (gs.load_scene("bkw3d", kernel=gs.hard_spheres(3), restitution=0.5, diffusion=0.2), 5.0),
        (gs.load_scene("bkw3d", kernel=gs.VHS(0.5, 0.1), restitution=gs.Viscoelastic(0.2)), 20.0),
    ],
)
def test_the_collisions_of_other_gases(scene, t_final):
    solver = gs.Solver(N=16, R=7.0, method="dsmc", particles=4000)
    ds = gs.simulate(scene, solver, t_final=t_final, dt=t_final)
    forecast = gs.plan(scene, solver, t_final=t_final, dt=t_final)
    assert forecast.collisions == pytest.approx(2000 * float(ds["collisions"][-1]), rel=0.15)


def test_an_experiment_has_other_methods_beside_particles(load):
    lines = STUDY[STUDY.index("seed: 1}") :]
    beside = lines.replace("seed: 1}", "seed: 1, particles: 2000}").replace(
        "{particles: [1000, 2000], batches: [10, 20]}", "{method: [radial, dsmc]}"
    )
    runs = load(lines, beside).runs["cooling"]
    assert runs["method~dsmc"].solver.particles == 2000
    assert runs["method~radial"].solver == gs.Solver(N=16, R=7.0, method="radial")


def test_a_plan_needs_times():
    scene = gs.load_scene("bkw2d", restitution=0.3)
    with pytest.raises(ValueError, match="method 'dsmc' has no evaluation of Q; give t_final"):
        gs.plan(scene, gs.Solver(N=16, R=7.0, method="dsmc", particles=4000))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[1000, 2000]", "[1001]", "particles=1001: must be a multiple of batches=10"),
        ("method: dsmc", "method: fast", "only method 'dsmc' takes it"),
        ("dt: 0.1", "dt: 0.3", "t_final=0.4 must be a whole number of steps"),
        (
            "restitution: 0.5",
            "restitution: {viscoelastic: 0.8}",
            "must lie between 0 and 1 for impact speeds up to",
        ),
    ],
)
def test_mistakes(load, old, new, message):
    with pytest.raises(ValueError, match=message):
        load(old, new)


def test_only_evolution_runs(load):
    text = STUDY.replace("run: evolution", "run: benchmark")
    lines = [line for line in text.splitlines() if "time:" not in line]
    with pytest.raises(ValueError, match="method='dsmc': has no collision operator for benchmark"):
        load(text="\n".join(lines))


def dense(vx, vy, rho=1e20):
    return rho * np.exp(-(vx**2 + vy**2) / 2) / (2 * np.pi)


@pytest.mark.fault("C9")
def test_a_gas_so_dense_that_a_run_does_not_end_is_refused_and_planned():
    scene = gs.Scene(2, dense, gs.maxwell(2), 0.5)
    solver = gs.Solver(N=16, R=7.0, method="dsmc", particles=1000, threads=1)
    plan = gs.plan(scene, solver, t_final=1.0, dt=0.1)
    assert plan.collisions > 1e20
    with pytest.raises(ValueError, match=r"particles=1000: the run would take .* collisions"):
        gs.simulate(scene, solver, t_final=1.0, dt=0.1)
    steps = [
        gs.plan(
            gs.load_scene(dense, rho=rho, restitution=0.5),
            gs.Solver(N=16, R=7.0, method="radial"),
            t_final=1.0,
            time_rtol=1e-4,
        ).evaluations
        for rho in (1.0, 1e3)
    ]
    assert steps[1] > 10 * steps[0]  # outputs cost steps too
