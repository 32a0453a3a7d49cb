"""The largest stable steps of each scheme (docs/method.md §3)."""

from granstudy.evolution.schemes import SCHEMES
from granstudy.model.kernel import VHS
from granstudy.support.errors import unknown_name
from granstudy.velocity.space import VelocitySpace
from granstudy.velocity.sphere import sphere_area


def stability_limit(
    scheme: str,
    grid: VelocitySpace,
    *,
    diffusion: float = 0.0,
    collision_frequency: float = 0.0,
    dilation_rate: float = 0.0,
) -> float:
    """Largest step that is certain to be stable.

    A step dt has two limits, one for diffusion and collisions, which damp, and one for velocities that shrink
    or grow, which carry:

    ===============  =====================  ==================
    scheme           damping rate · dt      carrying rate · dt
    ===============  =====================  ==================
    ``rk3``          (ε|Δ| + ν) dt ≤ 2.51   1.73
    ``dopri54``      (ε|Δ| + ν) dt ≤ 3.31   1.00
    ``exponential``  ν dt ≤ 2.51            1.73
    ===============  =====================  ==================

    |Δ| is the largest eigenvalue of the Laplacian, d(πN/2L)² on a Cartesian grid. The carrying rate is |θ'/θ|
    times the largest eigenvalue of ∇c·(c ·), which is at most 0.35 πNd on a Cartesian grid.

    Parameters
    ----------
    scheme : str
        A name in `granstudy.evolution.schemes.SCHEMES`.
    grid : VelocityGrid or RadialGrid
    diffusion : float
        ε; in a rescaled frame εθ^{−2}.
    collision_frequency : float
        ν, an upper bound of the collision frequency (`granstudy.evolution.stability.largest_frequency`); in a
        rescaled frame θ^λ ν.
    dilation_rate : float
        θ'/θ; 0 in a fixed frame.

    Returns
    -------
    float
        The step; infinite where nothing limits it.

    Raises
    ------
    ValueError
        For an unknown scheme.
    """
    if scheme not in SCHEMES:
        raise unknown_name("scheme", scheme, list(SCHEMES))
    made = SCHEMES[scheme]
    damping = collision_frequency / made.real_limit
    if not made.exact_diffusion:
        damping += diffusion * grid.largest_laplacian / made.real_limit
    carrying = abs(dilation_rate) * grid.largest_dilation / made.imaginary_limit
    largest = max(damping, carrying)
    return 1.0 / largest if largest > 0.0 else float("inf")


def largest_frequency(kernel: VHS, dim: int, R: float, density: float = 1.0) -> float:
    """ν = ρ|S|C_λ R^λ: collision frequency of a particle that meets all others at the relative speed R."""
    return float(density * sphere_area(dim) * kernel.strength * R**kernel.exponent)


def step_warning(dt: float, scheme: str, limit: float) -> dict[str, str]:
    """The warning of a step above the limit, by its name; nothing for a step below."""
    if dt <= limit:
        return {}
    remedy = "time_rtol in its place" if scheme == "exponential" else "scheme='exponential'"
    return {
        "step": f"dt={dt:g} is above {limit:.3g}, up to which scheme {scheme!r} is stable: "
        f"take a smaller dt, or {remedy}"
    }
