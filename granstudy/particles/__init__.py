"""Direct simulation by particles, method `dsmc`: an independent check (docs/particles.md)."""

from granstudy.particles.dataset import time_average
from granstudy.particles.simulation import simulate_particles

__all__ = ["simulate_particles", "time_average"]
