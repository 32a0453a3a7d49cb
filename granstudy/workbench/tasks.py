"""What a worker gets: a run, or a call of the user's function, with the key it is kept under."""

import hashlib
import json
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import xarray as xr

from granstudy.evolution.evolve import evolve
from granstudy.runs.computation import Computation
from granstudy.runs.execute import Outcome, keep, obtain
from granstudy.runs.store import Store
from granstudy.states.solve import cooling_state
from granstudy.support.fingerprint import fingerprint
from granstudy.support.own_code.code import code_of
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
        ds = self.function(**self.arguments)
        if not isinstance(ds, xr.Dataset):
            raise ValueError(
                f"{getattr(self.function, '__name__', self.function)}: returned {type(ds).__name__}, "
                "must return an xarray.Dataset"
            )
        return ds


def call_keys(
    function: Callable[..., Any], points: list[dict[str, Any]], fixed: Mapping[str, Any]
) -> list[str]:
    """Key of a call at each point: a hash over the function's code, its arguments, and this package."""
    code = code_of(function).digest
    package = fingerprint([evolve.__module__, cooling_state.__module__, __name__])
    keys = []
    for point in points:
        described = json.dumps({**fixed, **point}, sort_keys=True, default=_plain)
        keys.append(hashlib.sha256(f"{code}\n{described}\n{package}".encode()).hexdigest()[:32])
    return keys


def _plain(value: Any) -> Any:
    """NumPy's numbers and arrays as Python's; other things by their code or their text."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return code_of(value).digest if callable(value) else repr(value)


def _failed(reason: str) -> xr.Dataset:
    return xr.Dataset({"status": flag_variable(Status.FAILED, "how the run ended", reason=reason)})


def perform(task: Task, folder: Path) -> Outcome | str:
    """Perform a task into the store of that folder; the cause, as text, where that cannot be done."""
    try:
        return task.perform(Store(folder))
    except Exception as error:
        traceback.print_exc()
        return f"{type(error).__name__}: {error}"
