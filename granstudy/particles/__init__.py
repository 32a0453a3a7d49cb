"""Direct simulation by particles, method `dsmc`: a check that shares nothing with a grid."""

from granstudy.particles.dataset import time_average
from granstudy.particles.simulation import simulate_particles

__all__ = ["simulate_particles", "time_average"]
