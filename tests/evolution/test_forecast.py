"""Forecasts of runs, against the operators that the runs get."""

import json

import pytest
from comparison import asymmetric_scene

import granstudy as gs
from granstudy.analysis.tables.plan import write_plan

SMALL = {"N": 12, "R": 5.0, "N_rho": 6, "M_cir": 8, "M_sph": 12, "threads": 1}


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        *(
            (asymmetric_scene(dim), SMALL | {"method": method, "variant": variant})
            for dim in (2, 3)
            for method in ("literal", "fast", "direct")
            for variant in ("full", "separate")
        ),
        (gs.load_scene("bkw3d", restitution=0.5), SMALL | {"method": "fast"}),
        (asymmetric_scene(2), SMALL | {"method": "fast", "dealias": True, "precision": "single"}),
        (gs.load_scene("bkw2d", restitution=0.5), SMALL | {"method": "auto"}),
        *(
            (asymmetric_scene(2, 0, 0.0, e), SMALL | {"method": "carleman", "M_cir": M})
            for e, M in ((1.0, 8), (1.0, 10), (0.9, 8))
        ),
        (asymmetric_scene(3, 0, 1.0, 1.0), SMALL | {"method": "auto"}),
        (asymmetric_scene(2), {"N": 24, "R": 6.0, "rtol": 1e-2, "threads": 1}),
        (asymmetric_scene(2), {"rtol": 1e-2, "threads": 1, "method": "auto"}),
    ],
)
def test_its_counts_are_the_operators(scene, settings):
    solver = gs.Solver(**settings)
    forecast = gs.plan(scene, solver)
    operator = gs.collision_operator(scene, solver)
    assert forecast.transforms == operator.transforms
    assert forecast.N == operator.grid.N
    if forecast.plan is None:
        assert forecast.error is None and "not estimated" in repr(forecast)
    else:
        assert forecast.nodes == operator.plan.nodes and forecast.error <= solver.rtol
    assert forecast.seconds >= forecast.seconds_per_evaluation > 0
    assert forecast.describe()["method"] == forecast.method
    assert forecast.method in repr(forecast)


def test_a_run_takes_three_evaluations_a_step_and_less_on_two_threads():
    scene = asymmetric_scene(2)
    solver = {key: value for key, value in SMALL.items() if key != "threads"}
    one, two = (
        gs.plan(scene, gs.Solver(**solver, threads=threads), t_final=1.0, dt=0.1)
        for threads in (1, 2)
    )
    assert one.evaluations == 30
    assert one.seconds_per_evaluation / 2 <= two.seconds_per_evaluation < one.seconds_per_evaluation
    assert two.seconds < one.seconds


def test_times_come_together():
    scene, solver = asymmetric_scene(2), gs.Solver(**SMALL)
    with pytest.raises(ValueError, match="t_final=1.0, dt=None: give both, or neither"):
        gs.plan(scene, solver, t_final=1.0)
    with pytest.raises(ValueError, match="must be a whole number of steps"):
        gs.plan(scene, solver, t_final=1.0, dt=0.3)


STUDY = """
title: tiny
experiments:
  errors:
    title: errors
    run: collision
    scene: {name: double_well2d, restitution: 0.5}
    solver: {R: 8.0, N: 12, N_rho: 6}
    reference: {method: direct}
    sweep:
      - {M_cir: [6, 8], method: auto}
"""


def test_the_plan_of_a_study(load, tmp_path):
    write_plan(load(), tmp_path / "plan.md", tmp_path / "plan.csv")
    text = (tmp_path / "plan.md").read_text()
    assert text.startswith("# Plan: tiny\n")
    assert "| errors/M_cir~6/method~auto |" in text and "| **total** " in text
    lines = (tmp_path / "plan.csv").read_text().splitlines()
    assert lines[0].startswith("run,method,N,R,nodes,transforms,evaluations,seconds,memory_mb")
    assert [line.split(",")[0] for line in lines[1:]] == [
        "errors/M_cir~6/method~auto", "errors/reference", "errors/M_cir~8/method~auto",
    ]  # fmt: skip


@pytest.mark.fault("L6")
@pytest.mark.parametrize(
    ("dim", "exponent", "strength", "e", "epsilon", "time"),
    [
        (3, 0.0, 30.0, 0.5, 0.1, {"t_final": 10.0, "time_rtol": 1e-6}),
        (2, 1.0, 30.0, 0.9, 0.1, {"t_final": 10.0, "time_rtol": 1e-4}),
        (3, 1.0, 1.0, 0.5, 0.0, {"t_final": 100.0, "time_rtol": 1e-6, "frame": "rescaled"}),
        (2, 0.0, 1.0, 0.5, 0.3, {"t_final": 20.0, "time_rtol": 1e-5, "scheme": "rk3"}),
        (3, 1.0, 1.0, 0.5, 0.2, {"t_final": 5.0, "time_rtol": 1e-7, "scheme": "exponential"}),
    ],
)
def test_adaptive_steps_are_within_a_factor_3(dim, exponent, strength, e, epsilon, time):
    """|S|C = 30 with ε = 0.1 made 5005 steps where 952 were planned."""
    kernel = gs.VHS(exponent, strength * gs.hard_spheres(dim).strength)
    scene = gs.load_scene(f"bkw{dim}d", kernel=kernel, restitution=e, diffusion=epsilon)
    solver = gs.Solver(N=24, R=8.0, method="radial")
    forecast = gs.plan(scene, solver, **time)
    ds = gs.simulate(scene, solver, progress=False, **time)
    assert int(ds["status"]) == 0
    made = json.loads(ds.attrs["steps"])["evaluations"]
    assert made / 3 < forecast.evaluations < 3 * made


@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
def test_a_gas_that_cools_below_every_number_has_a_forecast(frame):
    scene = gs.load_scene("maxwellian3d", e=0.5, exponent=0.0, diffusion=0.0)
    solver = gs.Solver(N=16, R=9.0, method="radial", threads=1)
    settings = {"time_rtol": 1e-6, "frame": frame}
    short, long = (gs.plan(scene, solver, t_final=t, **settings).evaluations for t in (1e4, 1e6))
    assert 50 < long / short < 200
