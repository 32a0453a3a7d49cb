"""What may be spent: errors that grow as allowed stay within what was asked."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.budget import (
    GRID_SHARE,
    STEP_SHARE,
    allowed_growth,
    clock_left,
    temperature_range,
)
from granstudy.accuracy.ledger import Ledger
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import Balance

NONE = Change(0.0, 0.0)


def balance(temperature=0.0, a2=0.0, other=0.0, **rates):
    known = {"shape": 0.1, "cooling": 0.2, "forgetting": 0.2, "relaxing": 0.5} | rates
    return Balance(temperature, a2, other, **known)


@pytest.mark.parametrize("forgetting", [0.0, 0.2, 3.0])
@pytest.mark.parametrize("left", [0.5, 20.0])
def test_errors_that_grow_as_allowed_stay_within_the_budget(forgetting, left):
    asked = Accuracy(1e-4, 1e-3)
    rates = {"forgetting": forgetting, "cooling": forgetting, "shape": forgetting / 2}
    allowed = allowed_growth(asked, balance(**rates), NONE, left)
    other = 0.0 if np.isinf(allowed.other) else allowed.other
    spends = balance(allowed.temperature, allowed.a2, other, **rates)
    assert allowed.ratio(spends) == pytest.approx(1.0)
    ledger = Ledger()
    ledger.restart(spends, NONE)
    for clock in np.linspace(0.0, left, 400)[1:]:
        ledger.step(clock, NONE)
        ledger.weigh(spends)
    error = ledger.total()
    assert error.a2 <= 1.01 * GRID_SHARE * asked.a2
    assert error.temperature <= asked.temperature


def test_steps_have_a_share_of_their_own():
    asked = Accuracy(1e-4, 1e-3)
    now = balance(shape=0.0)
    allowed = allowed_growth(asked, now, NONE, 50.0)
    ledger = Ledger()
    ledger.restart(now, NONE)
    for clock in np.linspace(0.0, 50.0, 1000)[1:]:
        made = 0.5 * 50.0 / 999  # the ledger counts the errors of steps twice
        ledger.step(clock, Change(made * allowed.step_temperature, made * allowed.step_a2))
        ledger.weigh(now)
    steps = ledger.estimates()["steps"]
    assert steps.temperature <= 1.05 * STEP_SHARE * asked.temperature
    assert steps.a2 <= 1.05 * STEP_SHARE * asked.a2


@pytest.mark.parametrize("exponent", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(("cooling", "heating"), [(0.3, 0.0), (0.0, 0.4), (0.3, 0.6)])
def test_collisions_left_follow_the_law_of_the_temperature(exponent, cooling, heating):
    def law(t, y):
        x = y[0]
        return [-cooling * x ** (1 + exponent / 2) + heating, x ** (exponent / 2)]

    end = solve_ivp(law, (0.0, 30.0), [1.0, 0.0], rtol=1e-9).y[:, -1]
    assert clock_left(cooling, heating, exponent, 30.0) == pytest.approx(end[1], rel=0.03)
    assert temperature_range(cooling, heating, exponent, 30.0) == pytest.approx(
        max(end[0], 1.0 / end[0]), rel=0.15
    )


def test_an_accuracy_is_a_number_or_names_what_it_is_of():
    assert Accuracy.of() == Accuracy(1e-3, 1e-2)
    assert Accuracy.of(1e-5) == Accuracy(1e-5, 1e-4)
    assert Accuracy.of({"a2": 1e-4}) == Accuracy(1e-5, 1e-4)
    assert Accuracy.of({"temperature": 1e-4, "a2": 1e-2}) == Accuracy(1e-4, 1e-2)


@pytest.mark.parametrize("asked", [0.0, -1e-3, 1.0, 1e-12, "fine", {"T": 1e-3}, {}, True])
def test_other_accuracies_are_refused(asked):
    with pytest.raises(ValueError, match="accuracy"):
        Accuracy.of(asked)
