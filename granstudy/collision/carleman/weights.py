"""Weights of the Carleman form as sums of products, a function of l by one of m (docs/method.md §8).

With g = x + y, x = ½(g − |g|σ) ⊥ y = ½(g + |g|σ), the collision rule is v' = v − 2αx, v*' = v* + 2αx, and

    ∫∫ B F dσ dg = ∫∫ B̃ δ(x·y) F dx dy,   B̃ = 2^{d−1} C_λ |g|^{λ+2−d},  |g|² = |x|² + |y|²

(Carleman's coordinates, as in Mouhot & Pareschi, Math. Comp. 75, 1833 (2006)). The truncation is |x|,
|y| < r in place of |g| < R. With x = ρe, 2α = 1 − 2β and β = (1−e)/4, the gain weight of docs/method.md §2
becomes

    G⁺(l,m) = ½∫ de K(2α l·e − 2β m·e, |m⊥|),   m⊥ = m − (m·e)e,   l, m in units π/L
    K(a,q)  = ∫_{−r}^{r} dρ |ρ|^{d−2} e^{iρa} ∫_{|y|<r, y⊥e} B̃ e^{iq·y} dy

Here the e of x = ρe, de, l·e and m·e is a unit vector, the e of (1−e)/4 the restitution. The weight is a
sum of products in three cases. The first is that of Mouhot & Pareschi, the others are **beyond** the paper:

    B̃               e        products
    constant        1        one: K(a,q) = B̃ φ(a) ψ(q)
    constant        below 1  few where β is small, as φ(2αa − 2βb) then has a small numerical rank
    not constant    1        few, as K has a small numerical rank

B̃ is constant for hard spheres in 3D and for Maxwell molecules in 2D.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy
from scipy.special import j0, j1

from granstudy.collision.carleman.scenes import is_separable, reach
from granstudy.collision.weights import alpha
from granstudy.model.kernel import VHS
from granstudy.quadrature import radial_rule
from granstudy.velocity.cartesian import VelocityGrid

TOLERANCE = 1e-6
"""Error of a truncated sum of products, relative to the largest weight, where f̂ is not small."""

EDGE = 1e-3
"""Assumed size of a density's spectrum at the edge of the ball, relative to its largest value. Errors of
the weight count by a Gaussian in |l| and |m| that falls as far. On smooth densities Q is then within 3e-5
of the Q of untruncated sums."""

Function = Callable[[np.ndarray], np.ndarray]
"""One factor of a product, evaluated on an array of arguments ≥ 0."""


@dataclass(frozen=True)
class Product:
    """One term ``of_l(l·e) · of_m(m·e) · across(|m⊥|)`` of the gain weight.

    The functions are given for arguments ≥ 0. ``odd`` says whether ``of_l`` and ``of_m`` are odd or even.
    """

    of_l: Function
    of_m: Function
    across: Function
    odd: bool = False


def normal(dim: int, r: float, a: np.ndarray) -> np.ndarray:
    """φ(a) = ∫_{−r}^{r} |ρ|^{d−2} e^{iρa} dρ."""
    if dim == 2:
        return 2.0 * r * np.sinc(r * a / np.pi)
    # 2r sin(ra)/a − 2(1 − cos ra)/a²
    return r**2 * (2.0 * np.sinc(r * a / np.pi) - np.sinc(r * a / (2.0 * np.pi)) ** 2)


def tangent(dim: int, r: float, q: np.ndarray) -> np.ndarray:
    """ψ(q) = ∫_{|y|<r} e^{iq·y} dy over the line (2D) or the plane (3D) across e."""
    if dim == 2:
        return 2.0 * r * np.sinc(r * q / np.pi)
    x = np.where(q == 0.0, 1.0, r * q)
    return 2.0 * np.pi * r**2 * np.where(q == 0.0, 0.5, j1(x) / x)


def strength(kernel: VHS, dim: int) -> float:
    """2^{d−1} C_λ, the factor of B̃ before its power of |g|."""
    return float(2.0 ** (dim - 1) * kernel.strength)


def kernel_weight(kernel: VHS, dim: int, r: float, a: np.ndarray, q: np.ndarray) -> np.ndarray:
    """K(a,q) for every pair of ``a`` (n,) and ``q`` (m,), exact to round-off.

    In polar coordinates |x| = g cos θ, |y| = g sin θ the domain is two triangles, g < r/cos θ and
    g < r/sin θ. The integrand there is g^{d−1+λ} times a smooth even function of g.
    """
    count = 24 + int(0.5 * r * max(np.max(a), np.max(q)))
    theta, w_theta = np.polynomial.legendre.leggauss(count)
    theta, w_theta = np.pi / 8 * (theta + 1), np.pi / 8 * w_theta
    radial = radial_rule(count, 1.0, "jacobi", dim - 1 + kernel.exponent)
    # The larger and the smaller of |x| and |y| at the nodes of one triangle.
    larger = r * np.broadcast_to(radial.points[:, None], (count, count)).ravel()
    smaller = (r * radial.points[:, None] * np.tan(theta)).ravel()
    g = (r * radial.points[:, None] / np.cos(theta)).ravel()
    # dx dy = g dg dθ with dg = r ds/cos θ, s the radial rule's variable on [0, 1].
    measure = np.outer(radial.weights, w_theta * r / np.cos(theta)).ravel() * g
    measure *= strength(kernel, dim) * g ** (kernel.exponent + 2 - dim)
    total = np.zeros((len(a), len(q)))
    for x, y in ((larger, smaller), (smaller, larger)):
        if dim == 2:
            of_x, of_y = 2.0 * np.cos(np.outer(a, x)), 2.0 * np.cos(np.outer(q, y))
        else:
            of_x, of_y = 2.0 * x * np.cos(np.outer(a, x)), 2.0 * np.pi * y * j0(np.outer(q, y))
        total += (of_x * measure) @ of_y.T
    return total


def products(kernel: VHS, e: float, grid: VelocityGrid, largest: float) -> list[Product]:
    """The gain weight as a sum of products, for |l|, |m| ≤ ``largest`` in units of 1/velocity.

    Where B̃ is constant and e = 1 there is one product. Elsewhere `TOLERANCE` decides how many.
    """
    dim, r = grid.dim, reach(grid)
    if not is_separable(kernel, dim):
        pairs = sum_of_products(lambda a, q: kernel_weight(kernel, dim, r, a, q), largest, r)
        return [Product(of_l, np.ones_like, across) for of_l, across in pairs]

    def across(q: np.ndarray) -> np.ndarray:
        return tangent(dim, r, q)

    B = strength(kernel, dim)
    if e == 1.0:
        return [Product(lambda a: B * normal(dim, r, a), np.ones_like, across)]

    two_alpha = 2.0 * float(alpha(e))
    terms = []
    for odd in (False, True):

        def weight(a: np.ndarray, b: np.ndarray, sign: int = -1 if odd else 1) -> np.ndarray:
            """Part of B̃ φ(2αa − 2βb) that is even, or odd, in both a and b."""
            a, b = two_alpha * a[:, None], (1.0 - two_alpha) * b
            return 0.5 * B * (normal(dim, r, a - b) + sign * normal(dim, r, a + b))

        scale = B * float(normal(dim, r, np.zeros(1))[0])
        pairs = sum_of_products(weight, largest, r, scale)
        terms += [Product(of_l, of_m, across, odd) for of_l, of_m in pairs]
    return terms


def sum_of_products(
    weight: Callable[[np.ndarray, np.ndarray], np.ndarray],
    largest: float,
    bandwidth: float,
    scale: float | None = None,
) -> list[tuple[Function, Function]]:
    """Fewest u_j, v_j with s(a)s(b)|weight(a,b) − Σ_j u_j(a) v_j(b)| ≤ TOLERANCE · scale on [0, largest]².

    s is the Gaussian of `EDGE`. The functions are singular functions of the weight on Gauss–Legendre nodes,
    continued between the nodes by u_j = weight·v_j/σ_j (Nyström).

    Parameters
    ----------
    weight : callable
        Matrix (n, m) of the weight at arguments a (n,) and b (m,).
    bandwidth : float
        Largest frequency of the weight in either argument.
    scale : float, optional
        The largest weight, by default the weight at the origin.
    """
    x, w = np.polynomial.legendre.leggauss(24 + int(bandwidth * largest))
    x, w = largest * (x + 1) / 2, largest * w / 2
    root = np.sqrt(w) * EDGE ** ((x / largest) ** 2)
    left, sigma, right = np.linalg.svd(root[:, None] * weight(x, x) * root)
    if scale is None:
        scale = float(weight(np.zeros(1), np.zeros(1))[0, 0])
    # The rest of the weight after each product, summed from the last product back.
    pieces = sigma[:, None, None] * left.T[:, :, None] * right[:, None, :]
    rest = np.cumsum(pieces[::-1], axis=0)[::-1] / np.sqrt(np.outer(w, w))
    rank = int(np.count_nonzero(np.max(np.abs(rest), axis=(1, 2)) > TOLERANCE * scale))
    fine = np.linspace(0.0, largest, 32 + int(20 * bandwidth * largest))
    share = np.sqrt(sigma[:rank])
    u = weight(fine, x) @ (root[:, None] * right[:rank].T / share)
    v = weight(x, fine).T @ (root[:, None] * left[:, :rank] / share)
    return [(_spline(fine, u[:, j]), _spline(fine, v[:, j])) for j in range(rank)]


def _spline(points: np.ndarray, values: np.ndarray) -> "scipy.interpolate.BSpline":
    return scipy.interpolate.make_interp_spline(points, values, k=5)


def loss_profile(terms: list[Product], grid: VelocityGrid, m: np.ndarray) -> np.ndarray:
    """G⁻(m) = G⁺(−m, m) at magnitudes ``m``, the integral over directions e exact to round-off."""
    nodes = 24 + int(reach(grid) * np.max(m))
    if grid.dim == 2:
        mu, w = (
            np.cos(np.pi * (np.arange(nodes) + 0.5) / (2 * nodes)),
            np.full(nodes, np.pi / nodes),
        )
    else:
        x, w = np.polynomial.legendre.leggauss(nodes)
        mu, w = (x + 1) / 2, np.pi * w
    along, beside = np.outer(m, mu), np.outer(m, np.sqrt(1.0 - mu**2))
    return np.asarray(sum(mirrored(term, along, beside) for term in terms) @ w)


def mirrored(term: Product, along: np.ndarray, beside: np.ndarray) -> np.ndarray:
    """The term at l = −m, with m·e = ``along`` and |m⊥| = ``beside``."""
    value = term.of_l(along) * term.of_m(along) * term.across(beside)
    return -value if term.odd else value
