"""Tiny gases, and files with gases of one's own."""

from functools import partial

from own_functions import in_file

import granstudy as gs

RADIAL = gs.Solver(N=12, R=7.0, method="radial")
FAST = gs.Solver(N=8, R=7.0, N_rho=4, M_cir=4, method="fast")

SHORT = {"t_final": 0.1, "dt": 0.05}
"""Two steps."""

MY_GAS = """
    import numpy as np


    def anisotropic(vx, vy, ratio=1.0):
        Ty = 2.0 / (1.0 + ratio)
        Tx = ratio * Ty
        return np.exp(-(vx**2) / (2 * Tx) - vy**2 / (2 * Ty)) / (2 * np.pi * np.sqrt(Tx * Ty))


    def softening(v, kappa=0.1):
        return 1.0 / (1.0 + kappa * v)


    def hardening(v, kappa=0.1):
        return 1.0 - kappa / (1.0 + v)
"""

sweep = partial(gs.sweep, workers=1, progress=False)
"""A sweep in this process."""


def my_gas(folder, name="my_gas.py", source=MY_GAS):
    """A file with a density and two laws."""
    return in_file(folder, source, name)


def stored(folder="results"):
    """Names of the runs in the store."""
    return sorted(path.stem for path in (folder / ".runs").glob("??/*.nc"))
