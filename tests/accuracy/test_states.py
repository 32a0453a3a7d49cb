"""States to an accuracy, against finer ones and exact laws; their tails."""

import json

import numpy as np
import pytest

import granstudy as gs
from granstudy import theory
from granstudy.accuracy.states import find, ladder, tails
from granstudy.trust.flags import Trust


def gas(exponent, e, diffusion=0.0):
    kernel = gs.VHS(exponent, gs.hard_spheres(3).strength)  # |S| C = 1
    return gs.Scene(3, "maxwellian3d", kernel, restitution=e, diffusion=diffusion)


@pytest.mark.parametrize("asked", [1e-3, 1e-5])
@pytest.mark.parametrize("heated", [False, True])
def test_a_state_keeps_its_word(heated, asked):
    scene = gas(1.0, 0.5, 0.1 if heated else 0.0)
    solve = gs.heated_state if heated else gs.cooling_state
    fine = solve(scene, gs.Solver(N=48, R=14.0, method="radial"), progress=False)
    ds = solve(scene, accuracy=asked, progress=False)
    for name, most in (("a2", 10 * asked), ("cooling_coefficient", asked)):
        off = abs(float(ds[name]) - float(fine[name]))
        assert off <= most
        assert off <= float(ds[f"{name}_error"]) <= most
    assert "needed" not in ds.attrs
    assert ds["trust"].item() == Trust.TRUSTED
    assert json.loads(ds.attrs["asked"]) == {"temperature": asked, "a2": pytest.approx(10 * asked)}


def test_states_of_maxwell_molecules_are_exact():
    """Their a2 is right where no grid comes near; an a3 that is infinite is none."""
    ds = gs.cooling_state(gas(0.0, 0.2), accuracy=1e-5, progress=False)
    exact = theory.maxwell_cooling_moments(3, 0.2, 3)
    assert float(ds["a2"]) == pytest.approx(exact[2] - 1.0, rel=1e-13)
    assert np.isinf(exact[3]) and np.isnan(ds["a3"])
    assert float(ds["cooling_coefficient"]) == pytest.approx((1 - 0.2**2) / 4, rel=1e-13)
    assert ds["trust"].item() == Trust.TRUSTED
    assert abs(json.loads(ds.attrs["choices"])[-1]["a2"] - float(ds["a2"])) > 1e-2
    assert float(ds["tail_rate"]) == pytest.approx(3 + theory.maxwell_tail_exponent(0.2, 3))


def test_heated_maxwell_molecules_have_their_exact_temperature():
    scene = gas(0.0, 0.5, 0.1)
    ds = gs.heated_state(scene, accuracy=1e-3, progress=False)
    assert float(ds["temperature"]) == pytest.approx(
        theory.heated_temperature(scene.kernel, 0.5, 3, 0.1), rel=1e-13
    )
    assert float(ds["a2"]) == pytest.approx(theory.maxwell_heated_moments(2, 0.5, 3)[2] - 1)


def test_an_accuracy_that_is_missed_is_said(monkeypatch):
    monkeypatch.setattr(find, "LADDER", ((16, 8.0), (20, 10.0), (24, 12.0)))
    ds = gs.cooling_state(gas(0.1, 0.2), accuracy=1e-5, progress=False)
    assert "asked to 1.0e-05 and reached to" in ds.attrs["needed"]
    assert "a larger R gains little" in ds["trust"].attrs["reasons"]
    assert ds["trust"].item() == Trust.UNTRUSTED
    assert float(ds["a2_error"]) > 1e-4


@pytest.mark.parametrize("heated", [False, True])
def test_the_tail_is_seen_as_far_as_grids_agree(heated):
    """On a finer grid the slope is the same, within its error; A follows from K alone."""
    scene = gas(0.5, 0.0, 0.1 if heated else 0.0)
    solve = gs.heated_state if heated else gs.cooling_state
    ds = solve(scene, accuracy=1e-5, progress=False)
    fine = solve(scene, gs.Solver(N=96, R=26.0, method="radial"), progress=False)
    power, c = 1.25 if heated else 0.5, float(ds["far_speed"])
    assert c >= 4.0
    grid = gs.RadialGrid(3, 96, 26.0)
    ends = np.array([c - tails.HALF_WIDTH, c + tails.HALF_WIDTH])
    (ln_f, ln_f_beyond), (x, x_beyond) = np.log(grid.evaluate(fine["g"].values, ends)), ends**power
    slope = -(ln_f_beyond - ln_f) / (x_beyond - x)
    assert abs(slope - float(ds["far_slope"])) <= float(ds["far_slope_error"]) < 0.03 * slope
    K = float(ds["cooling_coefficient"])
    A = 2 / 2.5 * np.sqrt(2 / K) if heated else 2 / (0.5 * K)
    assert float(ds["tail_rate"]) == pytest.approx(A, rel=1e-12)


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ([1.0, 1.1], 0.1),
        ([1.0, 1.1, 1.15], 0.05),  # one ratio: the last change
        ([1.0, 1.1, 1.15, 1.175], 0.025),  # a geometric series, of which 0.025 is to come
        ([1.0, 1.1, 1.101], 0.001),
        ([1.0, 1.1, 1.25], np.inf),
        ([1.0, 1.0, 1.1], np.inf),
        # A change that is small by chance counts as the next one; the last then counts as 0.035.
        ([1.0, 1.4, 1.2, 1.2 + 1e-6, 1.15, 1.1375], 0.035 * 0.7**0.5 / (1 - 0.7**0.5)),
        ([1.0, 1.0 + 1e-11, 1.0 + 4e-11], ladder.ROUND_OFF),
    ],
)
def test_errors_by_changes(values, error):
    found = ladder.error_by_changes(np.abs(np.diff(values)))
    assert found == pytest.approx(ladder.SAFETY * error, rel=1e-4)


def test_a_change_that_is_small_by_chance_is_no_small_error():
    error = ladder.error_by_changes([0.1, 0.03, 1e-9])
    least = ladder.EXPECTED * 0.3 * 0.03
    ratio = np.sqrt(least / 0.1)
    assert error == pytest.approx(ladder.SAFETY * least * ratio / (1 - ratio))


def test_the_round_off_of_a_moment_grows_with_the_box():
    """ε max g ∫|c|^{2n} dv over the ball of radius L: nothing at R = 8, 1e-4 in a3 at R = 45."""
    scene = gas(1.0, 0.5)
    small, large = (
        gs.cooling_state(scene, gs.Solver(N=N, R=R, method="radial"), progress=False)
        for N, R in ((24, 8.0), (64, 45.0))
    )
    assert ladder.moment_round_off(small, 3) < 1e-9
    L = 1.3 * 45.0
    expected = ladder.EPSILON * float(large["g"].max()) * 4 * np.pi * L**9 / 9 / (3 * 5 * 7)
    assert ladder.moment_round_off(large, 3) == pytest.approx(expected, rel=0.1)
    ratio = ladder.moment_round_off(large, 3) / ladder.moment_round_off(large, 2)
    assert ratio == pytest.approx(L**2 * 7 / 9 / 7, rel=0.1)
