"""Compiled loops of the fast operator: shift, accumulate, close a shell (docs/method.md §2).

Spectra are stored as a real transform leaves them, (n, [n,] n/2+1), with all axes but the first as one.
Phases e^{iπ k·x/L} are outer products of one-dimensional vectors, so no n^d phase array is formed, and
the vectors are powers of one exponential. The loops take both precisions: phases are powers in double
precision, and everything over the modes is in that of the spectra.
"""

import numba
import numpy as np

_compile = numba.njit(nogil=True, cache=True, fastmath={"contract", "nsz", "arcp", "reassoc"})


@_compile
def phase_vector(angle, n, re, im):
    """Re + i·im = e^{i·angle·k} for the wavenumbers k of one dimension of n points, in FFT order.

    ``re``, ``im``: (n,) for a full axis, (n/2+1,) for the one a real transform halves, (1,) for one
    that is not there. The unpaired mode k = −n/2 takes the mean of its two signs, cos(angle·n/2), which
    keeps real functions real.
    """
    re[0], im[0] = 1.0, 0.0
    if re.shape[0] == 1:
        return
    c, s = np.cos(angle), np.sin(angle)
    a, b = 1.0, 0.0
    for k in range(1, n // 2 + 1):
        a, b = a * c - b * s, a * s + b * c
        re[k], im[k] = a, b
    im[n // 2] = 0.0
    for k in range(n // 2 + 1, re.shape[0]):
        re[k] = re[n - k]
        im[k] = -im[n - k]


@_compile
def phase_plane(gy, gz, scale, n, ny, re, im):
    """Re + i·im = scale · e^{i(k_y g_y + k_z g_z)} over the modes (k_y, k_z), flattened."""
    nz = n // 2 + 1
    yr, yi = np.empty(ny), np.empty(ny)
    zr, zi = np.empty(nz), np.empty(nz)
    phase_vector(gy, n, yr, yi)
    phase_vector(gz, n, zr, zi)
    for j in range(ny):
        a, b = scale * yr[j], scale * yi[j]
        for k in range(nz):
            re[j * nz + k] = a * zr[k] - b * zi[k]
            im[j * nz + k] = a * zi[k] + b * zr[k]


@_compile
def shift(f_re, f_im, displacements, out):
    """out[b] = e^{i k·displacements[b]} f̂ : the density displaced by each vector of a batch.

    ``f_re``, ``f_im`` (n, m), m = n'(n/2+1) with n' = n in three dimensions and 1 in two;
    ``displacements`` (B, 3) in units L/π; ``out`` (≥B, n, 2m), real and imaginary parts in turn.
    """
    n, m = f_re.shape
    ny = m // (n // 2 + 1)
    xr, xi = np.empty(n, out.dtype), np.empty(n, out.dtype)
    pr, pi = np.empty(m, out.dtype), np.empty(m, out.dtype)
    for b in range(displacements.shape[0]):
        phase_vector(displacements[b, 0], n, xr, xi)
        phase_plane(displacements[b, 1], displacements[b, 2], 1.0, n, ny, pr, pi)
        for i in range(n):
            c, s = xr[i], xi[i]
            # One long loop over split parts: what compilers turn into vector instructions.
            for q in range(m):
                phase_re = c * pr[q] - s * pi[q]
                phase_im = c * pi[q] + s * pr[q]
                out[b, i, 2 * q] = phase_re * f_re[i, q] - phase_im * f_im[i, q]
                out[b, i, 2 * q + 1] = phase_re * f_im[i, q] + phase_im * f_re[i, q]


@_compile
def multiply(densities, f):
    """densities[b] *= f, rows (n n', n), for a batch whose rows are padded by an in-place transform."""
    rows, n = f.shape
    for b in range(densities.shape[0]):
        for j in range(rows):
            for k in range(n):
                densities[b, j, k] *= f[j, k]


@_compile
def accumulate_pairs(
    products, displacements, weights, shells, starts, ends, beta, means, place, sum_re, sum_im, gain
):
    """Sum a batch of antipodal pairs ±g for constant e; where a shell ``ends``, add it to ``gain``.

    sum += weight · e^{i½k·g} · 2cos(βk·g) · products, where products is the transform of f(v) f(v−g).
    The cosine times the half-shift is e^{i(½+β)k·g} + e^{i(½−β)k·g}, two outer products. The sum is from 0
    where a shell ``starts``; at its end gain += means[shell, |k|²] · sum.

    ``products`` (≥B, n, 2m), as `shift`'s output; ``displacements`` g (B, 3) in units L/π; ``weights``,
    ``shells``, ``starts``, ``ends`` (B,); ``means`` (shells, distinct |k|²); ``place`` (n, m) of each
    mode's |k|² in them; ``sum_re``, ``sum_im`` (n, m); ``gain`` (n, 2m).
    """
    n, m = sum_re.shape
    ny = m // (n // 2 + 1)
    xr, xi = np.empty((2, n), products.dtype), np.empty((2, n), products.dtype)
    pr, pi = np.empty((2, m), products.dtype), np.empty((2, m), products.dtype)
    for b in range(displacements.shape[0]):
        for s in range(2):
            factor = 0.5 + beta if s == 0 else 0.5 - beta
            gx, gy, gz = displacements[b]
            phase_vector(factor * gx, n, xr[s], xi[s])
            phase_plane(factor * gy, factor * gz, weights[b], n, ny, pr[s], pi[s])
        starting, ending, mean = starts[b], ends[b], means[shells[b]]
        for i in range(n):
            # Of a shell with one node no sum is kept: one row does, and stays in the cache.
            r = 0 if starting and ending else i
            if starting:
                for q in range(m):
                    sum_re[r, q] = 0.0
                    sum_im[r, q] = 0.0
            c0, s0, c1, s1 = xr[0, i], xi[0, i], xr[1, i], xi[1, i]
            for q in range(m):
                weight_re = c0 * pr[0, q] - s0 * pi[0, q] + c1 * pr[1, q] - s1 * pi[1, q]
                weight_im = c0 * pi[0, q] + s0 * pr[0, q] + c1 * pi[1, q] + s1 * pr[1, q]
                re, im = products[b, i, 2 * q], products[b, i, 2 * q + 1]
                sum_re[r, q] += weight_re * re - weight_im * im
                sum_im[r, q] += weight_re * im + weight_im * re
            if ending:
                for q in range(m):
                    value = mean[place[i, q]]
                    gain[i, 2 * q] += value * sum_re[r, q]
                    gain[i, 2 * q + 1] += value * sum_im[r, q]


@_compile
def accumulate_series(products, displacements, weights, shells, series, place, k2, radii, gain):
    """Sum a batch of antipodal pairs ±g for e(|g·ω|): their weight is a series in (k̂·ĝ)².

    gain += weight · e^{i½k·g} · 2Σ_n series[shell, |k|², n] T_n(2(k̂·ĝ)²−1) · products, by Clenshaw's
    recurrence. Shapes as in `accumulate_pairs`; ``k2`` holds the distinct |k|², ``radii`` the shells'
    ρ in units L/π.
    """
    n, m = place.shape
    nz = n // 2 + 1
    ny = m // nz
    xr, xi = np.empty(n), np.empty(n)
    pr, pi = np.empty(m), np.empty(m)
    for b in range(displacements.shape[0]):
        gx, gy, gz = displacements[b]
        phase_vector(0.5 * gx, n, xr, xi)
        phase_plane(0.5 * gy, 0.5 * gz, 2.0 * weights[b], n, ny, pr, pi)
        rho2 = radii[shells[b]] ** 2
        for i in range(n):
            # An unpaired mode, whose sign is neither, counts as 0 in k·g: reflections hold exactly.
            kx = i if i < nz - 1 else (0 if i == nz - 1 else i - n)
            for q in range(m):
                j, k = q // nz, q % nz
                ky = j if j < nz - 1 else (0 if j == nz - 1 else j - n)
                coefficients = series[shells[b], place[i, q]]
                kz = k if k < nz - 1 else 0
                k_dot_g = kx * gx + ky * gy + kz * gz
                square = max(k2[place[i, q]], 1) * rho2
                t = 2.0 * (2.0 * k_dot_g * k_dot_g / square - 1.0)
                now, before = 0.0, 0.0
                for order in range(coefficients.size - 1, 0, -1):
                    now, before = t * now - before + coefficients[order], now
                value = 0.5 * t * now - before + coefficients[0]
                weight_re = value * (xr[i] * pr[q] - xi[i] * pi[q])
                weight_im = value * (xr[i] * pi[q] + xi[i] * pr[q])
                re, im = products[b, i, 2 * q], products[b, i, 2 * q + 1]
                gain[i, 2 * q] += weight_re * re - weight_im * im
                gain[i, 2 * q + 1] += weight_re * im + weight_im * re


@_compile
def nodal_loss(displacements, weights, loss):
    """Loss = Σ_pairs weight · 2cos(m·g): the loss at the same nodes as the gain, a multiplier (n, m)."""
    n, m = loss.shape
    ny = m // (n // 2 + 1)
    xr, xi = np.empty(n), np.empty(n)
    pr, pi = np.empty(m), np.empty(m)
    for b in range(displacements.shape[0]):
        phase_vector(displacements[b, 0], n, xr, xi)
        phase_plane(displacements[b, 1], displacements[b, 2], 2.0 * weights[b], n, ny, pr, pi)
        for i in range(n):
            for q in range(m):
                loss[i, q] += xr[i] * pr[q] - xi[i] * pi[q]
