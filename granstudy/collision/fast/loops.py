"""Compiled loops of the fast operator: a share of the sum over nodes (docs/method.md §2).

Spectra are stored as a real transform leaves them, with all axes but the first as one: shape (n, m) of
complex numbers or (n, 2m) of real and imaginary parts in turn, m = n'(n/2+1), n' = n in 3D and 1 in 2D.
Phases e^{iπ k·x/L} are outer products of one-dimensional vectors, and the vectors are powers of one
exponential: no array of n^d phases is formed. The loops take both precisions. Phases are computed in double
precision, sums over modes in the precision of the spectra.
"""

import numpy as np

from granstudy.collision.fourier.fftw import BACKWARD, FORWARD, execute
from granstudy.support.compiled import compiled

FASTMATH = {"contract", "nsz", "arcp", "reassoc"}
"""Freedoms of the compiler: sums in any order, fused multiplication and addition, no sign of zero."""

_compile = compiled(fastmath=FASTMATH)
_inline = compiled(fastmath=FASTMATH, forceinline=True)


@_inline
def phase_vector(angle, n, re, im):
    """re + i·im = e^{i·angle·k} for the wavenumbers k of one dimension of n points, in FFT order.

    The length of ``re`` and ``im`` says which axis it is: n for a full axis, n/2+1 for the axis that a real
    transform halves, 1 for the axis that 2D lacks. The unpaired mode k = −n/2 takes the mean of its two
    signs, cos(angle·n/2), which keeps real functions real.
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


@_inline
def phase_plane(gy, gz, scale, n, ny, re, im):
    """re + i·im = scale · e^{i(k_y g_y + k_z g_z)} over the modes (k_y, k_z), flattened."""
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


@_inline
def shift(f_re, f_im, g, out):
    """out = e^{−i k·g} f̂, the spectrum of the density displaced by g.

    ``f_re``, ``f_im`` (n, m); ``g`` (3,) in units L/π; ``out`` (n, 2m), real and imaginary parts in turn.
    """
    n, m = f_re.shape
    ny = m // (n // 2 + 1)
    xr, xi = np.empty(n, out.dtype), np.empty(n, out.dtype)
    pr, pi = np.empty(m, out.dtype), np.empty(m, out.dtype)
    phase_vector(-g[0], n, xr, xi)
    phase_plane(-g[1], -g[2], 1.0, n, ny, pr, pi)
    for i in range(n):
        c, s = xr[i], xi[i]
        # Compilers turn one long loop over separate real and imaginary parts into vector instructions.
        for q in range(m):
            phase_re = c * pr[q] - s * pi[q]
            phase_im = c * pi[q] + s * pr[q]
            out[i, 2 * q] = phase_re * f_re[i, q] - phase_im * f_im[i, q]
            out[i, 2 * q + 1] = phase_re * f_im[i, q] + phase_im * f_re[i, q]


@_inline
def multiply(density, f):
    """density *= f over rows (n n', n). An in-place transform pads the rows of ``density``."""
    rows, n = f.shape
    for j in range(rows):
        for k in range(n):
            density[j, k] *= f[j, k]


@_compile
def subtract_loss(gain, f, lost, Q):
    """Q = gain − f·lost over rows (n n', n). Rows of ``gain`` and ``lost`` are padded as in `multiply`."""
    rows, n = f.shape
    for j in range(rows):
        for k in range(n):
            Q[j, k] = gain[j, k] - f[j, k] * lost[j, k]


@_compile
def separate(parts, scale, re, im):
    """re + i·im = scale · parts, in the precision of ``re`` (n, m); ``parts`` (n, 2m)."""
    n, m = re.shape
    for i in range(n):
        for q in range(m):
            re[i, q] = scale * parts[i, 2 * q]
            im[i, q] = scale * parts[i, 2 * q + 1]


@_compile
def scale_modes(factors, parts, out):
    """out = factors · parts, mode by mode, for real factors (n, m); ``parts`` and ``out`` (n, 2m)."""
    n, m = factors.shape
    for i in range(n):
        for q in range(m):
            out[i, 2 * q] = factors[i, q] * parts[i, 2 * q]
            out[i, 2 * q + 1] = factors[i, q] * parts[i, 2 * q + 1]


@_compile
def add_shares(gains, out):
    """out = Σ_shares gains, shares one after the other; ``gains`` (shares, 2, n, m), ``out`` (n, 2m)."""
    shares, _, n, m = gains.shape
    re, im = np.empty(m), np.empty(m)
    for i in range(n):
        re[:] = 0.0
        im[:] = 0.0
        for share in range(shares):
            for q in range(m):
                re[q] += gains[share, 0, i, q]
                im[q] += gains[share, 1, i, q]
        for q in range(m):
            out[i, 2 * q] = re[q]
            out[i, 2 * q + 1] = im[q]


@_inline
def product(f_re, f_im, f, g, parts, rows, plans):
    """parts = spectrum of f(v) f(v−g), shape (n, 2m). ``rows`` is the same memory as a density."""
    shift(f_re, f_im, g, parts)
    execute(plans, BACKWARD)
    multiply(rows, f)
    execute(plans, FORWARD)


@_compile
def sum_pairs(
    beta,
    means,
    sum_re,
    sum_im,
    f_re,
    f_im,
    f,
    vectors,
    weights,
    shells,
    place,
    parts,
    rows,
    plans,
    gain_re,
    gain_im,
):
    """gain = sum over antipodal pairs ±g for a constant e.

    gain = Σ_shells mean(|k|²) Σ_pairs weight · e^{i½k·g} · 2cos(βk·g) · FFT[f(v) f(v−g)].

        means                   (shells, distinct |k|²)
        sum_re, sum_im          (n, m), buffers for the sum over a shell
        f_re, f_im, f           (n, m) and (n n', n): the density's half spectrum and values
        vectors                 (pairs, 3): g in units L/π
        weights, shells         (pairs,)
        place                   (n, m): place of a mode's |k|² among the distinct ones
        parts, rows, plans      a thread's transforms
        gain_re, gain_im        (n, m)
    """
    last = len(vectors) - 1
    opens = first = True
    for b in range(last + 1):
        product(f_re, f_im, f, vectors[b], parts, rows, plans)
        closes = b == last or shells[b + 1] != shells[b]
        add_pair(
            parts,
            vectors[b],
            weights[b],
            beta,
            opens,
            closes,
            first,
            means[shells[b]],
            place,
            sum_re,
            sum_im,
            gain_re,
            gain_im,
        )
        opens = closes
        first = first and not closes


@_inline
def pair_weight(c0, s0, c1, s1, pr, pi, q):
    """Real and imaginary part of (c0 + i·s0)(pr + i·pi)[0] + (c1 + i·s1)(pr + i·pi)[1] at mode q."""
    return (
        c0 * pr[0, q] - s0 * pi[0, q] + c1 * pr[1, q] - s1 * pi[1, q],
        c0 * pi[0, q] + s0 * pr[0, q] + c1 * pi[1, q] + s1 * pr[1, q],
    )


@_inline
def add_pair(
    parts, g, weight, beta, opens, closes, first, mean, place, sum_re, sum_im, gain_re, gain_im
):
    """Add a pair to the sum over its shell.

    A pair that ``opens`` its shell starts the sum from 0. One that ``closes`` it adds the sum to the gain;
    the ``first`` shell starts the gain from 0.
    A shell with one pair needs no sum. The cosine times the half-shift is e^{i(½+β)k·g} + e^{i(½−β)k·g}:
    two outer products.
    """
    n, m = sum_re.shape
    ny = m // (n // 2 + 1)
    xr, xi = np.empty((2, n), parts.dtype), np.empty((2, n), parts.dtype)
    pr, pi = np.empty((2, m), parts.dtype), np.empty((2, m), parts.dtype)
    for s in range(2):
        factor = 0.5 + beta if s == 0 else 0.5 - beta
        phase_vector(factor * g[0], n, xr[s], xi[s])
        phase_plane(factor * g[1], factor * g[2], weight, n, ny, pr[s], pi[s])
    row_mean = np.empty(m, parts.dtype)
    # Rows k_x and −k_x follow each other, as they have the same means.
    for turn in range(n):
        i = (turn + 1) // 2 if turn % 2 == 1 else -(turn // 2) % n
        if closes and i <= n // 2:
            spread_means(mean, place[i], n, ny, row_mean)
        c0, s0, c1, s1 = xr[0, i], xi[0, i], xr[1, i], xi[1, i]
        if closes and first:
            for q in range(m):
                gain_re[i, q] = 0.0
                gain_im[i, q] = 0.0
        if opens and closes:
            for q in range(m):
                weight_re, weight_im = pair_weight(c0, s0, c1, s1, pr, pi, q)
                re, im = row_mean[q] * parts[i, 2 * q], row_mean[q] * parts[i, 2 * q + 1]
                gain_re[i, q] += weight_re * re - weight_im * im
                gain_im[i, q] += weight_re * im + weight_im * re
            continue
        if opens:
            for q in range(m):
                sum_re[i, q] = 0.0
                sum_im[i, q] = 0.0
        for q in range(m):
            weight_re, weight_im = pair_weight(c0, s0, c1, s1, pr, pi, q)
            re, im = parts[i, 2 * q], parts[i, 2 * q + 1]
            sum_re[i, q] += weight_re * re - weight_im * im
            sum_im[i, q] += weight_re * im + weight_im * re
        if closes:
            for q in range(m):
                gain_re[i, q] += row_mean[q] * sum_re[i, q]
                gain_im[i, q] += row_mean[q] * sum_im[i, q]


@_inline
def spread_means(mean, place, n, ny, row):
    """row = mean[place], shape (m,): gathered for k_y ≥ 0, copied for k_y < 0."""
    nz = n // 2 + 1
    for j in range(ny):
        if j <= ny // 2:
            for k in range(nz):
                row[j * nz + k] = mean[place[j * nz + k]]
        else:
            for k in range(nz):
                row[j * nz + k] = row[(ny - j) * nz + k]


@_compile
def sum_series(
    series,
    k2,
    radii,
    f_re,
    f_im,
    f,
    vectors,
    weights,
    shells,
    place,
    parts,
    rows,
    plans,
    gain_re,
    gain_im,
):
    """gain = sum over antipodal pairs ±g for a law e(|g·ω|), whose weight is a series in (k̂·ĝ)².

    gain = Σ_pairs weight · e^{i½k·g} · 2Σ_n series[shell, |k|², n] T_n(2(k̂·ĝ)²−1) · FFT[f(v) f(v−g)].
    Clenshaw's recurrence sums the series. Shapes are as in `sum_pairs`; ``k2`` holds the distinct |k|²,
    ``radii`` the shells' ρ in units L/π.
    """
    n, m = place.shape
    nz = n // 2 + 1
    ny = m // nz
    xr, xi = np.empty(n), np.empty(n)
    pr, pi = np.empty(m), np.empty(m)
    gain_re[:] = 0.0
    gain_im[:] = 0.0
    for b in range(len(vectors)):
        product(f_re, f_im, f, vectors[b], parts, rows, plans)
        gx, gy, gz = vectors[b]
        phase_vector(0.5 * gx, n, xr, xi)
        phase_plane(0.5 * gy, 0.5 * gz, 2.0 * weights[b], n, ny, pr, pi)
        rho2 = radii[shells[b]] ** 2
        for i in range(n):
            # An unpaired mode has no sign. It counts as 0 in k·g, so that reflections hold exactly.
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
                re, im = parts[i, 2 * q], parts[i, 2 * q + 1]
                gain_re[i, q] += weight_re * re - weight_im * im
                gain_im[i, q] += weight_re * im + weight_im * re


@_compile
def nodal_loss(displacements, weights, loss):
    """loss = Σ_pairs weight · 2cos(m·g): the multiplier (n, m) of the loss at the gain's nodes."""
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
