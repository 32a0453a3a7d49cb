"""Sizes that no machine, or not this one, can hold: refused by a run's numbers alone, before any work."""

import math
import os
from functools import cache

import psutil

from granstudy.evolution.times import NUMBERS_AN_OUTPUT
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation
from granstudy.runs.estimates import estimate_run

MOST = {
    "N": 100_000,
    "N_rho": 10_000,
    "M_sph": 100_000,
    "M_cir": 100_000,
    "batches": 1_000_000,
    "particles": 10**13,
}
"""Sizes of a solver at most, a thousand times what a study needs; `M_sph` as a pair by its product."""

NUMBERS_A_NODE = 10
"""Numbers that a run on a Cartesian grid keeps for each node at least."""

MEMORY = "GRANSTUDY_MEMORY_GB"
"""Environment variable: gigabytes of the machine that computes the runs, where it is another one."""


def check_size(computation: Computation) -> None:
    """Raise ValueError where a run has more nodes, steps or outputs than a machine can hold.

    Everything here is arithmetic: nothing of the run's size is allocated.

    Raises
    ------
    ValueError
        Names the field, its value and what is allowed, or the memory that the run would take.
    """
    _check_counts(computation.solver)
    time = computation.time
    if time is not None and time.dt is not None:
        outputs = 8.0 * NUMBERS_AN_OUTPUT * time.steps
        _check_memory(f"t_final={time.t_final!r}, dt={time.dt!r}", outputs / 2**20)
    solver, dim = computation.solver, computation.scene.dim
    if solver.N is not None and not solver.traits.radial:
        _check_memory(_fields(computation), 8.0 * NUMBERS_A_NODE * solver.N**dim / 2**20)


def check_estimate(computation: Computation) -> None:
    """Raise ValueError where a run would take more memory than the machine has, by its estimated cost."""
    _check_memory(_fields(computation), estimate_run(computation).cost.memory_mb)


def _check_counts(solver: Solver) -> None:
    for name, most in MOST.items():
        value = getattr(solver, name)
        size = math.prod(value) if isinstance(value, tuple | list) else value
        if size is not None and size > most:
            raise ValueError(f"{name}={value!r}: must be {most:,} at most")


def _fields(computation: Computation) -> str:
    solver = computation.solver
    return f"N={solver.N!r}, method={solver.method!r}"


def _check_memory(fields: str, memory_mb: float) -> None:
    there = machine_memory_mb()
    if memory_mb > there:
        raise ValueError(
            f"{fields}: the run would take {memory_mb / 1024:,.1f} GB; this "
            f"machine has {there / 1024:,.1f} GB (set {MEMORY} where another one computes)"
        )


def machine_memory_mb() -> float:
    """Megabytes of the machine that computes the runs.

    Raises
    ------
    ValueError
        If the environment variable `MEMORY` is no positive number.
    """
    said = os.environ.get(MEMORY)
    return _physical_mb() if said is None else _stated_mb(said)


@cache
def _physical_mb() -> float:
    """Megabytes of this machine; asked once, as runs are checked by the thousand."""
    return psutil.virtual_memory().total / 2**20


def _stated_mb(said: str) -> float:
    """Megabytes that the environment states."""
    try:
        gigabytes = float(said)
    except ValueError:
        gigabytes = 0.0
    if not 0.0 < gigabytes < float("inf"):
        raise ValueError(
            f"{MEMORY}={said!r}: must be a positive number, the gigabytes of a machine"
        )
    return 1024.0 * gigabytes
