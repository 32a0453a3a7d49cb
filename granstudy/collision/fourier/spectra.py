"""Spectra on grids of another size, and their modes that aliasing does not reach."""

import itertools

import numpy as np
import scipy.fft

KEPT = 3 / 8
"""Modes in parts of N that a difference between two quadratures is measured on. The products' spectrum
wraps around into the others, differently for every choice of nodes (measured: leaving those out takes the
difference of two converged quadratures from 3e-6 to 1e-7 of max|Q| for a density with T = 1, N = 32)."""


def half_spectrum(f: np.ndarray) -> np.ndarray:
    """Half spectrum (N, N', N/2+1) of a density (N, N', N): Σ_k f̂_k e^{iπk·v/L} = f."""
    return scipy.fft.rfftn(f, axes=long_axes(f), norm="forward")


def density(f_hat: np.ndarray) -> np.ndarray:
    """Density (N, N', N) with a half spectrum (N, N', N/2+1)."""
    axes = long_axes(f_hat)
    return scipy.fft.irfftn(f_hat, s=(len(f_hat),) * len(axes), axes=axes, norm="forward")


def long_axes(array: np.ndarray) -> tuple[int, ...]:
    """The axes to transform of a density or half spectrum with three axes: not the second in 2D."""
    return (0, 1, 2) if array.shape[1] > 1 else (0, 2)


def resize(f_hat: np.ndarray, n: int) -> np.ndarray:
    """Spectrum of the same function on n points a dimension, from a half spectrum (N, N', N/2+1).

    A smaller grid drops the modes |k_i| ≥ n/2, a larger one has none there. Both grids' nodes are cell
    centres, so that the mode k turns by e^{iπk(1/n − 1/N)}. Unpaired modes k_i = −N/2 are dropped.
    """
    N, ny, _ = f_hat.shape
    if n == N:
        return f_hat
    half = min(n, N) // 2
    k = np.concatenate([np.arange(half), np.arange(-half + 1, 0)])
    turn = np.exp(1j * np.pi * k * (1 / n - 1 / N))
    out = np.zeros((n, n if ny > 1 else 1, n // 2 + 1), dtype=np.complex128)
    signs = slice(half), slice(1 - half, None)
    for x, y in itertools.product(signs, signs if ny > 1 else [slice(1)]):
        turns = turn[x, None, None] * turn[:half] * (turn[y, None] if ny > 1 else 1.0)
        np.multiply(f_hat[x, y, :half], turns, out=out[x, y, :half])
    return out


def serial_transforms(N: int, n: int) -> int:
    """Transforms of `fast` beside those of its nodes, with products on n points a dimension.

    Of f, of the loss, and back; one more between the grids where n < N; two where n > N.
    """
    return 3 if n == N else 4 if n < N else 5


def unaliased(f_hat: np.ndarray) -> np.ndarray:
    """The modes |k_i| ≤ `KEPT`·N of a half spectrum (N, N', N/2+1), the others zero."""
    N, ny, _ = f_hat.shape
    k = np.abs(np.fft.fftfreq(N, 1 / N)) <= KEPT * N
    y = k if ny > 1 else np.ones(1, dtype=bool)
    return f_hat * (k[:, None, None] & y[:, None] & k[: N // 2 + 1])
