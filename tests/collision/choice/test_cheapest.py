"""The choice for a scene: which method, that its operator is the method's, what a dataset tells of it."""

import json

import numpy as np
import pytest
from comparison import asymmetric_scene

import granstudy as gs
from granstudy.collision.choice.cheapest import WORTH_IT
from granstudy.collision.choice.cost import Cost, on_threads
from granstudy.runs.estimates import estimate_run
from granstudy.runs.execute import execute
from granstudy.runs.run_key import run_key

HARD, MAXWELL = 1.0, 0.0


def isotropic(dim, **overrides):
    return gs.load_scene(f"bkw{dim}d", **overrides)


@pytest.mark.parametrize(
    ("scene", "N", "method"),
    [
        (isotropic(3, restitution=0.5), 32, "radial"),
        (isotropic(2, restitution=1.0), 32, "radial"),
        (isotropic(2, restitution=gs.Viscoelastic(0.2)), 32, "fast"),
        (gs.load_scene("maxwellian3d", velocity=(0.5, 0.0, 0.0), restitution=0.5), 32, "fast"),
        (asymmetric_scene(3, 0, HARD, 1.0), 32, "carleman"),
        (asymmetric_scene(3, 0, HARD, 0.3), 32, "fast"),
        (asymmetric_scene(3, 0, MAXWELL, 0.9), 32, "fast"),
        *((asymmetric_scene(2, 0, MAXWELL, e), 64, "carleman") for e in (1.0, 0.99, 0.95, 0.9)),
        (asymmetric_scene(2, 0, MAXWELL, 0.2), 64, "fast"),
        (asymmetric_scene(2, 0, HARD, 1.0), 64, "carleman"),
        (asymmetric_scene(2, 0, HARD, 0.9), 64, "fast"),
    ],
)
def test_the_method_follows_the_scene(scene, N, method):
    choice = gs.choose(scene, gs.Solver(N=N, R=8.0, method="auto"))
    assert choice.solver.method == method, choice.reason
    assert choice.reason.startswith(method)
    assert choice.solver == gs.choose(scene, gs.Solver(N, 8.0, method="auto", threads=None)).solver


def test_only_fast_keeps_single_precision():
    for scene, precision in (
        (isotropic(3, restitution=0.5), "double"),
        (asymmetric_scene(3, 0, HARD, 1.0), "double"),
        (asymmetric_scene(3, 0, HARD, 0.3), "single"),
    ):
        asked = gs.Solver(N=32, R=8.0, method="auto", precision="single")
        chosen = gs.choose(scene, asked).solver
        assert chosen.precision == precision
        assert (chosen.method == "fast") == (precision == "single")


def test_direct_is_for_grids_so_small_that_it_is_the_cheapest():
    scene = asymmetric_scene(2, 0, HARD, 0.5)
    fine = {"R": 8.0, "M_cir": 96, "method": "auto"}
    assert gs.choose(scene, gs.Solver(N=4, **fine)).solver.method == "direct"
    assert gs.choose(scene, gs.Solver(N=32, **fine)).solver.method == "fast"


def test_carleman_gets_directions_for_the_error_of_fast():
    def chosen(dim, **settings):
        scene = asymmetric_scene(dim, 0, dim - 2.0, 1.0)
        return gs.choose(scene, gs.Solver(N=32, R=8.0, method="auto", **settings)).solver

    assert chosen(3, M_sph=32).M_sph == 70
    assert chosen(3, M_sph=32, variant="full").M_sph == 32
    assert chosen(2, M_cir=30).M_cir == 40
    assert chosen(3, M_sph=192).method == "fast"  # there is no larger design


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        (isotropic(2, restitution=0.5), {"N": 32}),
        (asymmetric_scene(2, 0, MAXWELL, 1.0), {"N": 32}),
        (asymmetric_scene(2, 0, HARD, 0.5), {"N": 8, "M_cir": 96}),
        (asymmetric_scene(2, 0, HARD, 0.5), {"N": 32}),
    ],
)
def test_it_computes_what_the_chosen_method_does(scene, settings):
    solver = gs.Solver(R=7.0, method="auto", threads=1, **settings)
    operator = gs.collision_operator(scene, solver)
    same = gs.collision_operator(scene, gs.choose(scene, solver).solver)
    f = scene.density(operator.grid)
    assert operator.grid == same.grid and type(operator) is type(same)
    assert np.array_equal(operator(f), same(f))


