"""The key of a run: a hash over all that its numbers depend on, parameters and code."""

import hashlib
from collections.abc import Sequence

from granstudy.collision.choice.cheapest import choose_method
from granstudy.collision.choice.grid import fit_solver
from granstudy.collision.choice.methods import maker
from granstudy.model.solver import Choice
from granstudy.study.estimates import chosen
from granstudy.study.kinds import KINDS
from granstudy.study.run import Run
from granstudy.support.fingerprint import fingerprint


def run_key(run: Run) -> str:
    """Hash over all that a run's numbers depend on: its parameters and the code that computes it."""
    return run_keys([run])[0]


def run_keys(runs: Sequence[Run]) -> list[str]:
    """`run_key` of each run; code that several runs share is read once."""
    codes = [code_modules(run.model.run, chosen(run)) for run in runs]
    prints = {modules: fingerprint(modules) for modules in set(codes)}
    return [
        hashlib.sha256(f"{run.parameters()}\n{prints[modules]}".encode()).hexdigest()[:32]
        for run, modules in zip(runs, codes, strict=True)
    ]


def code_modules(kind: str, choice: Choice) -> tuple[str, ...]:
    """Modules that compute runs of a kind: the kind's own, the operator's, and those that choose it.

    All that these import belongs to the code of the run too (`granstudy.support.fingerprint`).
    """
    functions = [KINDS[kind].code(choice.solver)]
    if not choice.solver.traits.by_particles:
        functions.append(maker(choice.solver))
    if choice.asked.is_open:
        functions.append(choose_method)
    if choice.asked.N is None:
        functions.append(fit_solver)
    return tuple(function.__module__ for function in functions)


def run_fingerprint(kind: str, choice: Choice) -> str:
    """Fingerprint of the code that computes runs of a kind by a solver."""
    return fingerprint(code_modules(kind, choice))
