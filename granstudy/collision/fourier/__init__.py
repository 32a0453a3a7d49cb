"""Fourier transforms of spectra on grids, planned once and shared among threads."""
