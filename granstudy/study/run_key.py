"""The key of a run: a hash over all that its numbers depend on, parameters and code."""

import hashlib

from granstudy.collision.operator import OPERATORS
from granstudy.study.run import Run
from granstudy.support.fingerprint import fingerprint


def run_key(run: Run) -> str:
    """Hash over all that a run's numbers depend on: its parameters and the code that computes it."""
    chooses = ("granstudy.collision.choice.cheapest",) if run.solver.is_open else ()
    if run.solver.N is None:
        chooses += ("granstudy.collision.choice.grid",)
    code = run_fingerprint(run.model.run, run.choice.solver.operator, chooses)
    return hashlib.sha256(f"{run.parameters()}\n{code}".encode()).hexdigest()[:32]


PARTICLES = "granstudy.particles.simulation"
"""What computes the runs of `dsmc`, which has no operator."""


def run_fingerprint(kind: str, operator: str, also: tuple[str, ...] = ()) -> str:
    """Fingerprint of the modules behind an ``evolution``, ``collision`` or ``state`` run with an operator.

    ``operator`` is `Solver.operator`: the method, or ``adaptive`` where it has a tolerance; ``also``
    are modules that choose it.
    """
    entry = {
        "evolution": "granstudy.evolution.evolve",
        "collision": "granstudy.datasets.run_dataset",
        "state": "granstudy.states.solve",
    }[kind]
    method = PARTICLES if operator == "dsmc" else OPERATORS[operator][0]
    return fingerprint((entry, "granstudy.collision.operator", method, *also))
