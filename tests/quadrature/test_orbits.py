"""Orbits of directions under symmetry groups."""

import numpy as np
import pytest

from granstudy.quadrature import circle_rule, half, sphere_rule
from granstudy.quadrature.orbits import invariance, representatives
from granstudy.velocity.symmetry import NAMED, Symmetry

OCTAHEDRAL = Symmetry.named(3, "full")

LEBEDEV_ORBITS = {6: 1, 14: 2, 26: 3, 38: 3, 50: 4, 86: 5, 110: 6, 194: 9}
"""Classes of points of Lebedev's rules under the octahedral group (Lebedev and Laikov 1999)."""


@pytest.mark.parametrize("M", LEBEDEV_ORBITS)
def test_lebedev_rules_are_octahedral(M):
    rule = sphere_rule(M, "lebedev")
    assert invariance(rule, OCTAHEDRAL) == OCTAHEDRAL
    assert len(representatives(rule, OCTAHEDRAL)) == LEBEDEV_ORBITS[M]


@pytest.mark.parametrize("M", [8, 32, 72])
def test_product_rules_have_their_own_group(M):
    # x, y: what turns 2n uniform angles into themselves; z: reflection
    group = invariance(sphere_rule(M, "product"), OCTAHEDRAL)
    assert len(group) == 16
    assert Symmetry.generated(3, "y,x,z").elements <= group.elements


def test_designs_have_the_inversion():
    for M in (32, 48, 70, 94):
        group = invariance(sphere_rule(M), OCTAHEDRAL)
        assert Symmetry.named(3, "inversion").elements <= group.elements
        assert len(representatives(sphere_rule(M), group)) >= M // 2 // (len(group) // 2)


@pytest.mark.parametrize(("M", "order", "orbits"), [(16, 8, 3), (8, 8, 2), (6, 4, 2), (5, 4, 3)])
def test_circles(M, order, orbits):
    # an odd rule is symmetrised first
    group = invariance(circle_rule(M), Symmetry.named(2, "full"))
    assert len(group) == order
    assert len(representatives(circle_rule(M), group)) == orbits


@pytest.mark.parametrize("name", NAMED)
def test_representatives_integrate_invariant_functions(name):
    group = Symmetry.named(3, name)
    for rule in (sphere_rule(50, "lebedev"), sphere_rule(26, "lebedev")):
        reduced = representatives(rule, group)
        assert np.isclose(reduced.weights.sum(), 4 * np.pi, rtol=1e-14)
        phase = rule.points @ np.array([0.3, -0.7, 1.1])
        values = np.zeros(len(rule))
        for h in group.elements:
            axes, signs = zip(*h, strict=True)
            values += np.cos((rule.points[:, axes] * signs) @ np.array([0.3, -0.7, 1.1]))
        lookup = {tuple(np.round(x, 9)): v for x, v in zip(rule.points, values, strict=True)}
        at_reduced = [lookup[tuple(np.round(x, 9))] for x in reduced.points]
        exact = len(group) * (rule.weights @ np.cos(phase))
        assert np.isclose(reduced.weights @ at_reduced, exact, rtol=1e-13)


def test_the_trivial_group_leaves_pairs():
    rule, trivial = sphere_rule(32), Symmetry.named(3, "none")
    reduced = representatives(rule, trivial)
    assert np.array_equal(reduced.points, half(rule).points)
    assert np.allclose(reduced.weights, half(rule).weights, rtol=1e-15)


def test_a_rule_without_the_group_is_refused():
    with pytest.raises(ValueError, match=r"not invariant under Symmetry\(3, 'full'\)"):
        representatives(sphere_rule(32), OCTAHEDRAL)
