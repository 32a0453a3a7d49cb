"""Real Fourier transforms on aligned buffers, planned once."""

from typing import Any

import numpy as np
import pyfftw

from granstudy.collision.fourier import fftw, wisdom

REAL: dict[str, np.dtype[Any]] = {"double": np.dtype(np.float64), "single": np.dtype(np.float32)}
"""Type of real numbers for each precision (`Solver.precision`)."""

CACHE_LINE = 64
"""Size of a cache line in bytes."""


def aligned_zeros(shape: tuple[int, ...], dtype: Any) -> np.ndarray:
    """Zeros that begin at the start of a cache line, so that no vector load crosses two lines."""
    return np.asarray(pyfftw.zeros_aligned(shape, dtype=dtype, n=CACHE_LINE))


class RealTransforms:
    """Real transforms in place, unnormalised, planned once on an aligned buffer.

    In place, a transform of 32³ points stays in a core's cache. Arrays have three axes in both dimensions;
    in 2D the second has length 1. Four arrays share the buffer:

    Attributes
    ----------
    spectrum : complex ndarray, shape (n, n', n/2+1)
        The half spectrum.
    parts : real ndarray, shape (n, 2 n' (n/2+1))
        Its real and imaginary parts in turn, all axes but the first as one.
    density : real ndarray, shape (n, n', n)
        The density, whose rows are padded.
    rows : real ndarray, shape (n n', 2 (n/2+1))
        The density's rows with their padding.
    plans : ndarray
        Plans of both transforms, for compiled loops (`granstudy.collision.fourier.fftw`).
    wisdom : str
        Hash of the wisdom that FFTW planned with; "" where it had none.
    """

    def __init__(self, shape: tuple[int, int, int], precision: str = "double") -> None:
        nx, ny, nz = shape
        real = REAL[precision]
        complex_ = np.result_type(real, np.complex64)
        self.spectrum = aligned_zeros((nx, ny, nz // 2 + 1), complex_)
        self.parts = self.spectrum.view(real).reshape(nx, -1)
        self.density = self.spectrum.view(real)[..., :nz]
        self.rows = self.parts.reshape(nx * ny, -1)
        planner = wisdom.planner()
        self.plans = fftw.for_buffer(planner.plans(self.spectrum, nz), self.spectrum)
        self.wisdom = planner.wisdom.digest

    @property
    def made(self) -> int:
        """Number of transforms made so far."""
        return int(self.plans[fftw.MADE])

    def execute_forward(self) -> None:
        """Transform the density in place."""
        fftw.execute(self.plans, fftw.FORWARD)

    def execute_backward(self) -> None:
        """Transform the spectrum in place."""
        fftw.execute(self.plans, fftw.BACKWARD)

    def forward(self, density: np.ndarray) -> np.ndarray:
        """Spectrum of ``density``, as a copy."""
        self.density[...] = density
        self.execute_forward()
        return self.spectrum.copy()

    def backward(self, spectrum: np.ndarray) -> np.ndarray:
        """Density of ``spectrum``, as a copy."""
        self.spectrum[...] = spectrum
        self.execute_backward()
        return self.density.copy()
