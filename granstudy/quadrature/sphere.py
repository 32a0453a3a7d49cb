"""Rules on the unit sphere."""

import math
import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray

from granstudy.quadrature.design_data import DESIGN_DEGREE, design_points
from granstudy.quadrature.harmonics import exact_degree
from granstudy.quadrature.rule import (
    UNIT_TOLERANCE,
    Rule,
    check_direction_count,
    check_gauss_size,
    is_size,
)
from granstudy.support.errors import unknown_name

LEBEDEV_DEGREE = {
    6: 3, 14: 5, 26: 7, 38: 9, 50: 11, 74: 13, 86: 15, 110: 17, 146: 19, 170: 21, 194: 23,
    230: 25, 266: 27, 302: 29, 350: 31, 434: 35, 590: 41, 770: 47, 974: 53, 1202: 59, 1454: 65,
    1730: 71, 2030: 77, 2354: 83, 2702: 89, 3074: 95, 3470: 101, 3890: 107, 4334: 113, 4802: 119,
    5294: 125, 5810: 131,
}  # fmt: skip
"""Degree of the Lebedev rule of each size, as in `scipy.integrate.lebedev_rule` (Lebedev and Laikov 1999).
The rules of 74, 230 and 266 points have negative weights."""

PRODUCT_SIZES = tuple(2 * n**2 for n in range(1, 65))
"""Points of the product rules."""

SPHERE_RULES = ("design", "lebedev", "product", "gauss-theta-phi")
"""Names of the rules that `sphere_rule` takes, beside paths of text files."""

SHOWN = 80
"""Most characters of a line that a message shows."""

Size = int | tuple[int, int] | None
"""Size M_sph of a rule: points, the pair (N_theta, N_phi), or None for all points of a file."""


def sphere_rule(M_sph: Size, rule: str | os.PathLike[str] = "design") -> Rule:
    """Rule with M_sph points on the unit sphere and weights that sum to 4π (docs/method.md §2).

    design
        Symmetric spherical designs, equal weights, computed by `granstudy.quadrature.designs`.
    lebedev
        Lebedev's octahedral rules, from scipy.
    product
        n Gauss–Legendre nodes in cos θ × 2n uniform φ from 0 on: M_sph = 2n², degree 2n − 1.
    gauss-theta-phi
        The rule of the paper's Table 8: Gauss–Legendre in θ on [0, π], with sin θ in the
        weight, × Gauss–Legendre in φ on [0, 2π]. M_sph is the pair (N_theta, N_phi). No polynomial is
        integrated exactly, not even 1: the degree is −1, and the weights sum to 4π in the limit of many
        points.
    path of a text file
        Unit vectors in three columns, equal weights, degree measured. M_sph is the number of points, or
        None for all points of the file.

    Points (M_sph, 3).

    Raises
    ------
    ValueError
        If `M_sph` is not a size of the rule (the message names the nearest), the rule is neither known nor
        a file, or the file does not hold unit vectors within 1e-12 (the message names the line).
    """
    match rule:
        case "design":
            size = _listed_size(M_sph, rule)
            return _equal_weights(design_points(size), DESIGN_DEGREE[size], f"design M_sph={size}")
        case "lebedev":
            return _lebedev(_listed_size(M_sph, rule))
        case "product":
            return _product(_listed_size(M_sph, rule))
        case "gauss-theta-phi":
            N_theta, N_phi = _pair(M_sph)
            check_direction_count(f"M_sph={M_sph!r}: N_theta * N_phi", N_theta * N_phi)
            for field, size in (("N_theta", N_theta), ("N_phi", N_phi)):
                check_gauss_size(f"M_sph={M_sph!r}: {field}", size)
            return _gauss_theta_phi(N_theta, N_phi)
    return _from_file(M_sph, rule)


def sphere_sizes(rule: str) -> tuple[int, ...]:
    """Sizes M_sph that `sphere_rule` takes for a rule, increasing.

    `gauss-theta-phi`, which takes any pair, has none.

    Raises
    ------
    ValueError
        If `rule` is not known.
    """
    match rule:
        case "design":
            return tuple(DESIGN_DEGREE)
        case "lebedev":
            return tuple(LEBEDEV_DEGREE)
        case "product":
            return PRODUCT_SIZES
        case "gauss-theta-phi":
            return ()
    raise unknown_name("sphere_rule", rule, SPHERE_RULES)


def _equal_weights(points: NDArray[np.float64], degree: int, name: str) -> Rule:
    return Rule(points, np.full(len(points), 4 * np.pi / len(points)), degree, name)


def _lebedev(M_sph: int) -> Rule:
    degree = LEBEDEV_DEGREE[M_sph]
    points, weights = scipy.integrate.lebedev_rule(degree)
    return Rule(points.T, weights, degree, f"lebedev M_sph={M_sph}")


