"""Newton's method: quadratic where steps are exact, and plain about not having got there."""

import numpy as np

from granstudy.states import newton as module
from granstudy.states.newton import newton


class Circle:
    """x² + y² = 2, x = y, and more unknowns that follow: n equations."""

    def __init__(self, n, slope=1.0):
        self.n = n
        self.slope = slope

    def residual(self, x):
        return np.concatenate([[x[0] ** 2 + x[1] ** 2 - 2.0], x[1:] - x[:-1]])

    def derivative(self, x):
        def act(h):
            first = 2 * (x[0] * h[0] + x[1] * h[1])
            return np.concatenate([[self.slope * first], h[1:] - h[:-1]])

        return act

    def size(self, residual, x):
        return float(np.max(np.abs(residual)))


def test_dense_steps_are_quadratic():
    found = newton(Circle(6), np.full(6, 3.0), 1e-13, 10)
    assert found.reason == ""
    np.testing.assert_allclose(found.x, 1.0, rtol=1e-12)
    sizes = np.array(found.sizes)
    late = sizes[(sizes < 0.5) & (sizes > 1e-12)]
    # x ↦ (x² + 1)/2x leaves half the square of the error, of which the residual is 4 times
    assert np.all(late[1:] <= 0.2 * late[:-1] ** 2)


def test_both_kinds_of_step_find_the_same(monkeypatch):
    dense = newton(Circle(6), np.full(6, 3.0), 1e-13, 10)
    monkeypatch.setattr(module, "DENSE", 5)
    krylov = newton(Circle(6), np.full(6, 3.0), 1e-13, 20)
    assert krylov.reason == ""
    np.testing.assert_allclose(krylov.x, dense.x, rtol=1e-12)
    assert len(krylov.sizes) >= len(dense.sizes)


def test_no_solution_is_said_so():
    found = newton(Circle(4, slope=1e3), np.full(4, 3.0), 1e-13, 4)
    assert len(found.sizes) == 5
    assert found.reason.startswith("the relative residual is 1")
    assert found.reason.endswith("after 4 steps, the tolerance 1e-13")


def test_what_is_not_finite_ends_it():
    with np.errstate(over="ignore", invalid="ignore"):
        found = newton(Circle(4, 1e-200), np.full(4, 3.0), 1e-13, 9)
    assert "not finite after 1 steps" in found.reason
    np.testing.assert_array_equal(found.x, 3.0)
    assert len(found.sizes) == 1
