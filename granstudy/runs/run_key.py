"""The key of a run: a hash over all that its numbers depend on, parameters and code."""

import hashlib
import itertools
from collections.abc import Iterable, Sequence

from granstudy.collision.choice.cheapest import choose_method
from granstudy.collision.choice.grid import fit_solver
from granstudy.collision.choice.methods import maker
from granstudy.collision.fast.adaptive.operator import AdaptiveOperator
from granstudy.model.choice import Choice
from granstudy.model.solver import Solver
from granstudy.runs.computation import Computation, ladder
from granstudy.runs.estimates import chosen
from granstudy.runs.kinds import KINDS
from granstudy.runs.refinement import refined
from granstudy.support.fingerprint import fingerprint


def run_key(computation: Computation) -> str:
    """Hash over all that a run's numbers depend on: its parameters and the code that computes it."""
    return run_keys([computation])[0]


def run_keys(computations: Sequence[Computation]) -> list[str]:
    """`run_key` of each run; code that several runs share is read once."""
    codes = [code_of_run(computation) for computation in computations]
    prints = {modules: fingerprint(modules) for modules in set(codes)}
    return [
        hashlib.sha256(f"{computation.parameters}\n{prints[modules]}".encode()).hexdigest()[:32]
        for computation, modules in zip(computations, codes, strict=True)
    ]


def rung_keys(computations: Iterable[Computation]) -> list[str]:
    """Keys of the runs that runs with a refinement may go through; none of runs without one."""
    rungs = [rung for one in computations if one.refinement is not None for rung in ladder(one)]
    return run_keys(rungs)


def code_of_run(computation: Computation) -> tuple[str, ...]:
    """Modules that a run uses (`code_modules`)."""
    modules = code_modules(computation.kind, chosen(computation))
    if computation.refinement is not None:
        modules = (*modules, refined.__module__)
    parts = [code_of_run(part) for part in KINDS[computation.kind].parts(computation)]
    return tuple(dict.fromkeys(itertools.chain(modules, *parts)))


def code_modules(kind: str, choice: Choice) -> tuple[str, ...]:
    """Modules that compute runs of a kind: the kind's own, the operator's, and those that choose it.

    All that these import belongs to the code of the run too (`granstudy.support.fingerprint`).
    """
    if choice.asked.accuracy is not None:
        made_by = (maker(Solver(N=4, R=1.0, method="radial")), AdaptiveOperator)
        computed_by = KINDS[kind].to_accuracy
        assert computed_by is not None  # the run has been checked
        return tuple(function.__module__ for function in (computed_by, *made_by))
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
