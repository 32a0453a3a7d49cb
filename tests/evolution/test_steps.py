"""Steps that adapt: errors follow the tolerance, outputs lie inside, noise fades, hopeless runs stop."""

import json

import numpy as np
import pytest

import granstudy as gs
from granstudy.evolution import evolve
from granstudy.evolution.schemes import SCHEMES
from granstudy.evolution.steps.adaptive import AdaptiveSteps
from granstudy.evolution.steps.interpolation import End, hermite, hermite_error
from granstudy.evolution.steps.points import StoppedError
from granstudy.trust.truth import errors, maxwell_truth

SCENE = gs.load_scene("bkw3d", kernel=gs.hard_spheres(3), restitution=0.2, diffusion=0.01)
SOLVER = gs.Solver(N=20, R=7.0, method="radial")


def final(time_rtol, **time):
    ds = gs.simulate(
        SCENE, SOLVER, t_final=2.0, time_rtol=time_rtol, times=[1.0], progress=False, **time
    )
    return float(ds["temperature"][-1]), json.loads(ds.attrs["steps"])


@pytest.mark.parametrize("frame", ["fixed", "rescaled"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_error_follows_the_tolerance(scheme, frame):
    exact, _ = final(1e-11, frame=frame)
    tolerances = np.array([1e-4, 1e-6] if scheme != "dopri54" else [1e-5, 1e-8])
    found = [final(rtol, scheme=scheme, frame=frame) for rtol in tolerances]
    errors = np.array([abs(T / exact - 1.0) for T, _ in found])
    assert np.all(errors < 20 * tolerances), errors
    assert errors[1] < errors[0] / 10
    steps = [counts["accepted"] for _, counts in found]
    order = SCHEMES[scheme].error_order + 1
    assert steps[1] > steps[0]
    assert steps[1] < 4 * steps[0] * (tolerances[0] / tolerances[1]) ** (1 / order)


def test_outputs_are_where_they_are_asked_for_and_change_little():
    times = [0.1, 0.25, 0.7, 1.999]
    ds = gs.simulate(
        SCENE, SOLVER, t_final=2.0, time_rtol=1e-8, times=times, save_every=2, progress=False
    )
    assert ds["time"].values.tolist() == [0.0, *times, 2.0]
    assert ds["snapshot"].values.tolist() == [0.0, 0.25, 1.999, 2.0]
    assert float(ds["temperature"][-1]) == pytest.approx(final(1e-8)[0], rel=1e-7)
    assert "dt" not in ds.coords and float(ds["time_rtol"]) == 1e-8
    counts = json.loads(ds.attrs["steps"])
    assert counts["evaluations"] <= 6 * (counts["accepted"] + counts["rejected"]) + 1


def test_default_outputs_are_ten_a_decade():
    ds = gs.simulate(SCENE, SOLVER, t_final=10.0, time_rtol=1e-4, frame="rescaled", progress=False)
    t = ds["time"].values
    assert t[1] == 0.01 and t[-1] == 10.0 and len(t) == 32
    np.testing.assert_allclose(np.diff(np.log10(t[1:])), 0.1)


class Pole:
    """y' = y² from y = 1: infinite at t = 1."""

    def rate(self, y, taken_off=0.0):
        return y**2

    def relative_size(self, change, state):
        return float(np.max(np.abs(change)) / np.max(np.abs(state)))

    def symmetrise(self, state):
        return state


def test_no_step_is_small_enough_at_a_pole():
    steps = AdaptiveSteps(Pole(), SCHEMES["dopri54"], np.array([0.0, 0.5, 2.0]), 1e-6)
    points = []
    with pytest.raises(StoppedError, match=r"step \d+, t = 1: the step fell to"):
        points.extend(point for point in steps.march(np.ones(1)))
    steps = AdaptiveSteps(Pole(), SCHEMES["dopri54"], np.array([0.0, 0.5]), 1e-8)
    last = list(steps.march(np.ones(1)))[-1]
    assert last.time == 0.5 and last.state[0] == pytest.approx(2.0, rel=1e-6)


def test_rates_are_computed_anew_where_the_equation_changed():
    pole = Pole()
    steps = AdaptiveSteps(pole, SCHEMES["dopri54"], np.array([0.0, 0.5]), 1e-6)
    march = steps.march(np.ones(1))
    next(march), next(march)
    pole.rate = lambda y, taken_off=0.0: np.zeros_like(y)
    steps.equation_changed()
    before = next(march).state
    np.testing.assert_array_equal(next(march).state, before)


def test_three_ends_give_a_state_between_them_to_sixth_order():
    sizes, errors, told = np.array([0.4, 0.2, 0.1]), [], []
    for h in sizes:
        ends = [End(t, np.exp([t]), np.exp([t])) for t in (-1.3 * h, 0.0, h)]
        errors.append(abs(hermite(ends, 0.4 * h)[0] - np.exp(0.4 * h)))
        told.append(hermite_error(ends, 0.4 * h) * h**6)
        for end in ends:
            np.testing.assert_allclose(hermite(ends, end.time), end.state, rtol=1e-14)
    orders = np.diff(np.log(errors)) / np.diff(np.log(sizes))
    assert np.all(np.abs(orders - 6) < 0.2), orders
    np.testing.assert_allclose(told, errors, rtol=0.2)


class Decay(Pole):
    """y' = −y² from y = 1: 1/(1 + t)."""

    def rate(self, y, taken_off=0.0):
        return -(y**2)


@pytest.mark.parametrize("rtol", [1e-3, 1e-5, 1e-7])
def test_outputs_inside_steps_are_as_good_as_the_ends_of_steps(rtol):
    times = np.array([0.0, *np.geomspace(1e-3, 20.0, 60)])
    steps = AdaptiveSteps(Decay(), SCHEMES["dopri54"], times, rtol)
    points = list(steps.march(np.ones(1)))
    assert [point.time for point in points if point.is_output] == times.tolist()
    assert sum(point.inside for point in points) > 30 and not points[-1].inside
    off = {True: [], False: []}
    for point in points[1:]:
        off[point.inside].append(abs(point.state[0] * (1 + point.time) - 1))
    assert max(off[True]) < 2 * max(off[False]) + 0.1 * rtol


def test_the_error_of_a_step_counts_once_however_many_outputs_lie_inside():
    def made(times):
        steps = AdaptiveSteps(Decay(), SCHEMES["dopri54"], np.array(times), 1e-5)
        points = list(steps.march(np.ones(1)))[1:]
        shares = np.zeros(points[-1].step)
        for point in points:
            shares[point.step - 1] += point.share * abs(point.difference[0])
        return shares

    np.testing.assert_allclose(
        made([0.0, *np.linspace(0.1, 5.0, 40)]), made([0.0, 5.0]), rtol=1e-12
    )


def counted(monkeypatch, scene, solver, **words):
    """A run, and the evaluations of Q that it made."""
    made, collisions = [], evolve.collisions

    def counting(operator):
        Q = collisions(operator)
        return lambda state: made.append(1) or Q(state)

    monkeypatch.setattr(evolve, "collisions", counting)
    ds = gs.simulate(scene, solver, progress=False, **words)
    monkeypatch.undo()
    return ds, len(made)


def test_outputs_take_no_evaluation(monkeypatch):
    """217 evaluations in all, where 31 outputs cut the steps and had balances of their own."""
    scene = gs.load_scene("bkw3d", kernel=gs.hard_spheres(3), restitution=0.5)
    solver = gs.Solver(N=40, R=7.0, method="radial")
    few = {"t_final": 5.0, "time_rtol": 1e-3, "times": []}
    alone, least = counted(monkeypatch, scene, solver, **few)
    ds, count = counted(monkeypatch, scene, solver, **few | {"times": None})
    assert count == least == json.loads(ds.attrs["steps"])["evaluations"] <= 80
    assert float(ds["temperature"][-1]) == float(alone["temperature"][-1])
    exact = gs.simulate(scene, solver, t_final=5.0, time_rtol=1e-10, progress=False)
    assert np.max(np.abs(ds["temperature"] / exact["temperature"] - 1)) < 2e-6
    assert np.max(np.abs(ds["a2"] - exact["a2"])) < 3e-5
    _, count = counted(monkeypatch, scene, solver, t_final=5.0, time_rtol=1e-2)
    assert count <= 60


@pytest.mark.parametrize(("time_rtol", "most"), [(1e-2, 44), (1e-4, 70)])
def test_elastic_maxwell_molecules_follow_their_law_inside_steps(time_rtol, most):
    scene = gs.load_scene("bkw3d", restitution=1.0)
    solver = gs.Solver(N=32, R=9.0, method="radial")
    ds = gs.simulate(scene, solver, t_final=10.0, time_rtol=time_rtol, progress=False)
    assert json.loads(ds.attrs["steps"])["evaluations"] <= most
    assert ds.sizes["time"] == 32
    off = errors(ds, maxwell_truth(scene, ds["time"].values))
    assert off.temperature < 1e-10 and off.a2 < 1e-3 * time_rtol + 1e-7


@pytest.mark.parametrize("time_rtol", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize(
    ("frame", "t_final", "words"),
    [
        ("fixed", 3.0, {"restitution": 0.5}),
        ("rescaled", 30.0, {"restitution": 0.5}),
        ("rescaled", 10.0, {"restitution": 0.5, "diffusion": 0.05}),
    ],
)
def test_errors_at_outputs_inside_steps_are_within_their_estimates(
    frame, t_final, words, time_rtol
):
    scene = gs.load_scene("bkw3d", kernel=gs.hard_spheres(3), **words)
    solver = gs.Solver(N=44, R=9.0, method="radial")
    exact, ds = (
        gs.simulate(scene, solver, t_final=t_final, time_rtol=rtol, frame=frame, progress=False)
        for rtol in (1e-10, time_rtol)
    )
    off = {
        "temperature": np.abs(ds["temperature"] / exact["temperature"] - 1),
        "a2": np.abs(ds["a2"] - exact["a2"]),
    }
    for name, error in off.items():
        assert np.all(error < 3 * ds[f"{name}_error_estimate"] + 1e-7), name
        assert np.max(error) < 0.3 * time_rtol


def test_noise_of_a_rescaled_frame_fades_between_long_steps():
    """Steps that only their error limits leave noise at the tolerance: a2 was off by 2.6e-3."""
    scene = gs.load_scene("maxwellian3d", kernel=gs.hard_spheres(3), restitution=0.5)
    solver = gs.Solver(N=40, R=9.0, method="radial")
    exact, ds = (
        gs.simulate(scene, solver, t_final=100.0, time_rtol=rtol, frame="rescaled", progress=False)
        for rtol in (1e-8, 1e-2)
    )
    assert np.max(np.abs(ds["a2"] - exact["a2"])) < 3e-4
    assert float(ds["temperature_error_estimate"].max()) < 3e-4
    assert json.loads(ds.attrs["steps"])["evaluations"] < 630
