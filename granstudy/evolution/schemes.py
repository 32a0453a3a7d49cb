"""Runge–Kutta schemes: one step, and an estimate of its error from a lower order (docs/method.md §3)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import factorial
from typing import NamedTuple, Protocol

import numpy as np

from granstudy.velocity.space import Term

DOPRI_STAGES = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
"""Weights of the stages of J. Dormand & P. Prince, J. Comput. Appl. Math. 6, 19 (1980). The last stage is the
solution."""

DOPRI_ERROR = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
"""Weights of the difference between the solutions of fifth and of fourth order, same source."""

DOPRI_INTERPOLANT = (
    -12715105075 / 11282082432,
    0.0,
    87487479700 / 32700410799,
    -10690763975 / 1880347072,
    701980252875 / 199316789632,
    -1453857185 / 822651844,
    69997945 / 29380423,
)
"""Weights of the interpolant of fourth order beside the cubic polynomial by the step's ends: E. Hairer,
S. Nørsett & G. Wanner, Solving Ordinary Differential Equations I, §II.6, as in their code DOPRI5."""

Rate = Callable[[np.ndarray], np.ndarray]
"""y ↦ y'."""


class Equation(Protocol):
    """y' = rate(y); κ(y) Δy is a part of the rate."""

    def rate(self, y: np.ndarray, taken_off: float = 0.0) -> np.ndarray:
        """The rate of change, less ``taken_off`` Δy."""

    def diffusivity(self, y: np.ndarray) -> float:
        """κ(y) ≥ 0."""

    def laplacian_functions(self, x: float, terms: list[Term]) -> np.ndarray:
        """Σ φ(xΔ) y over the ``terms`` (φ, y)."""


class Step(NamedTuple):
    """Result of one step of a scheme.

    Attributes
    ----------
    state : ndarray
    difference : ndarray
        Difference from a scheme of lower order.
    twins : tuple of ndarray, or None
        Difference of the last two states whose rates are computed, both for the end of the step; and the
        difference of these rates. None where the scheme has no such two.
    last : ndarray or None
        Rate at the state, with which the next step begins; None where the scheme has it not.
    inside : callable or None
        Part of the step, from 0 to 1 ↦ state there; None where the scheme has no interpolant.
    """

    state: np.ndarray
    difference: np.ndarray
    twins: tuple[np.ndarray, np.ndarray] | None = None
    last: np.ndarray | None = None
    inside: Callable[[float], np.ndarray] | None = None


@dataclass(frozen=True)
class Scheme:
    """A one-step scheme.

    Attributes
    ----------
    first : callable
        (equation, y) ↦ the rate with which every step from y begins.
    step : callable
        (equation, y, h, first) ↦ `Step`.
    evaluations : int
        Rates in a step, the first one included.
    error_order : int
        Order q of the lower scheme, one below the scheme's own: the difference D is O(h^{q+1}), the error of
        the step O(h^{q+2}).
    difference, remainder : float
        D/z^{q+1}, and the error over z^{q+2}, of a step of y' = (z/h) y, z small.
    real_limit, imaginary_limit : float
        Largest h|z| for which y' = z y stays bounded, for z < 0 and for imaginary z.
    exact_diffusion : bool
        Whether diffusion is exact, so that it does not limit h.
    interpolation_error : float
        Error of the interpolant over D, the largest of its terms of order 5; 0 where the scheme has none.
    """

    first: Callable[[Equation, np.ndarray], np.ndarray]
    step: Callable[[Equation, np.ndarray, float, np.ndarray], Step]
    evaluations: int
    error_order: int
    difference: float
    remainder: float
    real_limit: float
    imaginary_limit: float
    exact_diffusion: bool
    interpolation_error: float = 0.0

    def error(self, size: float) -> float:
        """Error of a step over D, where D has a relative size.

        It is that of y' = (z/h) y, with the z whose D has this size.
        """
        z = (size / self.difference) ** (1.0 / (self.error_order + 1))
        return float(z * self.remainder / self.difference)


def rk3_step(rate: Rate, y: np.ndarray, h: float, first: np.ndarray) -> Step:
    """One step of Kutta's third-order scheme (paper eq. 48); the lower scheme is the midpoint rule."""
    k1 = first
    k2 = rate(y + h / 2 * k1)
    k3 = rate(y - h * k1 + 2 * h * k2)
    return Step(y + h / 6 * (k1 + 4 * k2 + k3), h / 6 * (k1 - 2 * k2 + k3))


def dopri54_step(rate: Rate, y: np.ndarray, h: float, first: np.ndarray) -> Step:
    """One step of Dormand and Prince's pair of orders 5 and 4; its last rate begins the next step."""
    rates, new = [first], y
    for weights in DOPRI_STAGES:
        before, new = new, y + h * sum(w * k for w, k in zip(weights, rates, strict=True) if w)
        rates.append(rate(new))

    def weighted(weights: Sequence[float] | np.ndarray) -> np.ndarray:
        return np.asarray(h * sum(w * k for w, k in zip(weights, rates, strict=True) if w))

    def inside(theta: float) -> np.ndarray:
        return y + weighted(dopri54_weights(theta))

    twins = new - before, rates[-1] - rates[-2]
    return Step(new, weighted(DOPRI_ERROR), twins, rates[-1], inside)


