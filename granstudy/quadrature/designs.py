"""The program that computes the symmetric spherical designs shipped in data/.

    python -m granstudy.quadrature.designs [M_sph ...] [--folder FOLDER] [--starts STARTS]

A spherical design of degree t is a set of M points with (1/M) Σ p(x_i) = (1/4π) ∫ p dω for every polynomial
p of degree at most t. Its residual is zero: Σ Y_lm(x_i) = 0 for 1 ≤ l ≤ t (Delsarte, Goethals and Seidel
1977).

The designs sought are unions of orbits {h x : h ∈ G} of a few free points x. G is a group of signed
permutations of the axes with −1 in it. Sums of odd l vanish by symmetry, so that an odd t leaves the sums
of even l < t. The sums are invariant under G: no more of them are independent than the harmonics of degree
l have invariants of G.

1. Start: seeded random points, spread by minimising the Coulomb energy of the whole set.
2. Solve: nonlinear least squares on the sums, with exact Jacobian.
3. Polish: Gauss–Newton steps with residuals in long double precision.
4. Choose: among the solutions from several starts, the one with the largest smallest angle between points.
5. Orient: where G is {±1}, the first point is put at the north pole and its nearest neighbour at y = 0. A
   larger G is aligned with the axes from the start.
6. Round: the free points are rounded. Their images are then exact, as G permutes and negates coordinates.
"""
# ruff: noqa: E741 -- l is the degree of Y_lm in every book

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import scipy
from numpy.typing import NDArray

from granstudy.quadrature.design_data import DESIGN_DEGREE, design_file
from granstudy.quadrature.harmonics import harmonic_gradients, harmonics, residual
from granstudy.velocity.symmetry import Symmetry, move

STARTS = 64
"""Starting points tried for each size."""

SOLVED = 1e-12
"""Largest residual, before the polish, of a solution that counts as a design."""

POLISH_STEPS = 4
"""Gauss–Newton steps. They converge quadratically from 1e-12, so that two would do."""

SINGULAR = 1e-9
"""Relative singular value below which a direction is left alone, such as a rotation that G allows."""

COINCIDENT = 1e-9
"""Distance below which two images count as the same point."""


