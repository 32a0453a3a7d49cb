"""Planned real transforms on reused buffers, and spectra on grids of another size."""

import numpy as np
import pyfftw

KEPT = 3 / 8
"""Modes in parts of N that a difference between two quadratures is measured on. The products' spectrum
wraps around into the others, differently for every choice of nodes (measured: leaving those out takes the
difference of two converged quadratures from 3e-6 to 1e-7 of max|Q| for a density with T = 1, N = 32)."""


class Transforms:
    """Real transforms of a batch of densities in place, planned once on an aligned buffer.

    Arrays have three axes in both dimensions, the second of length 1 in 2D. In place, a transform of 32³
    points stays in a core's cache. The planned transforms are unnormalised.

    Attributes
    ----------
    spectrum : ndarray of complex128, shape (batch, n, n', n/2+1)
    parts : ndarray of float64, shape (batch, n, 2 n' (n/2+1))
        The same memory, real and imaginary parts in turn, all axes but the first as one.
    density : ndarray of float64, shape (batch, n, n', n)
        The same memory, rows padded.
    """

    def __init__(self, batch: int, shape: tuple[int, int, int]) -> None:
        nx, ny, nz = shape
        self.spectrum = pyfftw.zeros_aligned((batch, nx, ny, nz // 2 + 1), dtype="complex128")
        self.parts = self.spectrum.view("float64").reshape(batch, nx, -1)
        self.density = self.spectrum.view("float64")[..., :nz]
        axes = (1, 2, 3) if ny > 1 else (1, 3)
        # FFTW_ESTIMATE: the other planners give different bits from process to process, and gain
        # little.
        plan = {"axes": axes, "flags": ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")}
        self.execute_forward = pyfftw.FFTW(self.density, self.spectrum, **plan).execute
        self.execute_backward = pyfftw.FFTW(
            self.spectrum, self.density, direction="FFTW_BACKWARD", **plan
        ).execute

    def forward(self, density: np.ndarray) -> np.ndarray:
        """f̂ of one density, Σ_k f̂_k e^{..} = f, as a copy."""
        self.density[0] = density
        self.execute_forward()
        return self.spectrum[0] * (1.0 / density.size)

    def backward(self, spectrum: np.ndarray) -> np.ndarray:
        """The density with one spectrum, as a copy."""
        self.spectrum[0] = spectrum
        self.execute_backward()
        return self.density[0].copy()


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
    y = k if ny > 1 else np.zeros(1, dtype=int)
    kept = f_hat[np.ix_(k, y, k[:half])] * turn[:, None, None] * turn[:half]
    out[np.ix_(k, y, k[:half])] = kept * turn[:, None] if ny > 1 else kept
    return out


def unaliased(f_hat: np.ndarray) -> np.ndarray:
    """The modes |k_i| ≤ `KEPT`·N of a half spectrum (N, N', N/2+1), the others zero."""
    N, ny, _ = f_hat.shape
    k = np.abs(np.fft.fftfreq(N, 1 / N)) <= KEPT * N
    y = k if ny > 1 else np.ones(1, dtype=bool)
    return f_hat * (k[:, None, None] & y[:, None] & k[: N // 2 + 1])
