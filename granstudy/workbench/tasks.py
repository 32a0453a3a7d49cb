"""What a worker gets: a run, or a call of the user's function, with the key it is kept under."""

import hashlib
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Protocol

import xarray as xr

from granstudy.collision.choice.cheapest import choose_method
from granstudy.collision.choice.grid import fit_solver
from granstudy.collision.choice.methods import OPERATORS
from granstudy.evolution.evolve import evolve
from granstudy.particles.simulation import simulate_particles
from granstudy.runs.computation import Computation
from granstudy.runs.evaluate import evaluate
from granstudy.runs.execute import Outcome, keep, obtain
from granstudy.runs.store import Store
from granstudy.states.solve import cooling_state
from granstudy.support.fingerprint import fingerprint
from granstudy.support.own_code.code import code_of, name_of
from granstudy.theory.cooling import haff_constant
from granstudy.trust.flags import Status, flag_variable


class Task(Protocol):
    """Something to compute, under its key."""

    @property
    def key(self) -> str:
        """Key in the store."""

    @property
    def seconds(self) -> float:
        """Estimated time on one core."""

    def perform(self, store: Store) -> Outcome:
        """Compute it into a store, or find it there."""


@dataclass(frozen=True)
class RunTask:
    """A run.

    Attributes
    ----------
    computation : Computation
    key : str
    seconds : float
    threads : int
    """

    computation: Computation
    key: str
    seconds: float
    threads: int = 1

    def perform(self, store: Store) -> Outcome:
        """Compute the run into a store, or find it there."""
        return obtain(self.computation, self.key, store, self.threads)


@dataclass(frozen=True)
class CallTask:
    """A call of the user's function, which returns a dataset.

    Attributes
    ----------
    function : callable
    arguments : dict
    key : str
    seconds : float
        Estimated time; what a function takes is not known before.
    """

    function: Callable[..., xr.Dataset]
    arguments: Mapping[str, Any]
    key: str
    seconds: float = 1.0

    def perform(self, store: Store) -> Outcome:
        """Call the function and keep what it returns, or find it in the store."""
        return keep(self.key, store, self._call, _failed)

    def _call(self) -> xr.Dataset:
        ds, name = self.function(**self.arguments), name_of(self.function)
        if not isinstance(ds, xr.Dataset):
            raise ValueError(f"{name}: returned {type(ds).__name__}, must return an xarray.Dataset")
        if "status" in ds and ds["status"].values.tolist() not in list(Status):
            raise ValueError(
                f"{name}: its variable 'status' must say how a run ended; give it another name"
            )
        return ds


def call_key(function: Callable[..., Any], arguments: Mapping[str, Any]) -> str:
    """Key of a call: a hash over the function with all its arguments, by their content, and this package.

    Raises
    ------
    ValueError
        If the function or an argument has no content to be known by.
    """
    code = code_of(partial(function, **arguments)).digest
    return hashlib.sha256(f"{code}\n{_package()}".encode()).hexdigest()[:32]


def _package() -> str:
    """Fingerprint of all code that a function may compute with: every kind of run, by every method."""
    rows = OPERATORS.values()
    makers = [make for row in rows for make in (row.make, row.tuned) if make is not None]
    functions = [*makers, evolve, simulate_particles, cooling_state, evaluate, haff_constant]
    functions += [choose_method, fit_solver, _package]
    return fingerprint(list(dict.fromkeys(function.__module__ for function in functions)))


def _failed(reason: str) -> xr.Dataset:
    return xr.Dataset({"status": flag_variable(Status.FAILED, "how the run ended", reason=reason)})


def perform(task: Task, folder: Path) -> Outcome | str:
    """Perform a task into the store of that folder; the cause, as text, where that cannot be done."""
    try:
        return task.perform(Store(folder))
    except Exception as error:
        traceback.print_exc()
        return ": ".join(filter(None, [type(error).__name__, str(error)]))