def _product(M_sph: int) -> Rule:
    n = round(np.sqrt(M_sph / 2))
    z, w = np.polynomial.legendre.leggauss(n)
    phi = np.pi * np.arange(2 * n) / n
    weights = np.repeat(w * np.pi / n, 2 * n)
    points = _directions(z, np.sqrt(1 - z**2), phi)
    return Rule(points, weights, 2 * n - 1, f"product M_sph={M_sph}")


def _gauss_theta_phi(N_theta: int, N_phi: int) -> Rule:
    x, w = np.polynomial.legendre.leggauss(N_theta)
    y, v = np.polynomial.legendre.leggauss(N_phi)
    theta, phi = np.pi / 2 * (1 + x), np.pi * (1 + y)
    weights = np.outer(np.pi / 2 * w * np.sin(theta), np.pi * v).ravel()
    points = _directions(np.cos(theta), np.sin(theta), phi)
    return Rule(points, weights, -1, f"gauss-theta-phi {N_theta} x {N_phi}")


def _directions(
    z: NDArray[np.float64], s: NDArray[np.float64], phi: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Points (s cos φ, s sin φ, z) for every pair z = cos θ, s = sin θ and every φ, latitude by latitude."""
    x, y = np.outer(s, np.cos(phi)), np.outer(s, np.sin(phi))
    return np.stack([x, y, np.broadcast_to(z[:, None], x.shape)], axis=-1).reshape(-1, 3)


def _from_file(M_sph: Size, path: str | os.PathLike[str]) -> Rule:
    """Equal-weight rule of the unit vectors in a text file."""
    field = f"sphere_rule={os.fspath(path)!r}"
    if not Path(path).is_file():
        raise unknown_name("sphere_rule", os.fspath(path), (*SPHERE_RULES, "path of a text file"))
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{field}: cannot be read as text: {error}") from error
    rows = [
        _unit_vector(line, f"{field}, line {number}")
        for number, line in enumerate(lines, 1)
        if line.partition("#")[0].strip()
    ]
    if not rows:
        raise ValueError(f"{field}: has no line with a unit vector, three numbers")
    check_direction_count("points", len(rows))
    points = np.array(rows)
    if M_sph is not None and not (is_size(M_sph) and M_sph == len(points)):
        raise ValueError(f"M_sph={M_sph!r}: {field} has {len(points)} points")
    return _equal_weights(points, exact_degree(points), Path(path).name)


def _unit_vector(line: str, place: str) -> tuple[float, ...]:
    """The unit vector on a line of text, before any ``#``. A ValueError names the place of the line."""
    text = line.partition("#")[0].strip()
    shown = text if len(text) <= SHOWN else f"{text[:SHOWN]}..."
    try:
        vector = tuple(map(float, text.split()))
    except ValueError:
        vector = ()
    if len(vector) != 3 or not all(map(math.isfinite, vector)):
        raise ValueError(f"{place}: {shown!r} must be three finite numbers, a unit vector")
    off = math.hypot(*vector) - 1.0
    if abs(off) > UNIT_TOLERANCE:
        raise ValueError(
            f"{place}: {shown!r} has a length off 1 by {abs(off):.1e}; must be a unit vector within "
            f"{UNIT_TOLERANCE:.0e}"
        )
    return vector


def _listed_size(M_sph: Size, rule: str) -> int:
    """M_sph as an int. Raise ValueError, naming the nearest sizes, unless the rule has this size."""
    sizes = sphere_sizes(rule)
    if is_size(M_sph) and M_sph in sizes:
        return int(M_sph)
    shown = ", ".join(map(str, sizes if len(sizes) <= 12 else sizes[:12]))
    shown += ", ..." if len(sizes) > 12 else ""
    message = f"M_sph={M_sph!r}: rule {rule!r} has sizes {shown}"
    if (
        isinstance(M_sph, (int, float, np.integer))
        and not isinstance(M_sph, bool)
        and np.isfinite(M_sph)
    ):
        gap = min(abs(size - M_sph) for size in sizes)
        nearest = [str(size) for size in sizes if abs(size - M_sph) == gap]
        message += f"; nearest {' or '.join(nearest)}"
    raise ValueError(message)


def _pair(M_sph: Size | Sequence[int]) -> tuple[int, int]:
    """M_sph as the pair (N_theta, N_phi). Raise ValueError unless it is one."""
    if isinstance(M_sph, (tuple, list)) and len(M_sph) == 2 and all(map(is_size, M_sph)):
        return int(M_sph[0]), int(M_sph[1])
    raise ValueError(
        f"M_sph={M_sph!r}: rule 'gauss-theta-phi' takes a pair (N_theta, N_phi) of positive "
        "integers, as (6, 8)"
    )
