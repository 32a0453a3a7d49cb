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
def accumulate(product_hat, displacement, weight, beta, totals):
    """totals[r] += weight · e^{i½k·g} · 2cos(β_r k·g) · product_hat for one antipodal pair ±g.

    ``product_hat`` (N, N', N/2+1) is the transform of f(v) f(v−g), ``displacement`` is g in units
    L/π. The cosine times the half-shift is e^{i(½+β)k·g} + e^{i(½−β)k·g}, two outer products.
    """
    nx, ny, nz = product_hat.shape
    unpaired = nz - 1
    phases = np.empty((2, 3, max(nx, nz)), np.complex128)
    for r in range(beta.shape[0]):
        for s in range(2):
            factor = 0.5 + beta[r] if s == 0 else 0.5 - beta[r]
            phase_vector(factor * displacement[0], unpaired, phases[s, 0, :nx])
            phase_vector(factor * displacement[1], unpaired, phases[s, 1, :ny])
            phase_vector(factor * displacement[2], unpaired, phases[s, 2, :nz])
        plus = phases[0, 2, :nz]
        minus = phases[1, 2, :nz]
        for i in range(nx):
            for j in range(ny):
                row_plus = weight * phases[0, 0, i] * phases[0, 1, j]
                row_minus = weight * phases[1, 0, i] * phases[1, 1, j]
                for k in range(nz):
                    totals[r, i, j, k] += (
                        row_plus * plus[k] + row_minus * minus[k]
                    ) * product_hat[i, j, k]


@_compile
def close_shell(totals, means, place, gain):
    """gain += Σ_r means[r, |k|²] · totals[r], then totals = 0: what depends on |k| only."""
    for r in range(totals.shape[0]):
        for i in range(totals.shape[1]):
            for j in range(totals.shape[2]):
                for k in range(totals.shape[3]):
                    gain[i, j, k] += means[r, place[i, j, k]] * totals[r, i, j, k]
                    totals[r, i, j, k] = 0.0


@_compile
def accumulate_batch(
    products_hat, displacements, weights, shells, ends, beta, means, place, totals, gain
):
    """Accumulate a batch of pairs; where a shell ``ends``, close it into ``gain``.

    ``products_hat`` (≥B, N, N', N/2+1); ``displacements`` (B, 3); ``weights``, ``shells``, ``ends``
    (B,); ``beta`` (r,); ``means`` (shells, r, distinct |k|²); ``totals`` (r, N, N', N/2+1).
    """
    for b in range(displacements.shape[0]):
        accumulate(products_hat[b], displacements[b], weights[b], beta, totals)
        if ends[b]:
            close_shell(totals, means[shells[b]], place, gain)


@_compile
def nodal_loss(displacements, weights, loss):
    """loss = Σ_pairs weight · 2cos(m·g): the loss at the same nodes as the gain, a multiplier."""
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
