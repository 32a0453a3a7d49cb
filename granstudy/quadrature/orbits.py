"""Orbits of a rule's directions under a group and ±1."""

import numpy as np
import scipy

from granstudy.quadrature.rule import ANTIPODAL_TOLERANCE, Rule, symmetrise
from granstudy.velocity.symmetry import Element, Symmetry, move


def invariance(rule: Rule, group: Symmetry) -> Symmetry:
    """The subgroup of ``group`` that leaves `symmetrise(rule)` as it is, weights included.

    Lebedev's rules are invariant under the whole octahedral group, a design under the group that made its
    orbits.
    """
    full = symmetrise(rule)
    tree = scipy.spatial.KDTree(full.points)
    return Symmetry(group.dim, frozenset(h for h in group.elements if _keeps(h, full, tree)))


def representatives(rule: Rule, group: Symmetry) -> Rule:
    """One point of each orbit of `symmetrise(rule)` under ``group`` and ±1, with the orbit's weight.

    Applied to an average over the group and ±1, it gives the same as the whole rule. The first point of
    each orbit is kept. With the group {1} the result is that of `half`.

    Raises
    ------
    ValueError
        If the rule is not invariant under the group.
    """
    full = symmetrise(rule)
    tree = scipy.spatial.KDTree(full.points)
    first = np.arange(len(full))
    for h in group.elements:
        if not _keeps(h, full, tree):
            raise ValueError(f"rule {rule.name!r} is not invariant under {group!r}")
        for sign in (1.0, -1.0):
            # All images of a point lie in its orbit, so that the least row among them names the orbit.
            first = np.minimum(first, tree.query(sign * move(h, full.points))[1])
    rows, orbit = np.unique(first, return_inverse=True)
    weights = np.bincount(orbit, weights=full.weights).astype(np.float64)
    name = f"{len(rows)} orbits of {rule.name}"
    return Rule(full.points[rows], weights, full.degree, name)


def _keeps(h: Element, rule: Rule, tree: "scipy.spatial.KDTree") -> bool:
    distance, image = tree.query(move(h, rule.points))
    difference = np.abs(rule.weights - rule.weights[image])
    return bool(
        np.all(distance <= ANTIPODAL_TOLERANCE)
        and np.all(difference <= ANTIPODAL_TOLERANCE * np.abs(rule.weights))
        and len(np.unique(image)) == len(rule)
    )
