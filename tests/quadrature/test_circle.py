"""The circle rule: the paper's placement, exact to degree M_cir − 1."""

import numpy as np
import pytest
from scipy.special import j0

from granstudy.quadrature import circle_rule


def test_angles_start_at_zero_and_are_uniform():
    rule = circle_rule(5)
    theta = 2 * np.pi * np.arange(5) / 5
    assert np.array_equal(rule.points, np.column_stack([np.cos(theta), np.sin(theta)]))
    assert np.array_equal(rule.weights, np.full(5, 2 * np.pi / 5))


@pytest.mark.parametrize("M_cir", [1, 2, 3, 8, 30, 31])
def test_exact_to_its_degree_and_no_further(M_cir):
    rule = circle_rule(M_cir)
    z = rule.points[:, 0] + 1j * rule.points[:, 1]
    assert rule.degree == M_cir - 1
    assert rule.weights.sum() == pytest.approx(2 * np.pi, rel=1e-15)
    for m in range(1, rule.degree + 1):
        assert abs(rule.weights @ z**m) < 1e-13, f"m={m}"
    assert rule.weights @ z ** (rule.degree + 1) == pytest.approx(2 * np.pi, rel=1e-13)


@pytest.mark.parametrize("M_cir", [1, 2, 3, 8, 30, 31])
def test_antipodal_when_even(M_cir):
    assert circle_rule(M_cir).antipodal == (M_cir % 2 == 0)


def test_plane_wave_converges_faster_than_any_power():
    # ∫ e^{ik·x} dθ = 2π J0(|k|); the first missed term is 2 J_M(|k|), super-exponential in M
    k = 5.0 * np.array([np.cos(0.4), np.sin(0.4)])
    exact = 2 * np.pi * j0(5.0)
    errors = {M: abs(rule.weights @ np.exp(1j * rule.points @ k) - exact)
              for M in (8, 12, 16, 20, 30) for rule in [circle_rule(M)]}  # fmt: skip
    assert errors[8] > 1e-2 > 1e-3 > errors[12] > errors[16] > errors[20], errors
    assert errors[30] < 1e-13, errors


@pytest.mark.parametrize("M_cir", [0, -3, 2.0, True, "8", None])
def test_bad_input_is_named(M_cir):
    with pytest.raises(ValueError, match=f"M_cir={M_cir!r}: must be a positive integer"):
        circle_rule(M_cir)


def test_more_points_than_any_grid_resolves_are_refused():
    assert len(circle_rule(2**16)) == 2**16
    with pytest.raises(ValueError, match="M_cir=100000000: at most 65536; .* takes about 12 GB"):
        circle_rule(10**8)
