"""The filters that the Carleman form multiplies f̂ by, and the modes that they act on."""

from dataclasses import dataclass

import numpy as np

from granstudy.collision.carleman.weights import Product, mirrored
from granstudy.collision.rules import directions
from granstudy.model.scene import Scene
from granstudy.model.solver import Solver
from granstudy.quadrature import Rule, half
from granstudy.velocity.cartesian import VelocityGrid


def ball_modes(grid: VelocityGrid) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumbers (n, d) with |l| < N/2 of the half spectrum, and how many each row (N, N') begins with."""
    k = grid.wavenumbers
    axes = [k] * (grid.dim - 1) + [k[: grid.N // 2 + 1]]
    inside = grid.wavenumber_squared(half=True) < (grid.N // 2) ** 2
    modes = np.stack([a[inside] for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    return modes, inside.sum(axis=-1).reshape(grid.N, -1)


def half_rule(scene: Scene, solver: Solver) -> Rule:
    """One of each pair ±e; at e = 1 in 2D one of each four where the rule has right angles.

    There x and y, and with them l and m, play the same part, so that e⊥ gives what e gives.
    """
    pairs = half(directions(scene, solver))
    if scene.dim == 2 and scene.restitution == 1.0 and solver.M_cir % 4 == 0:
        quarter = slice(solver.M_cir // 4)
        return Rule(pairs.points[quarter], 2 * pairs.weights[quarter], pairs.degree, pairs.name)
    return pairs


@dataclass(frozen=True)
class Filters:
    """The filters of l and m on the ball's modes, a row a direction and product, and the loss weight.

    A real odd function of l·e times f̂ is the spectrum of i times a real density. ``odd`` tells where both
    filters are odd; they take factors −i and i, which leaves their product as it is.
    """

    of_l: np.ndarray
    of_m: np.ndarray
    odd: np.ndarray
    loss: np.ndarray


def tabulate(terms: list[Product], rule: Rule, modes: np.ndarray) -> Filters:
    """w_e u_j(l·e), p_j(m·e) q(|m⊥|) and G⁻(m) = G⁺(−m,m) with this rule, which conserves mass.

    ``modes`` (n, d) are l and m in units of 1/velocity.
    """
    shape = (len(rule), len(terms), len(modes))
    of_l, of_m = np.empty(shape), np.empty(shape)
    loss = np.zeros(len(modes))
    square = np.square(modes).sum(axis=1)
    # ∫_{−r}^{r} dρ has both of ±e: the integral is over half a sphere
    for i, (e, w) in enumerate(zip(rule.points, rule.weights / 2, strict=True)):
        along = modes @ e
        beside = np.sqrt(np.maximum(square - along**2, 0.0))
        along, sign = np.abs(along), np.sign(along)
        for j, term in enumerate(terms):
            parity = sign if term.odd else 1.0
            of_l[i, j] = w * parity * term.of_l(along)
            of_m[i, j] = parity * term.of_m(along) * term.across(beside)
            loss += w * mirrored(term, along, beside)
    odd = np.tile([term.odd for term in terms], len(rule))
    return Filters(of_l.reshape(-1, len(modes)), of_m.reshape(-1, len(modes)), odd, loss)
