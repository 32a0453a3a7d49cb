"""The rule on the unit circle."""

import numpy as np

from granstudy.quadrature.rule import Rule, check_direction_count, check_size


def circle_rule(M_cir: int) -> Rule:
    """Uniform angles 2πj/M_cir, j = 0..M_cir−1, with weights 2π/M_cir (docs/method.md §2).

    This is the trapezoidal rule, exact for trigonometric polynomials to degree M_cir − 1. The first that it
    misses is cos(M_cir θ). The first angle is 0 as in the paper, whose digits depend on it. Points
    (M_cir, 2).

    Raises
    ------
    ValueError
        If `M_cir` is not a positive integer, or above 2¹⁶.
    """
    check_size("M_cir", M_cir)
    check_direction_count("M_cir", M_cir)
    theta = 2 * np.pi * np.arange(M_cir) / M_cir
    points = np.column_stack([np.cos(theta), np.sin(theta)])
    weights = np.full(M_cir, 2 * np.pi / M_cir)
    return Rule(points, weights, int(M_cir) - 1, f"circle M_cir={M_cir}")
