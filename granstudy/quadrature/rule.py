"""Quadrature rules: points and weights."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

ANTIPODAL_TOLERANCE = 1e-12
"""Largest distance of a point from the antipode that it stands for, and relative difference of equal
weights."""

UNIT_TOLERANCE = 1e-12
"""Largest | |x_i| − 1 | of a direction."""


MOST_DIRECTIONS = 2**16
"""Most directions of a rule. No grid of a size that can be computed resolves as many."""

BYTES_OF_A_DIRECTION = 120
"""Bytes of a direction: point and weight, a tree of points, and the images under a symmetry."""

LARGEST_GAUSS = 4096
"""Most nodes of a Gauss rule. Its nodes are eigenvalues, in a time of n³."""


@dataclass(frozen=True, eq=False)
class Rule:
    """Σ_i weights_i φ(points_i), an approximation of an integral of φ.

    Attributes
    ----------
    points : ndarray, read-only
        Shape (n,) for a radial rule; unit vectors (n, 2) on the circle, (n, 3) on the sphere.
    weights : ndarray, read-only
        Shape (n,). The weights sum to the measure of the domain: R, 2π or 4π.
    degree : int
        Degree to which the rule is exact for polynomials, on the circle and the sphere for harmonics; −1
        where it is not exact for constants.
    name : str
        Name for messages.

    Raises
    ------
    ValueError
        If the shapes do not match, a number is not finite, or a direction is not a unit vector.
    """

    points: NDArray[np.float64]
    weights: NDArray[np.float64]
    degree: int
    name: str

    def __post_init__(self) -> None:
        for field in ("points", "weights"):
            object.__setattr__(self, field, _read_only(field, getattr(self, field)))
        if self.points.ndim not in (1, 2) or self.points.shape[1:] not in ((), (2,), (3,)):
            raise ValueError(f"points: shape {self.points.shape}; must be (n,), (n, 2) or (n, 3)")
        if self.weights.shape != self.points.shape[:1] or len(self.weights) == 0:
            raise ValueError(
                f"weights: shape {self.weights.shape} for points of shape {self.points.shape}; "
                "must be one for each of at least one point"
            )
        if self.points.ndim == 2:
            check_unit_vectors("points", self.points)

    def __len__(self) -> int:
        return len(self.weights)

    @cached_property
    def antipodal(self) -> bool:
        """Whether every point x has its antipode −x among the points, with the same weight.

        Points and weights are compared to `ANTIPODAL_TOLERANCE`. False for a radial rule.
        """
        if self.points.ndim == 1:
            return False
        distance, partner = _antipodes(self.points)
        difference = np.abs(self.weights - self.weights[partner])
        return bool(
            np.all(distance <= ANTIPODAL_TOLERANCE)
            and np.all(difference <= ANTIPODAL_TOLERANCE * np.abs(self.weights))
            and np.all(partner[partner] == np.arange(len(self)))
        )


def symmetrise(rule: Rule) -> Rule:
    """The antipodal rule ½ Σ_i w_i [φ(x_i) + φ(−x_i)]. An antipodal rule is returned as it is.

    Row i + n is minus row i. Odd functions are integrated exactly, so that an even degree grows by one.

    Raises
    ------
    ValueError
        For a radial rule.
    """
    _check_directions(rule)
    if rule.antipodal:
        return rule
    points = np.concatenate([rule.points, -rule.points])
    weights = np.concatenate([rule.weights, rule.weights]) / 2
    return Rule(points, weights, _antipodal_degree(rule.degree), f"{rule.name}, symmetrised")


def half(rule: Rule) -> Rule:
    """One point of each antipodal pair of `symmetrise(rule)`, with the weight of both.

    The half rule is for a solver that evaluates ½ [φ(x) + φ(−x)] at once. Applied to that average it gives
    what the symmetrised rule gives for φ. Its degree is that of the symmetrised rule, and holds for even
    functions alone. The first point of each pair is kept, so that a rule that is not antipodal keeps all
    its points and weights.

    Raises
    ------
    ValueError
        For a radial rule.
    """
    _check_directions(rule)
    if not rule.antipodal:
        points, weights = rule.points, rule.weights
    else:
        partner = _antipodes(rule.points)[1]
        first = np.arange(len(rule)) < partner
        points = rule.points[first]
        weights = rule.weights[first] + rule.weights[partner][first]
    degree = rule.degree if rule.antipodal else _antipodal_degree(rule.degree)
    return Rule(points, weights, degree, f"half of {rule.name}")


def is_size(value: object) -> bool:
    """Whether ``value`` is an integer of at least 1, Python's or NumPy's."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool) and int(value) >= 1


def check_size(field: str, value: object) -> None:
    """Raise ValueError unless ``value`` is an integer of at least 1, Python's or NumPy's."""
    if not is_size(value):
        raise ValueError(f"{field}={value!r}: must be a positive integer")


def check_direction_count(field: str, count: int) -> None:
    """Raise ValueError for more directions than `MOST_DIRECTIONS`, before they are made."""
    if count > MOST_DIRECTIONS:
        raise ValueError(
            f"{field}={count}: at most {MOST_DIRECTIONS}; a rule of so many points takes about "
            f"{BYTES_OF_A_DIRECTION * count / 1e9:.3g} GB"
        )


def check_gauss_size(field: str, count: int) -> None:
    """Raise ValueError for a Gauss rule above `LARGEST_GAUSS`, before its n × n matrix is made."""
    if count > LARGEST_GAUSS:
        raise ValueError(
            f"{field}={count}: at most {LARGEST_GAUSS}; the nodes are eigenvalues of a matrix that takes "
            f"about {8e-9 * count**2:.3g} GB"
        )


def check_unit_vectors(field: str, points: NDArray[np.float64]) -> None:
    """Raise ValueError, naming ``field`` and the worst row, unless all rows have unit length."""
    deviation = np.abs(np.linalg.norm(points, axis=1) - 1)
    worst = int(np.argmax(deviation))
    if deviation[worst] > UNIT_TOLERANCE:
        raise ValueError(
            f"{field}: row {worst} has a length off 1 by {deviation[worst]:.1e}; "
            f"must be unit vectors within {UNIT_TOLERANCE:.0e}"
        )


def _read_only(field: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """A read-only copy, checked to be finite."""
    array = np.array(values, dtype=np.float64)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{field}: not all finite")
    array.flags.writeable = False
    return array


def _antipodes(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.intp]]:
    """For every point x, the distance from −x to the nearest point, and that point's row."""
    return scipy.spatial.KDTree(points).query(-points)


def _antipodal_degree(degree: int) -> int:
    """Degree of a rule once it is exact for all odd functions: an even degree grows by one."""
    return degree + 1 if degree % 2 == 0 else degree


def _check_directions(rule: Rule) -> None:
    if rule.points.ndim == 1:
        raise ValueError(f"rule {rule.name!r} is radial: only directions have antipodes")
