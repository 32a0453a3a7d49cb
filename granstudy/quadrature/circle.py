"""The rule on the circle."""

import numpy as np

from granstudy.quadrature.rule import Rule, check_size


def circle_rule(M_cir: int) -> Rule:
    """Uniform angles 2πj/M_cir, j = 0..M_cir−1, with weights 2π/M_cir (docs/method.md §2).

    Points (M_cir, 2). Exact for trigonometric polynomials to degree M_cir − 1 (the trapezoidal
    rule); cos(M_cir θ) is the first it misses. The placement, from angle 0 on, is the paper's: its
    digits depend on it.

    Raises
    ------
    ValueError
        If `M_cir` is not a positive integer.
    """
    check_size("M_cir", M_cir)
    theta = 2 * np.pi * np.arange(M_cir) / M_cir
    points = np.column_stack([np.cos(theta), np.sin(theta)])
    weights = np.full(M_cir, 2 * np.pi / M_cir)
    return Rule(points, weights, int(M_cir) - 1, f"circle M_cir={M_cir}")
