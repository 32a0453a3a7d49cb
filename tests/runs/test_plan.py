"""What runs are told to cost before they start: to an accuracy, and several that share a tensor."""

import json
from dataclasses import replace

import numpy as np
import pytest
from comparison import asymmetric_scene

import granstudy as gs
from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.states import LADDER
from granstudy.collision.choice.cost import Cost, estimate, one_after_the_other
from granstudy.collision.choice.method_costs import FAST
from granstudy.evolution.forecast import expected_beside
from granstudy.evolution.times import TimeSettings
from granstudy.runs.accurate import beginning
from granstudy.runs.computation import Computation
from granstudy.runs.estimates import chosen, estimate_run

ISOTROPIC = gs.load_scene("bkw3d", exponent=1.0, e=0.5, diffusion=0.0)
MOVING = gs.load_scene("maxwellian2d", exponent=0.5, e=0.5, diffusion=0.0, velocity=[1.5, 0.5])
GENERAL = gs.load_scene("two_beams2d", exponent=1.0, e=0.5, diffusion=0.0)


def to_accuracy(scene, accuracy, t_final=2.0):
    return Computation("evolution", scene, gs.Solver(accuracy=accuracy), {"t_final": t_final})


@pytest.mark.parametrize("scene", [ISOTROPIC, MOVING, GENERAL])
def test_a_plan_to_an_accuracy_begins_as_the_run_does(scene):
    forecast = gs.plan(scene, t_final=2.0, accuracy=1e-3)
    ds = gs.simulate(scene, t_final=2.0, accuracy=1e-3, progress=False)
    first = json.loads(ds.attrs["choices"])[0]
    assert (forecast.method, forecast.N, forecast.R) == (first["method"], first["N"], first["R"])
    assert forecast.frame == str(ds["frame"].values)
    assert forecast.accuracy == {"temperature": 1e-3, "a2": 1e-2}
    assert "temperature to 0.001, a2 to 0.01" in repr(forecast)
    made = json.loads(ds.attrs["steps"])["evaluations"]
    assert made / 3 < forecast.evaluations < 3 * made
    # a solver that asks for it, and no word at all, mean the same
    assert gs.plan(scene, gs.Solver(accuracy=1e-3), t_final=2.0).describe() == forecast.describe()
    assert gs.plan(scene, t_final=2.0).describe() == forecast.describe()


def test_a_plan_to_an_accuracy_is_of_a_whole_run():
    with pytest.raises(ValueError, match="t_final=None: must be given for an accuracy"):
        gs.plan(ISOTROPIC, accuracy=1e-3)
    with pytest.raises(ValueError, match=r"dt=0.1: not beside accuracy"):
        gs.plan(ISOTROPIC, t_final=1.0, dt=0.1)
    with pytest.raises(ValueError, match="give accuracy or solver, not both"):
        gs.plan(ISOTROPIC, gs.Solver(N=16, R=7.0), t_final=1.0, accuracy=1e-3)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("scene", [ISOTROPIC, MOVING, GENERAL])
def test_a_coarse_look_is_near_what_the_run_begins_with(scene, accuracy):
    guess = beginning(scene, Accuracy.of(accuracy), 0.2)
    plan = gs.plan(scene, t_final=0.2, accuracy=accuracy)
    assert guess.solver.method == plan.method and guess.frame == plan.frame
    assert plan.N / 2 <= guess.solver.N <= 2 * plan.N
    assert plan.R / 1.5 <= guess.solver.R <= 1.5 * plan.R


def test_a_density_without_a_box_is_refused():
    scene = gs.Scene(2, lambda vx, vy: np.ones_like(vx + vy), gs.maxwell(2))
    with pytest.raises(ValueError, match="does not vanish within R=1000; give a solver"):
        estimate_run(to_accuracy(scene, 1e-3))


