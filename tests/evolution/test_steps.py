"""Steps that adapt: the error follows the tolerance, outputs are hit, hopeless runs stop."""

import json

import numpy as np
import pytest

import granstudy as gs
from granstudy.evolution.schemes import SCHEMES
from granstudy.evolution.steps.adaptive import AdaptiveSteps
from granstudy.evolution.steps.points import StoppedError

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
