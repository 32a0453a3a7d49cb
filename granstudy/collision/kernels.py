"""Compiled loops of the fast operator: shift, accumulate, close a shell (docs/method.md §2).

Spectra are stored as a real transform leaves them: (N, [N,] N/2+1). Phases e^{iπ k·x/L} are outer
products of one-dimensional vectors, so no N^d phase array is formed and no exponential is taken on one.
"""

import numba
import numpy as np

_compile = numba.njit(nogil=True, cache=True, fastmath={"contract", "nsz", "arcp", "reassoc"})


@_compile
def phase_vector(angle, unpaired, out):
    """e^{i·angle·k} for the wavenumbers k of one dimension, in FFT order.

    The unpaired mode k = −N/2 of a full axis takes the mean of its two signs, cos(angle·N/2), which
    keeps real functions real; ``unpaired`` is N/2.
    """
    n = out.shape[0]
    for i in range(n):
        k = i if i <= unpaired else i - 2 * unpaired
        if i == unpaired:
            out[i] = np.cos(angle * k)
        else:
            out[i] = np.cos(angle * k) + 1j * np.sin(angle * k)


@_compile
def shift(f_hat, displacements, out):
    """out[b] = e^{i k·displacements[b]} f̂ : the density displaced by each vector of a batch.

    ``f_hat`` (N, N', N/2+1) with N' = 1 in two dimensions; ``displacements`` (B, 3) in units L/π;
    ``out`` (B, N, N', N/2+1).
    """
    nx, ny, nz = f_hat.shape
    unpaired = nz - 1
    px = np.empty(nx, np.complex128)
    py = np.empty(ny, np.complex128)
    pz = np.empty(nz, np.complex128)
    for b in range(displacements.shape[0]):
        phase_vector(displacements[b, 0], unpaired, px)
        phase_vector(displacements[b, 1], unpaired, py)
        phase_vector(displacements[b, 2], unpaired, pz)
        for i in range(nx):
            for j in range(ny):
                row = px[i] * py[j]
                for k in range(nz):
                    out[b, i, j, k] = row * pz[k] * f_hat[i, j, k]


@_compile
def multiply(densities, f):
    """densities[b] *= f for a batch whose rows are padded, as an in-place transform leaves them."""
    count, nx, ny, nz = densities.shape
    for b in range(count):
        for i in range(nx):
            for j in range(ny):
                for k in range(nz):
                    densities[b, i, j, k] *= f[i, j, k]


@_compile
def accumulate_pairs(
    products_hat, displacements, weights, shells, ends, beta, means, place, shell_sum, gain
):
    """Sum a batch of antipodal pairs ±g for constant e; where a shell ``ends``, add it to ``gain``.

    shell_sum += weight · e^{i½k·g} · 2cos(βk·g) · products_hat, where products_hat is the transform of
    f(v) f(v−g). The cosine times the half-shift is e^{i(½+β)k·g} + e^{i(½−β)k·g}, two outer products. At
    the end of a shell gain += means[shell, |k|²] · shell_sum.

    ``products_hat`` (≥B, N, N', N/2+1); ``displacements`` g (B, 3) in units L/π; ``weights``, ``shells``,
    ``ends`` (B,); ``means`` (shells, distinct |k|²); ``place`` of each mode's |k|² in them.
    """
    _, nx, ny, nz = products_hat.shape
    unpaired = nz - 1
    px = np.empty((2, nx), np.complex128)
    py = np.empty((2, ny), np.complex128)
    pz = np.empty((2, nz), np.complex128)
    for b in range(displacements.shape[0]):
        for s in range(2):
            factor = 0.5 + beta if s == 0 else 0.5 - beta
            phase_vector(factor * displacements[b, 0], unpaired, px[s])
            phase_vector(factor * displacements[b, 1], unpaired, py[s])
            phase_vector(factor * displacements[b, 2], unpaired, pz[s])
        for i in range(nx):
            for j in range(ny):
                plus = weights[b] * px[0, i] * py[0, j]
                minus = weights[b] * px[1, i] * py[1, j]
                for k in range(nz):
                    shell_sum[i, j, k] += (plus * pz[0, k] + minus * pz[1, k]) * products_hat[
                        b, i, j, k
                    ]
        if ends[b]:
            mean = means[shells[b]]
            for i in range(nx):
                for j in range(ny):
                    for k in range(nz):
                        gain[i, j, k] += mean[place[i, j, k]] * shell_sum[i, j, k]
                        shell_sum[i, j, k] = 0.0


@_compile
def accumulate_series(products_hat, displacements, weights, shells, series, place, k2, radii, gain):
    """Sum a batch of antipodal pairs ±g for e(|g·ω|): their weight is a series in (k̂·ĝ)².

    gain += weight · e^{i½k·g} · 2Σ_n series[shell, |k|², n] T_n(2(k̂·ĝ)²−1) · products_hat, by Clenshaw's
    recurrence. Shapes as in `accumulate_pairs`; ``k2`` holds the distinct |k|², ``radii`` the shells'
    ρ in units L/π.
    """
    _, nx, ny, nz = products_hat.shape
    unpaired = nz - 1
    px = np.empty(nx, np.complex128)
    py = np.empty(ny, np.complex128)
    pz = np.empty(nz, np.complex128)
    for b in range(displacements.shape[0]):
        gx, gy, gz = displacements[b]
        phase_vector(0.5 * gx, unpaired, px)
        phase_vector(0.5 * gy, unpaired, py)
        phase_vector(0.5 * gz, unpaired, pz)
        rho2 = radii[shells[b]] ** 2
        for i in range(nx):
            kx = i if i < unpaired else i - nx
            for j in range(ny):
                ky = j if j < unpaired else j - ny
                row = 2.0 * weights[b] * px[i] * py[j]
                for k in range(nz):
                    coefficients = series[shells[b], place[i, j, k]]
                    k_dot_g = kx * gx + ky * gy + k * gz
                    square = max(k2[place[i, j, k]], 1) * rho2
                    t = 2.0 * (2.0 * k_dot_g * k_dot_g / square - 1.0)
                    now, before = 0.0, 0.0
                    for n in range(coefficients.size - 1, 0, -1):
                        now, before = t * now - before + coefficients[n], now
                    value = 0.5 * t * now - before + coefficients[0]
                    gain[i, j, k] += value * row * pz[k] * products_hat[b, i, j, k]


@_compile
def nodal_loss(displacements, weights, loss):
    """Loss = Σ_pairs weight · 2cos(m·g): the loss at the same nodes as the gain, a multiplier."""
    nx, ny, nz = loss.shape
    unpaired = nz - 1
    px = np.empty(nx, np.complex128)
    py = np.empty(ny, np.complex128)
    pz = np.empty(nz, np.complex128)
    for b in range(displacements.shape[0]):
        phase_vector(displacements[b, 0], unpaired, px)
        phase_vector(displacements[b, 1], unpaired, py)
        phase_vector(displacements[b, 2], unpaired, pz)
        for i in range(nx):
            for j in range(ny):
                row = 2.0 * weights[b] * px[i] * py[j]
                for k in range(nz):
                    loss[i, j, k] += (row * pz[k]).real