@dataclass(frozen=True)
class Orbits:
    """The orbits of free points under a group G, of which a set of points is made.

    Attributes
    ----------
    generators : tuple of str
        Coordinate triplets that generate G together with −1.
    in_plane : int
        How many of the free points, the first ones, lie in the plane z = 0. The plane must be a mirror
        plane of G; the orbits of its points have half the size.
    """

    generators: tuple[str, ...] = ()
    in_plane: int = 0

    @cached_property
    def group(self) -> NDArray:
        """Matrices of the rotations in G, shape (|G|/2, 3, 3). G consists of these and their negatives."""
        elements = Symmetry.generated(3, "-x,-y,-z", *self.generators).elements
        matrices = np.array([move(h, np.eye(3)).T for h in sorted(elements)])
        return matrices[np.linalg.det(matrices) > 0]

    def free_count(self, M_sph: int) -> int:
        """Number of free points of a set of M_sph points."""
        return (M_sph // len(self.group) + self.in_plane) // 2

    def points(self, u: NDArray) -> tuple[NDArray, NDArray]:
        """Free points x = u/|u|, shape (n, 3), of any vectors u, and the lengths |u|, shape (n, 1)."""
        rows = np.array(u).reshape(-1, 3)
        rows[: self.in_plane, 2] = 0
        length = np.sqrt(np.sum(rows**2, axis=1, keepdims=True))
        return rows / length, length

    def shares(self, count: int) -> NDArray:
        """Sizes of the free points' orbits over |G|, shape (count,)."""
        return np.where(np.arange(count) < self.in_plane, 0.5, 1.0)

    def images(self, free: NDArray) -> NDArray:
        """Images h x of every free point x under every rotation h in G, shape (|G|/2, n, 3)."""
        return np.array([free @ h.T for h in self.group])

    def all_points(self, free: NDArray) -> NDArray:
        """The whole set without −0.0: points from the pole to z = 0, then their negatives."""
        half = self.images(free).reshape(-1, 3)
        points = np.unique(np.concatenate([half, -half]) + 0.0, axis=0)
        x, y, z = points.T
        upper = points[(z > 0) | (z == 0) & ((y > 0) | (y == 0) & (x > 0))]
        upper = upper[np.argsort(-upper[:, 2], kind="stable")]
        return np.concatenate([upper, -upper]) + 0.0


ORBITS = {
    32: Orbits(("-y,x,z",), in_plane=2),
    48: Orbits(("y,z,x",)),
    120: Orbits(("y,z,x",)),
    156: Orbits(("y,z,x",)),
    192: Orbits(("y,z,x",)),
}
"""Orbits of the set of each size. For other sizes the group is {±1}.

The unknowns must be as many as the independent sums. A free point has two, a point in the plane one, less
one where rotations about an axis of G keep the set.

    points    degree    unknowns = independent sums
    32        7         7
    120       15        39 (without symmetry 117 unknowns for 119 sums)
    192       19        63

Sizes of remainder 4 modulo 6, such as 70 and 94, exclude the axis (1,1,1), and the other groups leave them
too few unknowns. The designs of 6 and 12 points are octahedron and icosahedron. `orient` places them as the
paper does, whose digits depend on it.
"""


@dataclass(frozen=True)
class Design:
    """A computed design: ``points`` (M_sph, 3), exact to ``degree``, reached from ``seed``."""

    points: NDArray
    degree: int
    seed: int


def compute_design(M_sph: int, starts: int = STARTS) -> Design:
    """The design of a size in `DESIGN_DEGREE`: the best separated one reached from ``starts`` seeds.

    Row i + M_sph/2 of the points is exactly minus row i.

    Raises
    ------
    RuntimeError
        If no start reaches a design.
    """
    degree, orbits = DESIGN_DEGREE[M_sph], ORBITS.get(M_sph, Orbits())
    found = []
    for seed in range(starts):
        free = solve(spread(orbits.free_count(M_sph), orbits, seed), degree, orbits)
        points = orbits.all_points(free)
        if len(points) == M_sph and residual(points, degree) < SOLVED:
            found.append((round(smallest_angle(points), 6), -seed, free))
    if not found:
        raise RuntimeError(f"M_sph={M_sph}: no design of degree {degree} from {starts} starts")
    _, seed, free = max(found, key=lambda candidate: candidate[:2])
    free = polish(free, degree, orbits)
    if len(orbits.group) == 1:
        free = orient(free)
    return Design(orbits.all_points(free.astype(float)), degree, -seed)


def spread(count: int, orbits: Orbits, seed: int) -> NDArray:
    """``count`` free points whose orbits have a locally least Coulomb energy."""
    u = np.random.default_rng([seed, count]).normal(size=3 * count)
    options = {"maxiter": 2000, "maxfun": 4000, "ftol": 1e-13, "gtol": 1e-7}
    result = scipy.optimize.minimize(
        _energy, u, args=(orbits,), jac=True, method="L-BFGS-B", options=options
    )
    return orbits.points(result.x)[0]


def solve(start: NDArray, degree: int, orbits: Orbits) -> NDArray:
    """Free points near ``start`` at which the sums of all harmonics vanish, as far as they can.

    The unknowns are vectors u with x = u/|u|, so that dY/du = (tangential gradient of Y)/|u|.
    """
    modes = even_modes(degree)
    if len(modes) == 0:
        return start

    def sums(u: NDArray) -> NDArray:
        return means(orbits.points(u)[0], modes, orbits)

    def jacobian(u: NDArray) -> NDArray:
        x, length = orbits.points(u)
        return (mean_gradients(x, modes, orbits) / length).reshape(len(modes), -1)

    tolerance = 1e-15
    result = scipy.optimize.least_squares(
        sums, start.ravel(), jacobian, ftol=tolerance, xtol=tolerance, gtol=tolerance, max_nfev=200
    )
    return orbits.points(result.x)[0]


def polish(free: NDArray, degree: int, orbits: Orbits) -> NDArray:
    """Free points whose residual is at the round-off of long double."""
    modes = even_modes(degree)
    x = orbits.points(free.astype(np.longdouble))[0]
    for _ in range(POLISH_STEPS if len(modes) else 0):
        sums = means(x, modes, orbits)
        jacobian = mean_gradients(x, modes, orbits).reshape(len(modes), -1)
        # The step needs few digits, as the sums above carry the precision.
        step = np.linalg.lstsq(jacobian.astype(float), -sums.astype(float), rcond=SINGULAR)[0]
        x = orbits.points(x + step.reshape(x.shape))[0]
    return x


def orient(free: NDArray) -> NDArray:
    """Rotate so that row 0 is (0, 0, 1) and its nearest axis has y = 0, x > 0.

    ``free`` holds one point of each pair of an antipodal set.
    """
    pole = free[0]
    nearest = 1 + np.argmax(np.abs(free[1:] @ pole)) if len(free) > 1 else None
    seed = free[nearest] if nearest is not None else np.roll(pole, 1)
    seed = seed * (1 if seed @ pole >= 0 else -1)
    y = np.cross(pole, seed)
    y /= np.sqrt(y @ y)
    rotated = free @ np.stack([np.cross(y, pole), y, pole], axis=1)
    rotated[np.abs(rotated) < np.finfo(float).eps ** 1.1] = 0  # the round-off of long double
    return rotated


def even_modes(degree: int) -> NDArray:
    """Modes (l, m) with even l < degree, which antipodes do not cancel; shape (count, 2)."""
    modes = [(l, m) for l in range(2, degree, 2) for m in range(-l, l + 1)]
    return np.array(modes, dtype=int).reshape(-1, 2)


def means(free: NDArray, modes: NDArray, orbits: Orbits) -> NDArray:
    """Mean of every Y_lm, l even, over the whole set; shape (modes,)."""
    shares = orbits.shares(len(free))
    images = [np.mean(harmonics(x, modes) * shares, axis=1) for x in orbits.images(free)]
    return np.mean(images, axis=0) / np.mean(shares)


def mean_gradients(free: NDArray, modes: NDArray, orbits: Orbits) -> NDArray:
    """Tangential gradients of `means` in the free points, shape (modes, n, 3).

    The gradient of Y(h x) in x is hᵀ(∇Y)(h x).
    """
    turned = zip(orbits.images(free), orbits.group, strict=True)
    gradients = np.mean([harmonic_gradients(x, modes) @ h for x, h in turned], axis=0)
    shares = orbits.shares(len(free))
    return gradients * (shares / np.sum(shares))[:, None]


def smallest_angle(points: NDArray) -> float:
    """Smallest angle between two of the points, in degrees."""
    cosines = points @ points.T
    np.fill_diagonal(cosines, -1.0)
    return float(np.degrees(np.arccos(np.clip(cosines.max(), -1.0, 1.0))))


def write_design(design: Design, folder: Path) -> Path:
    """Write the points with 17 digits, below a header that says what they are and how they were made."""
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
    """Compute and write the designs that the command line names, by default all."""
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


def _energy(u: NDArray, orbits: Orbits) -> tuple[float, NDArray]:
    """Coulomb energy over |G|, ½ Σ_i Σ_j q_i q_j/|x_i − x_j|, and its gradient in u, x = u/|u|.

    i runs over free points, j over their images under G. q are the orbits' shares, as a point in the plane
    is met twice among its images. By symmetry the gradient is the plain force.
    """
    x, length = orbits.points(u)
    q = orbits.shares(len(x))
    images = orbits.images(x)
    others = np.concatenate([images, -images]).reshape(-1, 3)
    difference = x[:, None, :] - others[None, :, :]
    distance = np.sqrt(np.sum(difference**2, axis=-1))
    distance[distance < COINCIDENT] = np.inf  # the point itself
    charges = q[:, None] * np.tile(q, 2 * len(orbits.group))
    force = -np.sum(charges[..., None] * difference / distance[..., None] ** 3, axis=1)
    tangential = force - np.sum(force * x, axis=1, keepdims=True) * x
    return 0.5 * float(np.sum(charges / distance)), (tangential / length).ravel()


if __name__ == "__main__":
    main()
