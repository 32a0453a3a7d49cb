"""The program that computes the symmetric spherical designs shipped in data/.

    python -m granstudy.quadrature.designs [M_sph ...] [--folder FOLDER] [--starts STARTS]

A spherical design of degree t is a set of M points with (1/M) Σ p(x_i) = (1/4π) ∫ p dω for
every polynomial p of degree at most t, that is, with residual zero: Σ Y_lm(x_i) = 0 for
1 ≤ l ≤ t (Delsarte, Goethals and Seidel 1977). With the points x_i and −x_i every odd l vanishes
by symmetry, so an odd t needs Σ Y_lm(x_i) = 0 over M/2 free points for even l < t only.

1. Start: seeded random points, spread by minimising the Coulomb energy of the whole set.
2. Solve: nonlinear least squares on the sums, with exact Jacobian.
3. Polish: Gauss–Newton steps with residuals in long double precision.
4. Choose: of several starts the solution with the largest smallest angle between two points.
5. Orient and round: the first point is put at the north pole, its nearest neighbour at y = 0.
"""
# ruff: noqa: E741 -- l is the degree of Y_lm in every book

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares, minimize

from granstudy.quadrature.design_data import DESIGN_DEGREE, design_file
from granstudy.quadrature.harmonics import harmonic_gradients, harmonics, residual

__all__ = ["Design", "compute_design", "main", "residual", "smallest_angle", "write_design"]

ROTATION_ORDER = {120: 3}
"""Designs sought among the sets invariant under rotation by 2π/n about z. 120 points at degree 15
leave 117 unknowns for 119 equations; with n = 3 it is 20 orbits of 6, so 39 unknowns (20 free
points less one rotation) for the 39 invariant harmonics."""

STARTS = 64
"""Starting points tried for each size."""

SOLVED = 1e-12
"""Largest residual, before the polish, of a start that has reached a design."""

POLISH_STEPS = 4
"""Gauss–Newton steps; they converge quadratically from 1e-12, so two would do."""

SINGULAR = 1e-9
"""Relative singular value below which a direction (as the three rotations) is left alone."""


@dataclass(frozen=True)
class Design:
    """A computed design: `points` (M_sph, 3), exact to `degree`, reached from `seed`."""

    points: NDArray
    degree: int
    seed: int


