"""Computing runs, each into the store, once."""

import logging
import time
import traceback
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import xarray as xr

from granstudy.datasets.netcdf import read_dataset
from granstudy.datasets.run_dataset import Ending, Header, stamped
from granstudy.datasets.storage.checkpoint import CheckpointError
from granstudy.runs.computation import Computation
from granstudy.runs.estimates import chosen
from granstudy.runs.kinds import KINDS
from granstudy.runs.refinement import refined
from granstudy.runs.run_key import run_key
from granstudy.runs.store import Store
from granstudy.support.progress import Progress
from granstudy.trust.flags import Status, Trust, flag_variable, flag_word

log = logging.getLogger(__name__)

CAUSES = (ValueError, ArithmeticError)
"""Errors that a run's own parameters cause, so that it would fail again (LinAlgError among them). Such a run
is kept as failed. Any other error (no memory, no space) is the machine's, and nothing is kept."""


@dataclass(frozen=True)
class Outcome:
    """What became of a run.

    Attributes
    ----------
    key : str
    computed : bool
        Whether it was computed now; else it was in the store.
    seconds : float
        Wall time of the computation; 0 for a run that was there.
    status : str
        How the run ended, in a word: ok, failed, diverged.
    trust : str
        Its label in a word; "" for a run without one.
    reason : str
        Why it ended early; "" where it did not.
    """

    key: str
    computed: bool
    seconds: float
    status: str
    trust: str
    reason: str

    @property
    def label(self) -> str:
        """The label of a run that ended well, else ``failed``; ``unlabelled`` for a run without a label."""
        return (self.trust or "unlabelled") if self.status == "ok" else "failed"


def execute(
    computation: Computation,
    threads: int,
    progress: Progress = False,
    checkpoint: Path | None = None,
) -> xr.Dataset:
    """Compute a run with so many threads, outside of any store.

    A run that ends early is a dataset too, with its status: nothing computed is lost.

    Parameters
    ----------
    checkpoint : Path, optional
        File that a long run goes on from, and that it is written to while it is computed.

    Raises
    ------
    CheckpointError
        If the checkpoint is that of another run.
    ValueError
        For a benchmark's run: those are computed together (`granstudy.study.benchmark.benchmark`).
    """
    compute = KINDS[computation.kind].compute
    if compute is None:
        raise ValueError(
            f"run={computation.kind!r}: all runs of an experiment are computed together"
        )
    return compute(computation, replace(computation.solver, threads=threads), progress, checkpoint)


def obtain(
    computation: Computation,
    key: str,
    store: Store,
    threads: int = 1,
    progress: Progress = False,
) -> Outcome:
    """The outcome of a run: out of the store, or computed now and kept there.

    A run that was interrupted goes on from its checkpoint in the store. One that cannot be used is deleted,
    which the log says.

    Parameters
    ----------
    key : str
        `granstudy.runs.run_key.run_key` of the run.
    progress : bool, callable or None
        As of `granstudy.simulate`.

    Raises
    ------
    ChangedError
        If the key is another one: what the run depends on changed since the key was taken.
    """

    def make() -> xr.Dataset:
        if run_key(computation) != key:
            raise ChangedError(
                "the study or the code changed since the work was planned; start it again"
            )
        if computation.refinement is not None:
            return refined(computation, _in_store(store, threads, progress))
        checkpoint = store.checkpoint(key)
        try:
            return execute(computation, threads, progress, checkpoint)
        except CheckpointError as error:
            log.warning("%s. It is deleted, and the run starts anew", error)
            checkpoint.unlink(missing_ok=True)
            return execute(computation, threads, progress, checkpoint)

    def failed(reason: str) -> xr.Dataset:
        return failed_dataset(computation, reason)

    return keep(key, store, make, failed, parameters=computation.parameters)


class ChangedError(ValueError):
    """What a run depends on changed since its key was taken."""


def keep(
    key: str,
    store: Store,
    make: Callable[[], xr.Dataset],
    failed: Callable[[str], xr.Dataset],
    **attributes: str,
) -> Outcome:
    """The outcome of a dataset under its key: out of the store, or made now and kept there.

    Where another process makes the same dataset, this one waits for it.

    Parameters
    ----------
    make : callable
        Makes the dataset.
    failed : callable
        Reason ↦ the dataset that stands for one that cannot be made (`CAUSES`).
    attributes : str
        Attributes that the kept dataset gets.
    """
    there = store.read(key)
    if there is not None:
        return _outcome(key, there, None)
    with store.claim(key):
        there = store.read(key)  # which may have come while this process waited
        if there is not None:
            return _outcome(key, there, None)
        start = time.perf_counter()
        ds = made(make, failed)
        seconds = time.perf_counter() - start
        store.write(key, ds.assign_attrs(attributes), seconds)
        return _outcome(key, ds, seconds)


def made(make: Callable[[], xr.Dataset], failed: Callable[[str], xr.Dataset]) -> xr.Dataset:
    """What ``make`` makes; where it cannot for `CAUSES`, what ``failed`` makes of the reason."""
    try:
        return make()
    except ChangedError:
        raise
    except CAUSES as error:
        traceback.print_exc()
        return failed(f"{type(error).__name__}: {error}")


def _in_store(
    store: Store, threads: int, progress: Progress
) -> Callable[[Computation], xr.Dataset]:
    """Computation ↦ its dataset, kept in the store."""

    def compute(computation: Computation) -> xr.Dataset:
        key = run_key(computation)
        obtain(computation, key, store, threads, progress)
        ds = store.read(key)
        assert ds is not None
        return ds

    return compute


def failed_dataset(computation: Computation, reason: str) -> xr.Dataset:
    """The dataset of a run that failed before it had any numbers: its parameters, status and cause."""
    choice = chosen(computation)
    times = {} if computation.time is None else computation.time.coordinates()
    header = Header.of(computation.kind, computation.scene, choice, times)
    trust = flag_variable(Trust.UNTRUSTED, "how far to believe T and a2", reasons=reason)
    ds = stamped(xr.Dataset({"trust": trust}), header, Ending(Status.FAILED, reason))
    return ds if computation.solver.N is not None else ds.drop_vars(["N", "R"])


def label_of(path: Path) -> str:
    """Label of a run in a file (`Outcome.label`)."""
    return _outcome("", read_dataset(path), None).label


def _outcome(key: str, ds: xr.Dataset, seconds: float | None) -> Outcome:
    return Outcome(
        key=key,
        computed=seconds is not None,
        seconds=seconds or 0.0,
        status=flag_word("status", ds["status"]) if "status" in ds else "ok",
        trust=flag_word("trust", ds["trust"]) if "trust" in ds else "",
        reason=str(ds["status"].attrs.get("reason", "")) if "status" in ds else "",
    )
