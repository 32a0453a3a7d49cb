"""Quadrature rules on the radius, the circle and the sphere."""

from granstudy.quadrature.circle import circle_rule
from granstudy.quadrature.harmonics import exact_degree, residual
from granstudy.quadrature.radial import radial_rule
from granstudy.quadrature.rule import Rule, half, symmetrise
from granstudy.quadrature.sphere import sphere_rule, sphere_sizes

__all__ = [
    "Rule",
    "circle_rule",
    "exact_degree",
    "half",
    "radial_rule",
    "residual",
    "sphere_rule",
    "sphere_sizes",
    "symmetrise",
]
