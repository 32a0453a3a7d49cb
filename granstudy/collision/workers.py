"""Threads that each borrow a workspace: a sum over nodes whose result knows no thread count."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from queue import SimpleQueue
from typing import Generic, TypeVar

Workspace = TypeVar("Workspace")
Share = TypeVar("Share")
Result = TypeVar("Result")

SHARES = 8
"""A sum over nodes is split in this many parts, added up in order whatever the thread count, so that
results do not depend on it."""


class Workers(Generic[Workspace]):
    """A pool of threads and one workspace (buffers, planned transforms) for each."""

    def __init__(self, threads: int, make_workspace: Callable[[], Workspace]) -> None:
        threads = min(threads, SHARES)
        self._workspaces: SimpleQueue[Workspace] = SimpleQueue()
        for _ in range(threads):
            self._workspaces.put(make_workspace())
        self._pool = ThreadPoolExecutor(threads)

    def map(
        self, work: Callable[[Share, Workspace], Result], shares: Sequence[Share]
    ) -> Iterator[Result]:
        """``work(share, workspace)`` of every share, in their order."""

        def borrow(share: Share) -> Result:
            workspace = self._workspaces.get()
            try:
                return work(share, workspace)
            finally:
                self._workspaces.put(workspace)

        # Each in a copy of the caller's context, which says what NumPy does about overflow.
        contexts = [copy_context() for _ in shares]
        return self._pool.map(lambda context, share: context.run(borrow, share), contexts, shares)
