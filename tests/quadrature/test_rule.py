"""A rule is data; antipodal pairs and their halves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from granstudy.quadrature import (
    Rule,
    circle_rule,
    exact_degree,
    half,
    radial_rule,
    residual,
    sphere_rule,
    symmetrise,
)

ANTIPODAL = [
    circle_rule(2),
    circle_rule(30),
    sphere_rule(32),
    sphere_rule(50, "lebedev"),
    sphere_rule(74, "lebedev"),
    sphere_rule(18, "product"),
]
NOT_ANTIPODAL = [circle_rule(1), circle_rule(7), sphere_rule((6, 8), "gauss-theta-phi")]


def test_arrays_are_read_only_copies():
    points, weights = np.array([0.1, 0.9]), np.array([0.5, 0.5])
    rule = Rule(points, weights, 1, "mine")
    points[0] = 7.0
    assert rule.points[0] == 0.1
    for array in (rule.points, rule.weights):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
    assert len(rule) == 2


@pytest.mark.parametrize(
    ("points", "weights", "message"),
    [
        (np.zeros((2, 4)), np.ones(2), r"points: shape \(2, 4\)"),
        (np.zeros((2, 2, 2)), np.ones(2), "points: shape"),
        (np.zeros(2), np.ones(3), r"weights: shape \(3,\)"),
        (np.zeros(0), np.ones(0), "at least one point"),
        (np.array([np.nan]), np.ones(1), "points: not all finite"),
        (np.zeros(1), np.array([np.inf]), "weights: not all finite"),
        (np.array([[1.0, 0.0], [1.0, 1e-5]]), np.ones(2), "points: row 1 has a length off 1 by 5"),
    ],
)
def test_bad_input_is_named(points, weights, message):
    with pytest.raises(ValueError, match=message):
        Rule(points, weights, 0, "bad")


@pytest.mark.parametrize("rule", ANTIPODAL, ids=lambda rule: rule.name)
def test_half_of_an_antipodal_rule_keeps_one_of_each_pair(rule):
    assert rule.antipodal
    assert symmetrise(rule) is rule
    part = half(rule)
    assert len(part) == len(rule) // 2
    assert part.degree == rule.degree
    assert not part.antipodal
    assert part.weights.sum() == pytest.approx(rule.weights.sum(), rel=1e-14)
    whole = np.vstack([part.points, -part.points])
    distance = np.linalg.norm(whole[:, None] - rule.points[None], axis=-1)
    assert np.all(distance.min(axis=0) < 1e-12)


@pytest.mark.parametrize("rule", NOT_ANTIPODAL, ids=lambda rule: rule.name)
def test_half_of_another_rule_is_the_rule(rule):
    assert not rule.antipodal
    whole, part = symmetrise(rule), half(rule)
    assert whole.antipodal
    assert len(whole) == 2 * len(rule)
    assert np.array_equal(part.points, rule.points)
    assert np.array_equal(part.weights, rule.weights)
    assert part.degree == whole.degree


@pytest.mark.parametrize("rule", ANTIPODAL + NOT_ANTIPODAL, ids=lambda rule: rule.name)
def test_half_applied_to_the_even_part_is_the_symmetrised_rule(rule):
    def phi(x):
        return np.exp(x @ np.arange(1.0, x.shape[1] + 1))

    part, whole = half(rule), symmetrise(rule)
    even = (phi(part.points) + phi(-part.points)) / 2
    assert part.weights @ even == pytest.approx(whole.weights @ phi(whole.points), rel=1e-13)


def test_symmetrising_makes_odd_functions_exact():
    # 7 angles are exact to degree 6; with the antipodes, 14 angles, to degree 13 — of which
    # symmetrising alone promises 7
    whole = symmetrise(circle_rule(7))
    assert (circle_rule(7).degree, whole.degree) == (6, 7)
    assert (circle_rule(5).degree, symmetrise(circle_rule(5)).degree) == (4, 5)
    theta = np.arctan2(whole.points[:, 1], whole.points[:, 0])
    assert abs(whole.weights @ np.exp(7j * theta)) < 1e-13
    # one point is exact for constants only; the pair, to degree 1
    pole = Rule(np.array([[0.0, 0.0, 1.0]]), np.array([4 * np.pi]), 0, "pole")
    assert symmetrise(pole).degree == exact_degree(symmetrise(pole).points) == 1
    # symmetrising cannot make exact what is not: 1 stays inexact
    assert symmetrise(sphere_rule((2, 3), "gauss-theta-phi")).degree == -1


def test_equal_weights_are_needed():
    points = np.array([[1.0, 0.0], [-1.0, 0.0]])
    assert Rule(points, np.array([1.0, 1.0]), 1, "equal").antipodal
    assert not Rule(points, np.array([1.0, 1.1]), 0, "unequal").antipodal


@given(st.integers(0, 2**32 - 1), st.floats(1e-9, 0.1))
def test_a_moved_point_is_noticed(seed, angle):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(5, 3))
    points = np.vstack([points, -points]) / np.tile(np.linalg.norm(points, axis=1), 2)[:, None]
    order = rng.permutation(10)
    assert Rule(points[order], np.ones(10), 1, "shuffled").antipodal
    across = np.cross(points[3], points[0])
    moved = points.copy()
    moved[3] = np.cos(angle) * points[3] + np.sin(angle) * across / np.linalg.norm(across)
    moved[3] /= np.linalg.norm(moved[3])
    assert not Rule(moved[order], np.ones(10), 0, "moved").antipodal


def test_a_radial_rule_has_no_antipodes():
    rule = radial_rule(4, 1.0)
    assert not rule.antipodal
    for function in (half, symmetrise):
        with pytest.raises(ValueError, match="radial: only directions have antipodes"):
            function(rule)


def test_residual_of_a_half_is_that_of_even_harmonics_only():
    part = half(sphere_rule(12))
    assert part.degree == 5
    assert residual(part.points, 1) > 0.1
