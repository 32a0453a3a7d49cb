"""A sum over nodes in shares, computed by threads, with a result that does not depend on their number."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from contextvars import copy_context
from typing import Generic, TypeVar

Workspace = TypeVar("Workspace")
Share = TypeVar("Share")
Result = TypeVar("Result")

Bounds = tuple[int, int]
"""Where a share of a sum over nodes starts, and where it stops."""

SHARES = 8
"""Most shares of a sum over nodes. They are added up in order, whatever the thread count, so that results
do not depend on it."""


class Workers(Generic[Workspace]):
    """The caller's thread and a pool of others, each with a workspace: buffers and planned transforms."""

    def __init__(self, threads: int, make_workspace: Callable[[], Workspace]) -> None:
        self._workspaces = [make_workspace() for _ in range(min(threads, SHARES))]
        self._pool = ThreadPoolExecutor(max(1, len(self._workspaces) - 1))

    def map(
        self, work: Callable[[Share, Workspace], Result], shares: Sequence[Share]
    ) -> list[Result]:
        """``work(share, workspace)`` of every share, in order. A free thread takes the next share."""
        waiting = iter(enumerate(shares))
        results: dict[int, Result] = {}

        def take_shares(workspace: Workspace) -> None:
            for index, share in waiting:
                results[index] = work(share, workspace)

        # A copy of the caller's context for each: it says what NumPy does about overflow.
        others = [
            self._pool.submit(copy_context().run, take_shares, workspace)
            for workspace in self._workspaces[1 : len(shares)]
        ]
        try:
            take_shares(self._workspaces[0])
        finally:
            wait(others)
        for other in others:
            other.result()
        return [results[index] for index in range(len(shares))]


def split(count: int, parts: int) -> list[Bounds]:
    """At most ``parts`` shares of ``count`` nodes, of equal size; the last may be smaller."""
    size = max(1, -(-count // parts))
    return [(start, min(start + size, count)) for start in range(0, count, size)]
