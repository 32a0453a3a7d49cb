"""A sum over nodes in shares, computed by threads, with a result that does not depend on their number."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextvars import copy_context
from threading import RLock
from typing import Any, Generic, TypeVar
from weakref import WeakSet

Workspace = TypeVar("Workspace")
Share = TypeVar("Share")
Result = TypeVar("Result")

Bounds = tuple[int, int]
"""Where a share of a sum over nodes starts, and where it stops."""

SHARES = 8
"""Most shares of a sum over nodes. They are added up in order, whatever the thread count, so that results
do not depend on it."""


class OneAtATime:
    """A lock for buffers that serve one call at a time: ``with self._one_at_a_time: ...``.

    A thread may enter again what it has entered. A forked child finds the lock free, whatever other threads
    of its parent were doing.
    """

    def __init__(self) -> None:
        self.start_anew()
        _of_this_process.add(self)

    def start_anew(self) -> None:
        """Be free: for a process that has just been forked, and has one thread."""
        self._lock = RLock()

    def __enter__(self) -> None:
        self._lock.acquire()

    def __exit__(self, *error: object) -> None:
        self._lock.release()


class Workers(Generic[Workspace]):
    """The caller's thread and a pool of others, each with a workspace: buffers and planned transforms.

    One call of `map` at a time. A forked child has a pool of its own.

    Attributes
    ----------
    workspaces : list
        The caller's workspace first; between calls of `map` nothing uses them.
    """

    def __init__(self, threads: int, make_workspace: Callable[[], Workspace]) -> None:
        self.workspaces = [make_workspace() for _ in range(min(threads, SHARES))]
        self.start_anew()
        _of_this_process.add(self)

    def start_anew(self) -> None:
        """Take a new pool: threads of a process do not live in its forked child."""
        self._pool = ThreadPoolExecutor(max(1, len(self.workspaces) - 1))
        self._at_work: list[Future[None]] = []

    def map(
        self, work: Callable[[Share, Workspace], Result], shares: Sequence[Share]
    ) -> list[Result]:
        """``work(share, workspace)`` of every share, in order. A free thread takes the next share."""
        waiting = iter(enumerate(shares))
        results: dict[int, Result] = {}

        def take_shares(workspace: Workspace) -> None:
            for index, share in waiting:
                results[index] = work(share, workspace)

        wait(
            self._at_work
        )  # after a call that was interrupted twice, threads may still use their workspace
        # A copy of the caller's context for each: it says what NumPy does about overflow.
        self._at_work = [
            self._pool.submit(copy_context().run, take_shares, workspace)
            for workspace in self.workspaces[1 : len(shares)]
        ]
        try:
            take_shares(self.workspaces[0])
        finally:
            wait(self._at_work)
        for other in self._at_work:
            other.result()
        return [results[index] for index in range(len(shares))]


_of_this_process: WeakSet[Any] = WeakSet()
"""Locks and pools that a forked child must start anew."""


planning = RLock()
"""Held by threads that plan with pyfftw. No process is forked meanwhile: a child would wait for ever for
pyfftw's own lock."""


def _after_in_child() -> None:
    planning.release()
    for one in list(_of_this_process):
        one.start_anew()


if hasattr(os, "register_at_fork"):  # not on Windows, which has no fork
    os.register_at_fork(
        before=planning.acquire,
        after_in_parent=planning.release,
        after_in_child=_after_in_child,
    )


def split(count: int, parts: int) -> list[Bounds]:
    """At most ``parts`` shares of ``count`` nodes, of equal size; the last may be smaller."""
    size = max(1, -(-count // parts))
    return [(start, min(start + size, count)) for start in range(0, count, size)]