def dopri54_weights(theta: float) -> np.ndarray:
    """Weights of the rates in the interpolant of `dopri54_step` at a part of the step, shape (7,)."""
    first, last = np.eye(7)[[0, -1]]
    whole = np.array([*DOPRI_STAGES[-1], 0.0])
    bubble = 2.0 * whole - first - last + (1.0 - theta) * np.array(DOPRI_INTERPOLANT)
    return theta * (whole + (1.0 - theta) * (first - whole + theta * bubble))


def exponential_step(equation: Equation, y: np.ndarray, h: float, n1: np.ndarray) -> Step:
    """One step of Kutta's scheme with the diffusion κ(y)Δ exact: order 3, whatever the size of hκΔ.

    The scheme is ETD3RK of S. Cox & P. Matthews, J. Comput. Phys. 176, 430 (2002), eqs. 23 to 25, with the κ
    of the start of the step; a change of κ belongs to n, the rest of the rate. The lower scheme is the
    exponential midpoint rule.
    """
    kappa = equation.diffusivity(y)
    x = h * kappa

    def linear(x: float, *terms: Term) -> np.ndarray:
        return equation.laplacian_functions(x, list(terms))

    n2 = equation.rate(linear(x / 2, (np.exp, y), (phi(1), h / 2 * n1)), kappa)
    n3 = equation.rate(linear(x, (np.exp, y), (phi(1), h * (2 * n2 - n1))), kappa)
    new = linear(
        x,
        (np.exp, y),
        (lambda z: phi(1)(z) - 3 * phi(2)(z) + 4 * phi(3)(z), h * n1),
        (lambda z: 4 * phi(2)(z) - 8 * phi(3)(z), h * n2),
        (lambda z: 4 * phi(3)(z) - phi(2)(z), h * n3),
    )
    lower = linear(x, (np.exp, y), (phi(1), h * n1), (phi(2), 2 * h * (n2 - n1)))
    return Step(new, new - lower)


def phi(k: int) -> Callable[[np.ndarray], np.ndarray]:
    """φ_k of exponential schemes for z ≤ 0: φ_0 = e^z, φ_k(z) = (φ_{k−1}(z) − 1/(k−1)!)/z."""

    def function(z: np.ndarray) -> np.ndarray:
        z = np.asarray(z, dtype=float)
        far = np.minimum(z, -1.0)
        value = np.exp(far)
        for j in range(k):
            value = (value - 1 / factorial(j)) / far
        # Near 0 the differences cancel: the series Σ z^j/(j+k)!, exact to round-off on |z| ≤ 1.
        near = np.maximum(z, -1.0)
        series = np.zeros_like(z)
        for j in reversed(range(18)):
            series = series * near + 1 / factorial(j + k)
        return np.where(z < -1.0, value, series)

    return function


def explicit(
    step: Callable[[Rate, np.ndarray, float, np.ndarray], Step],
    *,
    evaluations: int,
    error_order: int,
    difference: float,
    remainder: float,
    real_limit: float,
    imaginary_limit: float,
    interpolation_error: float = 0.0,
) -> Scheme:
    """A scheme of rates alone, diffusion included; ``step`` is (rate, y, h, first) ↦ `Step`."""
    return Scheme(
        first=lambda equation, y: equation.rate(y),
        step=lambda equation, y, h, first: step(equation.rate, y, h, first),
        evaluations=evaluations,
        error_order=error_order,
        difference=difference,
        remainder=remainder,
        real_limit=real_limit,
        imaginary_limit=imaginary_limit,
        exact_diffusion=False,
        interpolation_error=interpolation_error,
    )


SCHEMES = {
    "rk3": explicit(
        rk3_step,
        evaluations=3,
        error_order=2,
        difference=1 / 6,
        remainder=1 / 24,
        real_limit=2.5127,
        imaginary_limit=1.7320,
    ),
    "dopri54": explicit(
        dopri54_step,
        evaluations=7,
        error_order=4,
        difference=97 / 120000,
        remainder=1 / 3600,
        real_limit=3.3065,
        imaginary_limit=0.9971,
        interpolation_error=7.87,
    ),
    "exponential": Scheme(
        first=lambda equation, y: equation.rate(y, equation.diffusivity(y)),
        step=exponential_step,
        evaluations=3,
        error_order=2,
        difference=1 / 6,
        remainder=1 / 24,
        real_limit=2.5127,
        imaginary_limit=1.7320,
        exact_diffusion=True,
    ),
}
"""The schemes by name: the paper's, a pair of higher order, and the paper's with exact diffusion."""
