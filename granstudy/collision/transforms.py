"""Real Fourier transforms on aligned buffers, planned once."""

from typing import Any

import numpy as np
import pyfftw

BATCH_BYTES = 2**17
"""Small grids are transformed several at a time, one buffer up to this size (it fits a core's cache)."""

REAL: dict[str, np.dtype[Any]] = {"double": np.dtype(np.float64), "single": np.dtype(np.float32)}
"""Real numbers of each precision (`Solver.precision`)."""


def largest_batch(points: int, precision: str = "double") -> int:
    """How many densities of so many points are transformed together at the most."""
    return max(1, BATCH_BYTES // (REAL[precision].itemsize * points))


class RealTransforms:
    """Real transforms of a batch of densities in place, planned once on an aligned buffer.

    In place, a transform of 32³ points stays in a core's cache. Unnormalised. Arrays have three axes in
    both dimensions, the second of length 1 in 2D.

    Attributes
    ----------
    spectrum : complex ndarray, shape (batch, n, n', n/2+1)
    parts : real ndarray, shape (batch, n, 2 n' (n/2+1))
        The same memory, real and imaginary parts in turn, all axes but the first as one.
    density : real ndarray, shape (batch, n, n', n)
        The same memory, rows padded.
    rows : real ndarray, shape (batch, n n', 2 (n/2+1))
        The same memory, all rows with their padding.
    """

    def __init__(self, batch: int, shape: tuple[int, int, int], precision: str = "double") -> None:
        nx, ny, nz = shape
        real = REAL[precision]
        complex_ = np.result_type(real, np.complex64)
        self.spectrum = pyfftw.zeros_aligned((batch, nx, ny, nz // 2 + 1), dtype=complex_)
        self.parts = self.spectrum.view(real).reshape(batch, nx, -1)
        self.density = self.spectrum.view(real)[..., :nz]
        self.rows = self.parts.reshape(batch, nx * ny, -1)
        axes = (1, 2, 3) if ny > 1 else (1, 3)
        # FFTW_ESTIMATE: the other planners give different bits from process to process, and gain
        # little.
        plan = {"axes": axes, "flags": ("FFTW_ESTIMATE", "FFTW_DESTROY_INPUT")}
        self.execute_forward = pyfftw.FFTW(self.density, self.spectrum, **plan).execute
        self.execute_backward = pyfftw.FFTW(
            self.spectrum, self.density, direction="FFTW_BACKWARD", **plan
        ).execute

    def forward(self, density: np.ndarray) -> np.ndarray:
        """Transform one density; the result is a copy."""
        self.density[0] = density
        self.execute_forward()
        return self.spectrum[0].copy()

    def backward(self, spectrum: np.ndarray) -> np.ndarray:
        """Transform one spectrum; the result is a copy."""
        self.spectrum[0] = spectrum
        self.execute_backward()
        return self.density[0].copy()
