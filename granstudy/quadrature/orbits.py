"""Orbits of a rule's directions under a group and ±1."""

import numpy as np
from scipy.spatial import KDTree

from granstudy.quadrature.rule import ANTIPODAL_TOLERANCE, Rule, symmetrise
from granstudy.velocity.symmetry import Element, Symmetry, move


def invariance(rule: Rule, group: Symmetry) -> Symmetry:
    """The elements of ``group`` under which `symmetrise(rule)` is invariant, weights included.

    Lebedev's rules keep all of the octahedral group, designs what their orbits are made by (or ±1 only).
    """
    full = symmetrise(rule)
    tree = KDTree(full.points)
    return Symmetry(group.dim, frozenset(h for h in group.elements if _keeps(h, full, tree)))


def representatives(rule: Rule, group: Symmetry) -> Rule:
    """One point of each orbit of `symmetrise(rule)` under ``group`` and ±1, with the orbit's weight.

    Applied to an average over the group and ±1 it is the whole rule. Of each orbit the point that
    comes first is kept; with the group {1} this is `half`.

    Raises
    ------
    ValueError
        If the rule is not invariant under the group.
    """
    full = symmetrise(rule)
    tree = KDTree(full.points)
    first = np.arange(len(full))
    for h in group.elements:
        if not _keeps(h, full, tree):
            raise ValueError(f"rule {rule.name!r} is not invariant under {group!r}")
        for sign in (1.0, -1.0):
            # the image of an orbit's point is in the orbit, so the least row over all images names it
            first = np.minimum(first, tree.query(sign * move(h, full.points))[1])
    rows, orbit = np.unique(first, return_inverse=True)
    weights = np.bincount(orbit, weights=full.weights).astype(np.float64)
    name = f"{len(rows)} orbits of {rule.name}"
    return Rule(full.points[rows], weights, full.degree, name)


def _keeps(h: Element, rule: Rule, tree: KDTree) -> bool:
    distance, image = tree.query(move(h, rule.points))
    difference = np.abs(rule.weights - rule.weights[image])
    return bool(
        np.all(distance <= ANTIPODAL_TOLERANCE)
        and np.all(difference <= ANTIPODAL_TOLERANCE * np.abs(rule.weights))
        and len(np.unique(image)) == len(rule)
    )
