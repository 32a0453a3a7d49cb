"""Grids of velocities that densities live on, the symmetries that densities have there, and their moments."""
