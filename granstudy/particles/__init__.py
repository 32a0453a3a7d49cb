"""Direct simulation by particles (DSMC): an independent check of the spectral methods (docs/particles.md)."""

from granstudy.particles.dataset import time_average
from granstudy.particles.simulation import simulate_particles

__all__ = ["simulate_particles", "time_average"]
