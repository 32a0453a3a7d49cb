"""Scenes that the Carleman form can model, and the number of products that they take."""

import math

from granstudy.model.kernel import VHS
from granstudy.model.scene import Scene
from granstudy.velocity.cartesian import VelocityGrid

ELASTIC_PRODUCTS = 5
"""Products per direction at e = 1 where B̃ is not constant."""


def is_separable(kernel: VHS, dim: int) -> bool:
    """Whether B̃ ∝ |g|^{λ+2−d} is constant: for hard spheres in 3D and Maxwell molecules in 2D it is."""
    return kernel.exponent == dim - 2


def check_scene(scene: Scene) -> float:
    """The restitution of a scene that method `carleman` can model.

    Raises
    ------
    ValueError
        If the restitution depends on the impact speed, or e < 1 and B̃ is not constant.
    """
    e = scene.restitution
    if callable(e):
        raise ValueError(f"restitution={e!r}: method 'carleman' takes a constant")
    if e < 1.0 and not is_separable(scene.kernel, scene.dim):
        raise ValueError(
            f"restitution={e!r} with exponent={scene.kernel.exponent!r} in {scene.dim}D: method "
            "'carleman' takes restitution below 1 only with exponent 1 in 3D or 0 in 2D"
        )
    return float(e)


def reach(grid: VelocityGrid) -> float:
    """Largest |x| and |y|: r = (2L − R)/√2 = 0.854 R.

    Then |x + y| ≤ √2 r = 2L − R. No particle therefore collides with the periodic image of one nearer than R,
    and every pair nearer than r collides as it should.
    """
    return float((2.0 * grid.L - grid.R) / math.sqrt(2.0))


def product_count(scene: Scene, grid: VelocityGrid) -> int:
    """Estimated number of products per direction.

    scene                        products
    B̃ constant, e = 1            1
    B̃ constant, e < 1            more, the larger the phase 2βρk·e of a displacement
    B̃ not constant, e = 1        `ELASTIC_PRODUCTS`
    """
    e = check_scene(scene)
    if not is_separable(scene.kernel, scene.dim):
        return ELASTIC_PRODUCTS
    if e == 1.0:
        return 1
    return 5 + int((1.0 - e) / 2.0 * reach(grid) * math.pi * grid.N / 2 / grid.L)
