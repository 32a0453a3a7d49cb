"""Groups of signed permutations of the velocity axes.

In 3D the largest is the octahedral group O_h (48 elements), in 2D the square's D_4 (8). An element h maps
(h v)_i = s_i v_{p_i}, and a density to (h·f)(v) = f(h⁻¹ v). As the nodes are cell centres, symmetric about
v = 0, h·f on a grid is a transposed and reversed array, without interpolation.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np

from granstudy.errors import unknown_name

AXES = "xyz"

Element = tuple[tuple[int, int], ...]
"""(p_i, s_i) for every axis i: the axis taken and its sign."""

NAMED = {
    "none": {2: (), 3: ()},
    "inversion": {2: ("-x,-y",), 3: ("-x,-y,-z",)},
    "reflections": {2: ("-x,y", "x,-y"), 3: ("-x,y,z", "x,-y,z", "x,y,-z")},
    "exchange": {2: ("y,x",), 3: ("y,z,x", "y,x,z")},
    "full": {2: ("-x,y", "x,-y", "y,x"), 3: ("-x,y,z", "x,-y,z", "x,y,-z", "y,z,x", "y,x,z")},
}
"""Generators of the groups that have a name; ``full`` is O_h in 3D and D_4 in 2D."""

TOLERANCE = 1e-10
"""Largest |h·f − f| over max|f| of a density that counts as symmetric."""

SPOTS = 64
"""Grid points of the cheap check."""


@dataclass(frozen=True)
class Symmetry:
    """A group of signed permutations of the axes.

    Attributes
    ----------
    dim : int
        Number of axes, 2 or 3.
    elements : frozenset of Element
        The group, the identity included; see `symmetry` and `generated`.
    """

    dim: int
    elements: frozenset[Element]

    def __len__(self) -> int:
        return len(self.elements)

    def __repr__(self) -> str:
        return f"Symmetry({self.dim}, {self.name!r})"

    @property
    def name(self) -> str:
        """Its name, or its generators as coordinate triplets: ``y,x,z; -x,y,z``."""
        for name in NAMED:
            if self == symmetry(self.dim, name):
                return name
        return "; ".join(map(triplet, self.generators))

    def __and__(self, other: "Symmetry") -> "Symmetry":
        """The elements of both groups."""
        return Symmetry(self.dim, self.elements & other.elements)

    @cached_property
    def chain(self) -> tuple[tuple[Element, ...], ...]:
        """Coset representatives of growing subgroups, {1} ⊂ H₁ ⊂ H₂ ... up to the group.

        Σ_{h∈G} h·f is a product of short sums, Π_i Σ_{c∈chain_i} c·: six images instead of 47 for O_h.
        """
        chain = []
        subgroup = frozenset({identity(self.dim)})
        while subgroup != self.elements:
            larger = min(
                (
                    _closure(self.dim, subgroup | {h})
                    for h in sorted(self.elements - subgroup, key=triplet)
                ),
                key=len,
            )
            representatives: list[Element] = []
            covered: set[Element] = set()
            # the identity stands for the subgroup itself
            for c in [identity(self.dim), *sorted(larger, key=triplet)]:
                if c not in covered:
                    representatives.append(c)
                    covered |= {compose(c, h) for h in subgroup}
            chain.append(tuple(representatives))
            subgroup = larger
        return tuple(chain)

    @property
    def generators(self) -> tuple[Element, ...]:
        """Few elements that generate the group."""
        return tuple(step[1] for step in self.chain)

    def symmetrise(self, f: np.ndarray) -> np.ndarray:
        """(1/|G|) Σ_{h∈G} h·f."""
        for step in self.chain:
            total = f.copy()
            for c in step[1:]:
                total += apply(c, f)
            f = total
        return f / len(self) if len(self) > 1 else f

    def check(self, f: np.ndarray, what: str) -> None:
        """Raise ValueError unless h·f = f for every element, to `TOLERANCE` of max|f|."""
        largest = np.max(np.abs(f))
        for h in self.generators:
            change = np.max(np.abs(apply(h, f) - f))
            if change > TOLERANCE * largest:
                raise _broken(self, what, h, change / largest)

    def spot_check(self, f: np.ndarray, what: str) -> None:
        """`check` at a few points only: microseconds, and any density without symmetry fails it."""
        if len(self) == 1:
            return
        points, images = self._spots(f.shape)
        values = f.ravel()[points]
        change = np.abs(f.ravel()[images] - values)
        if change.max() > TOLERANCE * np.max(np.abs(f)):
            worst = int(np.argmax(change.max(axis=1)))
            raise _broken(self, what, self.generators[worst], change.max() / np.max(np.abs(f)))

    def _spots(self, shape: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
        """Flat indices of the points, and of their images under each generator; kept."""
        cache: dict[tuple[int, ...], tuple[np.ndarray, np.ndarray]]
        cache = self.__dict__.setdefault("_spot_cache", {})
        if shape not in cache:
            index = np.arange(np.prod(shape)).reshape(shape)
            # the middle half of the box, where densities differ from zero
            N = shape[0]
            middle = index[(slice(N // 4, N - N // 4),) * len(shape)].ravel()
            points = np.random.default_rng(0).choice(middle, min(SPOTS, len(middle)), replace=False)
            images = np.stack([apply(h, index).ravel()[points] for h in self.generators])
            cache[shape] = points, images
        return cache[shape]


def symmetry(dim: int, name: str) -> Symmetry:
    """The group of that name in `NAMED`.

    Raises
    ------
    ValueError
        If there is none.
    """
    if name not in NAMED:
        raise unknown_name("symmetry", name, tuple(NAMED))
    return generated(dim, *NAMED[name][dim])


def generated(dim: int, *generators: str) -> Symmetry:
    """The group generated by coordinate triplets, as ``"y,x,z"`` and ``"-x,y,z"`` (pairs in 2D).

    Raises
    ------
    ValueError
        If one is not a signed permutation of the axes.
    """
    return Symmetry(dim, _closure(dim, [_parse(dim, text) for text in generators]))


def stabiliser(group: Symmetry, vector: Iterable[float]) -> Symmetry:
    """The elements that leave a vector as it is."""
    u = np.asarray(list(vector))
    return Symmetry(
        group.dim, frozenset(h for h in group.elements if np.array_equal(move(h, u), u))
    )


def identity(dim: int) -> Element:
    """The element that changes nothing."""
    return tuple((axis, 1) for axis in range(dim))


def compose(a: Element, b: Element) -> Element:
    """a∘b."""
    return tuple((b[p][0], s * b[p][1]) for p, s in a)


def move(h: Element, points: np.ndarray) -> np.ndarray:
    """H x for every x, coordinates along the last axis."""
    return points[..., [p for p, _ in h]] * np.array([s for _, s in h])


def apply(h: Element, f: np.ndarray) -> np.ndarray:
    """h·f for an array over the grid, as a view."""
    reverse = tuple(slice(None, None, s) for _, s in h)
    return f.transpose([p for p, _ in h])[reverse]


def triplet(h: Element) -> str:
    """An element as text, ``y,-x,z``."""
    return ",".join(("" if s > 0 else "-") + AXES[p] for p, s in h)


def _parse(dim: int, text: str) -> Element:
    parts = [part.strip() for part in str(text).split(",")]
    axes = [part.removeprefix("-") for part in parts]
    if sorted(axes) != sorted(AXES[:dim]):
        raise ValueError(
            f"symmetry {text!r}: must be the axes {', '.join(AXES[:dim])} in any order, each with "
            "a sign or without, as 'y,-x,z'"
        )
    return tuple(
        (AXES.index(axis), -1 if part.startswith("-") else 1)
        for part, axis in zip(parts, axes, strict=True)
    )


def _closure(dim: int, generators: Iterable[Element]) -> frozenset[Element]:
    """The group that elements generate."""
    generators = tuple(generators)
    found = {identity(dim)}
    new = found
    while new:
        new = {compose(a, b) for a in generators for b in new} - found
        found = found | new
    return frozenset(found)


def _broken(group: Symmetry, what: str, h: Element, change: float) -> ValueError:
    return ValueError(
        f"symmetry={group.name!r}: {what} does not have it; {triplet(h)} changes it by "
        f"{change:.1e} of its largest value, allowed is {TOLERANCE:.0e}"
    )


def common(groups: Iterable[Symmetry]) -> Symmetry:
    """The elements that all groups have."""
    return reduce(lambda a, b: a & b, groups)
