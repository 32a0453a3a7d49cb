"""The fast Fourier spectral operator, method `fast` (docs/method.md §2)."""