def compute_design(M_sph: int, starts: int = STARTS) -> Design:
    """Compute the best separated of the designs reached from `starts` seeds.

    `M_sph` is a size in `DESIGN_DEGREE`. Row i + M_sph/2 of the points is exactly minus row i.

    Raises
    ------
    RuntimeError
        If no start reaches a design.
    """
    degree, order = DESIGN_DEGREE[M_sph], ROTATION_ORDER.get(M_sph, 1)
    found = []
    for seed in range(starts):
        free = solve(spread(M_sph // (2 * order), order, seed), degree, order)
        points = symmetric_set(free, order)
        if residual(points, degree) < SOLVED:
            found.append((round(smallest_angle(points), 6), -seed, points))
    if not found:
        raise RuntimeError(f"M_sph={M_sph}: no design of degree {degree} from {starts} starts")
    _, seed, points = max(found, key=lambda candidate: candidate[:2])
    half = orient(polish(points[: M_sph // 2], degree))
    return Design(np.vstack([half, -half]) + 0.0, degree, -seed)  # + 0.0: no negative zeros


def spread(count: int, order: int, seed: int) -> NDArray:
    """`count` free points whose symmetric set has a (locally) least Coulomb energy."""
    u = np.random.default_rng([seed, count]).normal(size=3 * count)
    options = {"maxiter": 2000, "maxfun": 4000, "ftol": 1e-13, "gtol": 1e-7}
    result = minimize(_energy, u, args=(order,), jac=True, method="L-BFGS-B", options=options)
    return _normalised(result.x)[0]


def solve(start: NDArray, degree: int, order: int) -> NDArray:
    """Free points near `start` at which the sums of the invariant harmonics vanish (if they can).

    Unknowns are vectors u with x = u/|u|, so dY/du = (tangential gradient of Y)/|u|.
    """
    modes = invariant_modes(degree, order)
    if len(modes) == 0:
        return start

    def sums(u: NDArray) -> NDArray:
        return np.mean(harmonics(_normalised(u)[0], modes), axis=1)

    def jacobian(u: NDArray) -> NDArray:
        x, length = _normalised(u)
        return (harmonic_gradients(x, modes) / length).reshape(len(modes), -1) / len(x)

    tolerance = 1e-15
    result = least_squares(
        sums, start.ravel(), jacobian, ftol=tolerance, xtol=tolerance, gtol=tolerance, max_nfev=200
    )
    return _normalised(result.x)[0]


def polish(points: NDArray, degree: int) -> NDArray:
    """Free points (no rotational symmetry assumed) with residual at long double round-off."""
    modes = invariant_modes(degree, 1)
    x = _normalised(points.astype(np.longdouble))[0]
    for _ in range(POLISH_STEPS if len(modes) else 0):
        sums = np.mean(harmonics(x, modes), axis=1)
        jacobian = harmonic_gradients(x, modes).reshape(len(modes), -1) / len(x)
        # the step itself needs few digits: the sums above carry the precision
        step = np.linalg.lstsq(jacobian.astype(float), -sums.astype(float), rcond=SINGULAR)[0]
        x = _normalised(x + step.reshape(x.shape))[0]
    return x


def orient(points: NDArray) -> NDArray:
    """Rotate so that row 0 is (0, 0, 1) and its nearest axis has y = 0, x > 0; turn all to z ≥ 0.

    `points` are the free points of an antipodal set; the result is rounded to double precision.
    """
    pole = points[0]
    nearest = 1 + np.argmax(np.abs(points[1:] @ pole)) if len(points) > 1 else None
    seed = points[nearest] if nearest is not None else np.roll(pole, 1)
    seed = seed * (1 if seed @ pole >= 0 else -1)
    y = np.cross(pole, seed)
    y /= np.sqrt(y @ y)
    rotated = points @ np.stack([np.cross(y, pole), y, pole], axis=1)
    rotated[np.abs(rotated) < np.finfo(float).eps ** 1.1] = 0  # zero but for long double round-off
    rotated *= np.where(rotated[:, 2:] < 0, -1, 1)
    return rotated[np.argsort(-rotated[:, 2], kind="stable")].astype(float)


def invariant_modes(degree: int, order: int) -> NDArray:
    """Modes (l, m) that do not vanish by symmetry: even l < degree, order | m; shape (count, 2)."""
    modes = [(l, m) for l in range(2, degree, 2) for m in range(-l, l + 1) if m % order == 0]
    return np.array(modes, dtype=int).reshape(-1, 2)


def symmetric_set(free: NDArray, order: int) -> NDArray:
    """All images of the free points under the rotations about z, then all their negatives."""
    turned = np.concatenate([free @ rotation.T for rotation in _rotations(order)])
    return np.vstack([turned, -turned])


def smallest_angle(points: NDArray) -> float:
    """Smallest angle between two of the points, in degrees."""
    cosines = points @ points.T
    np.fill_diagonal(cosines, -1.0)
    return float(np.degrees(np.arccos(np.clip(cosines.max(), -1.0, 1.0))))


def write_design(design: Design, folder: Path) -> Path:
    """Write the points with 17 digits and a header that says what they are and how made."""
    M_sph = len(design.points)
    header = (
        f"Symmetric spherical design: {M_sph} points, degree {design.degree}, equal weights.\n"
        f"Unit vectors x y z; row i + {M_sph // 2} is minus row i.\n"
        f"Computed by granstudy.quadrature.designs from seed {design.seed}.\n"
        f"Residual {residual(design.points, design.degree):.1e}, "
        f"smallest angle {smallest_angle(design.points):.4f} degrees."
    )
    path = folder / design_file(M_sph)
    np.savetxt(path, design.points, fmt="%24.17e", header=header)
    return path


def main(arguments: Sequence[str] | None = None) -> None:
    """Compute and write the designs named on the command line, all of them by default."""
    parser = argparse.ArgumentParser(description="Compute the symmetric spherical designs.")
    sizes = list(DESIGN_DEGREE)
    parser.add_argument("M_sph", nargs="*", type=int, help=f"sizes, of {sizes}; default all")
    parser.add_argument("--folder", type=Path, default=Path(__file__).parent / "data")
    parser.add_argument("--starts", type=int, default=STARTS)
    options = parser.parse_args(arguments)
    unknown = [M_sph for M_sph in options.M_sph if M_sph not in sizes]
    if unknown:
        parser.error(f"M_sph={unknown[0]}: sizes are {', '.join(map(str, sizes))}")
    for M_sph in options.M_sph or sizes:
        path = write_design(compute_design(M_sph, options.starts), options.folder)
        print(path.read_text().splitlines()[3].removeprefix("# "), path)


def _energy(u: NDArray, order: int) -> tuple[float, NDArray]:
    """Coulomb energy an orbit, ½ Σ_i Σ_j 1/|x_i − x_j|, and its gradient in u, x = u/|u|.

    i runs over free points, j over the whole set; by symmetry the gradient is the plain force.
    """
    x, length = _normalised(u)
    difference = x[:, None, :] - symmetric_set(x, order)[None, :, :]
    distance = np.sqrt(np.sum(difference**2, axis=-1))
    np.fill_diagonal(distance, np.inf)  # the set starts with the free points themselves
    force = -np.sum(difference / distance[..., None] ** 3, axis=1)
    tangential = force - np.sum(force * x, axis=1, keepdims=True) * x
    return 0.5 * float(np.sum(1 / distance)), (tangential / length).ravel()


def _normalised(u: NDArray) -> tuple[NDArray, NDArray]:
    """Rows of u, shape (n, 3), divided by their lengths; and the lengths, shape (n, 1)."""
    rows = u.reshape(-1, 3)
    length = np.sqrt(np.sum(rows**2, axis=1, keepdims=True))
    return rows / length, length


def _rotations(order: int) -> list[NDArray]:
    """Rotation matrices by 2π j/order about z; the first is the identity."""
    angles = 2 * np.pi * np.arange(order) / order
    return [
        np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) for a in angles
    ]


if __name__ == "__main__":
    main()
