"""Filters of the Carleman form: functions of the modes by which f̂ is multiplied (docs/method.md §8)."""

from dataclasses import dataclass

import numpy as np

from granstudy.collision.carleman.weights import Product, mirrored
from granstudy.collision.rules import directions
from granstudy.model.scene import Scene
from granstudy.model.solver import SizedSolver
from granstudy.quadrature import Rule, half
from granstudy.velocity.cartesian import VelocityGrid


def ball_modes(grid: VelocityGrid) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumbers |l| < N/2 of the half spectrum, shape (n, d), and how many each row has, shape (N, N').

    A row's modes in the ball are its first ones.
    """
    k = grid.wavenumbers
    axes = [k] * (grid.dim - 1) + [k[: grid.N // 2 + 1]]
    inside = grid.wavenumber_squared(half=True) < (grid.N // 2) ** 2
    modes = np.stack([a[inside] for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    return modes, inside.sum(axis=-1).reshape(grid.N, -1)


def half_rule(scene: Scene, solver: SizedSolver) -> Rule:
    """One direction of each pair ±e, with the weight of both.

    At e = 1 in 2D, a rule with right angles is reduced to one direction of four: l and m then play the same
    part, so that the direction across e gives the same as e.
    """
    pairs = half(directions(scene, solver))
    if scene.dim == 2 and scene.restitution == 1.0 and solver.M_cir % 4 == 0:
        quarter = slice(solver.M_cir // 4)
        return Rule(pairs.points[quarter], 2 * pairs.weights[quarter], pairs.degree, pairs.name)
    return pairs


@dataclass(frozen=True)
class Filters:
    """Filters of l and of m on the ball's modes, a row for each direction and product, and the loss weight.

    An odd real filter times f̂ is the spectrum of i times a real density. Two odd filters therefore take the
    factors −i and i, which leave their product as it is.

    Attributes
    ----------
    of_l, of_m : ndarray, shape (rows, modes)
    odd : ndarray of bool, shape (rows,)
        Whether both filters of the row are odd.
    loss : ndarray, shape (modes,)
    """

    of_l: np.ndarray
    of_m: np.ndarray
    odd: np.ndarray
    loss: np.ndarray


def tabulate(terms: list[Product], rule: Rule, modes: np.ndarray) -> Filters:
    """Filters w_e u_j(l·e) and p_j(m·e) q_j(|m⊥|), and the loss weight G⁻(m) = G⁺(−m,m) with the same rule.

    Parameters
    ----------
    modes : ndarray, shape (n, d)
        l and m in units of 1/velocity.
    """
    shape = (len(rule), len(terms), len(modes))
    of_l, of_m = np.empty(shape), np.empty(shape)
    loss = np.zeros(len(modes))
    square = np.square(modes).sum(axis=1)
    # ∫_{−r}^{r} dρ counts both of ±e, so that the integral over e is over half a sphere.
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
