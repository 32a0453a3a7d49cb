"""A ladder of rules of growing size on the circle or the sphere that all keep a symmetry group."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from granstudy.quadrature.circle import circle_rule
from granstudy.quadrature.orbits import invariance, representatives
from granstudy.quadrature.rule import Rule, half
from granstudy.quadrature.sphere import sphere_rule
from granstudy.velocity.symmetry import Symmetry

LEBEDEV_SIZES = (6, 14, 26, 38, 50, 86, 110, 146, 170, 194, 302, 434, 590, 770, 974)
"""Points of Lebedev's rules on the ladder. Rules with negative weights are excluded, and of the largest
every other one."""

CIRCLE_SIZES = (4, 6, 8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128)
"""Points of the circles on the ladder."""


@dataclass(frozen=True, eq=False)
class Step:
    """One rule of a ladder, of ``size`` points.

    ``pairs`` holds one point of each pair ±ĝ, ``reduced`` one point of each orbit, with the weights of all.
    """

    size: int
    pairs: Rule
    reduced: Rule


@dataclass(frozen=True, eq=False)
class Ladder:
    """Rules that all keep ``group``, the group of their orbits. The cheapest rule comes first."""

    rule: str
    group: Symmetry
    steps: Sequence[Step]

    def __len__(self) -> int:
        return len(self.steps)

    def level(self, size: int) -> int:
        """Number of the step whose rule has ``size`` points."""
        return next(i for i, step in enumerate(self.steps) if step.size == size)


@cache
def ladder(dim: int, group: Symmetry) -> Ladder:
    """The ladder of Lebedev's rules (3D) or circles (2D) that keep a scene's group.

    Lebedev's rules and circles of 4m points keep every group; other circles may not, and are then left out.
    A rule is left out as well where a larger rule has no more orbits. The ladder's group is {1} where
    orbits are no fewer than pairs ±ĝ on every rule.
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
