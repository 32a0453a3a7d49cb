"""Rules of growing size on the circle or the sphere that keep a symmetry group."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from granstudy.quadrature.circle import circle_rule
from granstudy.quadrature.orbits import invariance, representatives
from granstudy.quadrature.rule import Rule, half
from granstudy.quadrature.sphere import sphere_rule
from granstudy.velocity.symmetry import Symmetry

LEBEDEV_SIZES = (6, 14, 26, 38, 50, 86, 110, 146, 170, 194, 302, 434, 590, 770, 974)
"""Lebedev's rules without those of negative weights and, at the top, without every other."""

CIRCLE_SIZES = (4, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128)


@dataclass(frozen=True, eq=False)
class Step:
    """One rule of a ladder: its ``pairs`` ±ĝ, and the ``reduced`` rule of its orbits."""

    size: int
    pairs: Rule
    reduced: Rule


@dataclass(frozen=True, eq=False)
class Ladder:
    """Rules that all keep ``group``, under which their orbits are taken; cheapest first."""

    rule: str
    group: Symmetry
    steps: Sequence[Step]

    def __len__(self) -> int:
        return len(self.steps)

    def level(self, size: int) -> int:
        """Which step has the size."""
        return next(i for i, step in enumerate(self.steps) if step.size == size)


@cache
def ladder(dim: int, group: Symmetry) -> Ladder:
    """Lebedev's rules (3D) or circles (2D) that keep a scene's group.

    Lebedev's rules keep every group there is; circles of 4m points too, others may not. Where the group
    saves nothing over pairs ±ĝ on any rule it is {1}. A rule is left out where a larger one has no more
    orbits.
    """
    name = "circle" if dim == 2 else "lebedev"
    rules = (
        [circle_rule(M) for M in CIRCLE_SIZES]
        if dim == 2
        else [sphere_rule(M, "lebedev") for M in LEBEDEV_SIZES]
    )
    rules = [rule for rule in rules if invariance(rule, group) == group]
    steps = [Step(len(rule), half(rule), representatives(rule, group)) for rule in rules]
    steps = [
        step
        for i, step in enumerate(steps)
        if all(len(step.reduced) < len(better.reduced) for better in steps[i + 1 :])
    ]
    if all(len(step.reduced) == len(step.pairs) for step in steps):
        group = Symmetry.named(dim, "none")
        steps = [Step(step.size, step.pairs, step.pairs) for step in steps]
    return Ladder(name, group, steps)
