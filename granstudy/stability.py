"""The largest steps that a scheme is stable with (docs/method.md §3)."""

from granstudy.errors import unknown_name
from granstudy.schemes import SCHEMES
from granstudy.velocity_space import VelocitySpace


def stability_limit(
    scheme: str, grid: VelocitySpace, diffusion: float, dilation_rate: float = 0.0
) -> float:
    """Largest step that diffusion, and the shrinking of rescaled velocities, leave stable.

    Diffusion: ε|Δ|dt ≤ 2.51 (`rk3`), 3.31 (`dopri54`), no limit (`exponential`); |Δ| is the largest
    eigenvalue, d(πN/2L)² on a Cartesian grid. Shrinking: |θ'/θ| times the largest eigenvalue of ∇c·(c ·) times
    dt ≤ 1.73 (`rk3`, `exponential`), 1 (`dopri54`). Collisions, not counted here, allow dt up to about 2.5 (3.3)
    over the collision frequency of the fastest particles.

    Parameters
    ----------
    scheme : str
        A name in `granstudy.schemes.SCHEMES`.
    grid : VelocityGrid or RadialGrid
    diffusion : float
        ε; in a rescaled frame εθ^{−2}.
    dilation_rate : float
        θ'/θ; 0 in a fixed frame.

    Raises
    ------
    ValueError
        For an unknown scheme.
    """
    if scheme not in SCHEMES:
        raise unknown_name("scheme", scheme, list(SCHEMES))
    made = SCHEMES[scheme]
    # One over the largest stable step, a part for each process.
    slowest = diffusion * grid.largest_laplacian / made.diffusion_limit
    if dilation_rate:
        slowest = max(slowest, abs(dilation_rate) * grid.largest_dilation / made.imaginary_limit)
    return 1.0 / slowest if slowest > 0.0 else float("inf")


def step_warning(
    scheme: str, grid: VelocitySpace, dt: float, diffusion: float, dilation_rate: float = 0.0
) -> str | None:
    """What to say of a step above the limit, or None."""
    limit = stability_limit(scheme, grid, diffusion, dilation_rate)
    if dt <= limit:
        return None
    shrinking = stability_limit(scheme, grid, 0.0, dilation_rate) < dt
    remedy = "time_rtol" if shrinking or scheme == "exponential" else "scheme='exponential'"
    return (
        f"dt={dt:g} is above the limit {limit:.3g} of scheme {scheme!r}: take a smaller dt, or {remedy}"
    )