@pytest.mark.parametrize("scene", [ISOTROPIC, GENERAL])
def test_a_higher_accuracy_is_told_to_take_longer(scene):
    told = [estimate_run(to_accuracy(scene, accuracy)) for accuracy in (1e-2, 1e-4, 1e-6)]
    seconds = [one.cost.seconds for one in told]
    assert seconds == sorted(seconds) and seconds[0] < seconds[-1]
    assert all(one.evaluations == one.cost.evaluations > 0 for one in told)
    assert told[0].choice.solver.N <= told[-1].choice.solver.N


def test_a_state_is_told_with_the_grids_that_it_goes_up(tmp_path, monkeypatch):
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path))
    told = [
        Computation("cooling state", ISOTROPIC, gs.Solver(accuracy=accuracy))
        for accuracy in (1e-2, 1e-5)
    ]
    sizes = [chosen(one).solver.N for one in told]
    assert all(
        (N, R) in LADDER for N, R in [(chosen(o).solver.N, chosen(o).solver.R) for o in told]
    )
    assert sizes[0] < sizes[1]
    kept = [name for name, _ in estimate_run(told[1]).cost.kept]
    assert len(kept) == 1 + [N for N, _ in LADDER].index(sizes[1])
    # tails of Maxwell molecules fall so slowly at e = 0.1 that every grid is tried
    slow = gs.load_scene("maxwellian3d", exponent=0.0, e=0.1, diffusion=0.0)
    assert chosen(replace(told[0], scene=slow)).solver.N == LADDER[-1][0]


def test_a_tensor_is_told_until_it_is_there(tmp_path, monkeypatch):
    monkeypatch.setenv("GRANSTUDY_CACHE", str(tmp_path))
    solver = gs.Solver(N=24, R=8.0, method="radial")
    time = {"t_final": 1.0, "dt": 0.1}
    one, other = (Computation("evolution", ISOTROPIC, solver, time) for _ in range(2))
    heated = replace(one, scene=replace(ISOTROPIC, diffusion=0.1, symmetry=ISOTROPIC.symmetry))
    before = estimate_run(one).cost
    assert before.seconds > before.own_seconds
    first, second = one_after_the_other([before, estimate_run(heated).cost])
    assert first == before.seconds and second < first
    gs.collision_operator(ISOTROPIC, solver)
    after = estimate_run(other).cost
    assert after.kept == () and after.seconds == before.own_seconds


def test_what_is_kept_counts_for_the_first_that_needs_it():
    def cost(*kept):
        return Cost(1.0, 0.5, 4, 300, kept)

    runs = [cost(("a", 10.0)), cost(("a", 10.0), ("b", 5.0)), cost(), cost(("b", 5.0))]
    assert one_after_the_other(runs) == [13.0, 8.0, 3.0, 3.0]


@pytest.mark.parametrize("rtol", [1e-2, 1e-3])
def test_products_are_told_on_the_grid_that_resolves_the_density(rtol):
    scene = asymmetric_scene(2)
    solver = gs.Solver(N=64, R=7.0, rtol=rtol, threads=1).sized()
    planned = gs.collision_operator(scene, solver).plan
    assert planned.n < 64 and planned.n / 1.5 <= FAST.points(scene, solver) <= planned.n
    whole = estimate(FAST, scene, replace(solver, dealias=True), 1)
    assert FAST.points(scene, replace(solver, dealias=True)) == 96 and whole.each > 0.0


def test_what_a_run_does_beside_q_grows_with_its_outputs_and_in_a_rescaled_frame():
    solver = gs.Solver(N=32, R=7.0, N_rho=4, M_cir=8).sized()

    def seconds(**words):
        settings = TimeSettings(1.0, time_rtol=1e-4, **words)
        return expected_beside(GENERAL, solver, settings, 100).seconds

    many = seconds(times=list(np.linspace(0.01, 0.99, 99)))
    assert many > seconds(times=[0.5]) < seconds(times=[0.5], frame="rescaled")