def test_a_tolerance_chooses_the_grid_too():
    scene = gs.load_scene("double_well2d", restitution=0.5)
    box = gs.fit_solver(scene, 1e-2)
    for method in ("auto", "fast"):
        choice = gs.choose(scene, gs.Solver(rtol=1e-2, method=method))
        assert choice.solver == box
        assert f"N={box.N} and R={box.R:g}" in choice.reason
    scene = isotropic(2, restitution=0.5)
    box = gs.fit_solver(scene, 1e-3)
    for method in ("auto", "radial"):
        solver = gs.choose(scene, gs.Solver(rtol=1e-3, method=method)).solver
        assert (solver.method, solver.N, solver.R) == ("radial", -(-box.N * 10 // 17), box.R)
    operator = gs.collision_operator(scene, solver)
    f = scene.density(operator.grid)
    assert gs.moments(f, operator.grid)["temperature"] == pytest.approx(1.0, rel=1e-3)


def test_a_dataset_says_what_was_chosen_and_asked():
    scene = isotropic(2, restitution=0.5)
    time = {"t_final": 0.02, "dt": 0.01}
    ds = gs.simulate(scene, gs.Solver(rtol=1e-2, method="auto"), **time)
    assert ds["method"] == "radial" and ds["rtol"] == 1e-2
    assert json.loads(ds.attrs["solver"])["N"] == int(ds["N"])
    asked = json.loads(ds.attrs["asked_solver"])
    assert (asked["method"], asked["N"], asked["R"]) == ("auto", None, None)
    assert "radial: isotropic" in ds.attrs["choice"]
    plain = gs.simulate(scene, gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4, threads=1), **time)
    assert not {"asked_solver", "choice"} & set(plain.attrs)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({}, "N=None: only with rtol is it chosen; give N, or rtol"),
        ({"N": 8}, "R=None: only with rtol is it chosen; give R, or rtol"),
        ({"N": 8, "rtol": 1e-3}, "N=8, R=None: rtol chooses both; give both or neither"),
        ({"rtol": 1e-3, "method": "carleman"}, "only methods 'auto', 'fast', 'radial' take it"),
        ({"rtol": 1e-3, "method": "auto", "M_sph": 6}, "M_sph=6: rtol=0.001 chooses it"),
        ({"N": 9, "R": 7.0, "method": "auto"}, "N=9: must be an even integer"),
        ({"N": 8, "R": 7.0, "method": "autp"}, "unknown method 'autp' .did you mean 'auto'"),
    ],
)
def test_mistakes(settings, message):
    with pytest.raises(ValueError, match=message):
        gs.Solver(**settings)


STUDY = """
title: auto
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw2d}
    solver: {method: auto}
    time: {t_final: 0.02, dt: 0.01}
    sweep:
      - {e: [0.5, 0.9], rtol: 1.0e-2}
"""


def test_a_study_leaves_the_choice_open(load):
    runs = list(load().runs["cooling"].values())
    assert len({run_key(run.computation) for run in runs}) == 2
    ds = execute(runs[0].computation, threads=1)
    assert ds["status"] == 0 and ds["method"] == "radial"
    assert estimate_run(runs[0].computation).cost.seconds > 0

    text = (
        STUDY.replace("{method: auto}", "{R: 7.0, N: 32, method: auto}")
        .replace(
            "run: evolution\n    scene: {name: bkw2d}",
            "run: collision\n    reference: {method: direct}\n    scene: {name: bkw2d}",
        )
        .replace("    time: {t_final: 0.02, dt: 0.01}\n", "")
    )
    with pytest.raises(ValueError, match="method 'radial': has other velocity nodes than its ref"):
        load(text=text)


def test_another_method_has_to_be_cheaper_by_more_than_the_estimates_are_off(monkeypatch):
    scene = asymmetric_scene(2, 0, HARD, 0.5)
    seconds = {}

    def stated(cost, scene, solver, evaluations):
        return Cost(0.0, seconds[solver.method], evaluations, 1)

    monkeypatch.setattr("granstudy.collision.choice.cheapest.estimate", stated)
    for factor, method in ((0.95, "fast"), (1.05, "direct")):
        seconds.update(fast=1.0, direct=1.0 / (factor * WORTH_IT), carleman=2.0)
        assert gs.choose(scene, gs.Solver(N=32, R=8.0, method="auto")).solver.method == method


def test_threads_share_the_seconds_of_one():
    assert on_threads(6.0, 1.0, 3) == 2.0
    assert on_threads(6.0, 0.0, 3) == on_threads(6.0, 0.5, 1) == 6.0
    assert on_threads(6.0, 0.5, 3) == 3.0
