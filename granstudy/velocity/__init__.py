"""Velocity grids, the symmetry groups of densities on them, and moments of densities."""
