"""Compiled collisions of one batch: Kac's process by an exponential clock (docs/particles.md §1).

Velocities have the shape (n, 3) in both dimensions; in 2D the third component is 0.
"""

import math

import numpy as np

from granstudy.support.compiled import compiled

OCTAVES = 64
"""Octaves of the table of restitution, down from its largest speed. Below them α keeps its value."""

PER_OCTAVE = 128
"""Linear pieces of the table in an octave: an error of at most 8e-6 · max|v² e''(v)|, 1e-6 for
`granstudy.Viscoelastic`."""

_compile = compiled(error_model="numpy")
_inline = compiled(error_model="numpy", forceinline=True)
_compile_sums = compiled(fastmath={"contract", "nsz", "reassoc"})


@_inline
def direction(dim, rng):
    """σ uniform on the unit circle (2D) or sphere (3D; Marsaglia, Ann. Math. Stat. 43, 645 (1972))."""
    while True:
        x = 2.0 * rng.random() - 1.0
        y = 2.0 * rng.random() - 1.0
        s = x * x + y * y
        if 0.0 < s < 1.0:
            break
    if dim == 2:
        return (x * x - y * y) / s, 2.0 * x * y / s, 0.0
    r = 2.0 * math.sqrt(1.0 - s)
    return x * r, y * r, 1.0 - 2.0 * s


@_inline
def power(squared, exponent):
    """|g|^λ from |g|²."""
    if exponent == 1.0:
        return math.sqrt(squared)
    if exponent == 0.0:
        return 1.0
    return squared ** (0.5 * exponent)


@_inline
def squared_length(c, i):
    """|c_i|²."""
    return c[i, 0] ** 2 + c[i, 1] ** 2 + c[i, 2] ** 2


@_inline
def alpha_at(speed, alphas, top):
    """α at a speed: linear between the table's speeds top · 2^−k (1 + m/128), constant beyond its ends."""
    mantissa, octave = math.frexp(speed / top)  # mantissa in [½, 1)
    place = (octave - 1 + OCTAVES) * PER_OCTAVE + (2.0 * mantissa - 1.0) * PER_OCTAVE
    if place <= 0.0 or speed == 0.0:
        return alphas[0]
    k = int(place)
    if k >= alphas.size - 1:
        return alphas[-1]
    part = place - k
    return (1.0 - part) * alphas[k] + part * alphas[k + 1]


@_inline
def recentre(c):
    """Take off the mean of c, in place; returns the largest |c_i|² left.

    The mean is round-off, which a gas that cools would come down to.
    """
    x = y = z = 0.0
    for i in range(c.shape[0]):
        x += c[i, 0]
        y += c[i, 1]
        z += c[i, 2]
    x, y, z = x / c.shape[0], y / c.shape[0], z / c.shape[0]
    largest = 0.0
    for i in range(c.shape[0]):
        c[i, 0] -= x
        c[i, 1] -= y
        c[i, 2] -= z
        largest = max(largest, squared_length(c, i))
    return largest


@_compile
def collide(c, dim, rng, duration, rate, exponent, alphas, top):
    """Let the particles collide for ``duration``; c changes in place.

    Each pair collides at the rate ``rate``/n · |g|^λ, ``rate`` = ρ|S|C_λ. Let G = 2 max|c|, so that |g| ≤ G.
    Candidates come at the total rate (n−1)/2 · ``rate`` · G^λ, and a candidate collides with probability
    (|g|/G)^λ. G is raised with every particle that becomes faster, and taken anew after n candidates, as the
    gas cools. The exponential clock has no memory, so that its rate may change between candidates.

    Parameters
    ----------
    c : ndarray, shape (n, 3)
        Velocities about their mean.
    alphas, top : ndarray, float
        Table and largest speed (`granstudy.particles.restitution_table.alpha_table`).

    Returns
    -------
    (int, float)
        Number of collisions, and their largest normal impact speed |g·ω|; 0 for constant e.
    """
    n = c.shape[0]
    largest = recentre(c)
    bound = power(4.0 * largest, exponent)
    candidates = n
    collisions = 0
    hardest = 0.0
    time = 0.0
    while True:
        time += rng.standard_exponential() / (0.5 * (n - 1) * rate * bound)
        if time > duration:
            return collisions, hardest
        i = int(rng.random() * n)
        j = int(rng.random() * (n - 1))
        if j >= i:
            j += 1
        gx, gy, gz = c[i, 0] - c[j, 0], c[i, 1] - c[j, 1], c[i, 2] - c[j, 2]
        squared = gx * gx + gy * gy + gz * gz
        if rng.random() * bound < power(squared, exponent):
            g = math.sqrt(squared)
            sx, sy, sz = direction(dim, rng)
            alpha = alphas[0]
            if alphas.size > 1:
                # |g·ω| = |g| sin(χ/2), χ the angle from g to σ.
                along = gx * sx + gy * sy + gz * sz
                impact = math.sqrt(max(0.5 * g * (g - along), 0.0))
                hardest = max(hardest, impact)
                alpha = alpha_at(impact, alphas, top)
            dx, dy, dz = alpha * (gx - g * sx), alpha * (gy - g * sy), alpha * (gz - g * sz)
            c[i, 0] -= dx
            c[i, 1] -= dy
            c[i, 2] -= dz
            c[j, 0] += dx
            c[j, 1] += dy
            c[j, 2] += dz
            collisions += 1
            faster = max(squared_length(c, i), squared_length(c, j))
            if faster > largest:
                largest = faster
                bound = power(4.0 * largest, exponent)
        candidates -= 1
        if candidates == 0:
            candidates = n
            largest = recentre(c)
            bound = power(4.0 * largest, exponent)


@_compile_sums
def means(c):
    """⟨c⟩, shape (3,), ⟨cc⟩, shape (3, 3), and ⟨|c|⁴⟩."""
    n = c.shape[0]
    x = y = z = xx = xy = xz = yy = yz = zz = fourth = 0.0
    for i in range(n):
        cx, cy, cz = c[i, 0], c[i, 1], c[i, 2]
        x += cx
        y += cy
        z += cz
        xx += cx * cx
        xy += cx * cy
        xz += cx * cz
        yy += cy * cy
        yz += cy * cz
        zz += cz * cz
        fourth += (cx * cx + cy * cy + cz * cz) ** 2
    second = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.array([x, y, z]) / n, second / n, fourth / n


@_compile
def count_in_cells(c, velocity, L, counts):
    """Add every particle in the box [−L, L]^d to its cell; ``counts`` is (N, N, N), in 2D (N, N, 1)."""
    per_length = counts.shape[0] / (2.0 * L)
    flat = counts.shape[2] == 1
    for i in range(c.shape[0]):
        px = math.floor((c[i, 0] + velocity[0] + L) * per_length)
        py = math.floor((c[i, 1] + velocity[1] + L) * per_length)
        pz = 0 if flat else math.floor((c[i, 2] + velocity[2] + L) * per_length)
        if 0 <= px < counts.shape[0] and 0 <= py < counts.shape[1] and 0 <= pz < counts.shape[2]:
            counts[px, py, pz] += 1
