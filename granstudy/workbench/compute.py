"""Many runs computed here, or by the workers of a Dask cluster, each into the store."""

import logging
import signal
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from granstudy.runs.execute import Outcome
from granstudy.runs.store import Store
from granstudy.support.machine import cores
from granstudy.support.progress import kind_of_bar, person_watches
from granstudy.workbench.tasks import Task, perform

if TYPE_CHECKING:
    from distributed import Client

HERE = 3.0
"""Seconds of estimated work that is done in this process: starting others would take as long."""

BATCH = 5.0
"""Seconds of estimated work that a worker gets at once, at most."""

BATCHES = 3
"""Batches a worker that the work is divided into, so that one long batch keeps no worker waiting."""


@dataclass(frozen=True)
class Failure:
    """A point that could not be computed, for a cause that is not its own (no memory, no space)."""

    key: str
    cause: str


def compute(
    tasks: Sequence[Task],
    store: Store,
    *,
    client: "Client | None" = None,
    workers: int | None = None,
    progress: bool | None = None,
) -> dict[str, Outcome | Failure]:
    """Compute what the store does not have yet.

    Parameters
    ----------
    tasks : sequence of Task
    store : Store
    client : distributed.Client, optional
        Cluster whose workers compute, which must see the store's folder. Default, without ``workers``: the
        client of this process, if it has one; else work of seconds is done here, and more by a local cluster.
    workers : int, optional
        Processes of the local cluster; by default as many as this process has cores. 1 computes here.
    progress : bool, optional
        Show a bar with the time left. Default: where a person watches.

    Returns
    -------
    dict
        Key ↦ what became of the run.

    Raises
    ------
    KeyboardInterrupt
        If a person stops it. All runs that were done by then are in the store.
    """
    there = store.keys()
    left = list({task.key: task for task in tasks if task.key not in there}.values())
    found: dict[str, Outcome | Failure] = {}
    if not left:
        return found
    seconds = sum(task.seconds for task in left)
    hidden = not (person_watches() if progress is None else progress)
    with kind_of_bar()(total=seconds, disable=hidden, bar_format=BAR, unit="s") as bar:
        bar.set_postfix_str(f"0 of {len(left)} runs")
        try:
            with _cluster(client, workers, seconds, len(left)) as cluster:
                for task, result in _results(left, store, cluster):
                    found[task.key] = result
                    bar.update(min(task.seconds, seconds - bar.n))
                    bar.set_postfix_str(f"{len(found)} of {len(left)} runs")
        except KeyboardInterrupt:
            done = sum(task.key in store for task in left)
            raise KeyboardInterrupt(
                f"stopped: {done} of {len(left)} runs are done and kept; the same call goes on"
            ) from None
    return found


BAR = "{l_bar}{bar}| {postfix}, about {remaining} left"
"""The bar moves by estimated seconds, so that the time left is right where runs differ in cost."""


@contextmanager
def _cluster(
    client: "Client | None", workers: int | None, seconds: float, runs: int
) -> Iterator["Client | None"]:
    """The client that computes; None where this process does."""
    client = client or (_client() if workers is None else None)
    if client is not None:
        yield client
        return
    count = min(workers or cores(), runs)
    if count == 1 or (workers is None and seconds < HERE):
        yield None
        return
    from distributed import Client, LocalCluster  # a second, which few need

    with (
        LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            dashboard_address=":0",
            silence_logs=logging.CRITICAL,  # workers that are told to end, and take their time
        ) as cluster,
        Client(cluster) as made,
    ):
        made.run(_leave_interrupts)
        yield made


async def _leave_interrupts() -> None:
    """Let a worker of this machine leave ^C, which a terminal sends to it too, to the process that began it.

    It is a coroutine so that it runs in the worker's main thread, as signals ask for.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _client() -> "Client | None":
    """The client of this process; None where it has none."""
    if "distributed" not in sys.modules:
        return None
    from distributed import get_client

    try:
        return get_client()
    except ValueError:
        return None


def _results(
    tasks: Sequence[Task], store: Store, client: "Client | None"
) -> Iterator[tuple[Task, Outcome | Failure]]:
    """What becomes of each task, as it is done."""
    if client is None:
        for task in tasks:
            yield task, _outcome(task.key, perform(task, store.folder))
        return
    from distributed import as_completed

    folder = store.folder.resolve()  # workers may stand in other folders
    futures = {
        client.submit(_perform_all, batch, folder, pure=False): batch
        for batch in _batches(tasks, len(client.scheduler_info(n_workers=-1)["workers"]))
    }
    try:
        for future in as_completed(list(futures)):
            batch = futures[future]
            answers = (
                future.result()
                if future.status == "finished"
                else [_after_loss(task, store, f"{future.exception()!r}") for task in batch]
            )
            for task, answer in zip(batch, answers, strict=True):
                yield task, _outcome(task.key, answer)
    finally:
        client.cancel(list(futures))


def _after_loss(task: Task, store: Store, cause: str) -> Outcome | str:
    """What a batch whose workers died left of a task: its run, or the cause."""
    return perform(task, store.folder) if task.key in store else cause


def _batches(tasks: Sequence[Task], workers: int) -> list[list[Task]]:
    """Tasks in groups of some seconds, the longest task first."""
    share = min(BATCH, sum(task.seconds for task in tasks) / (BATCHES * max(1, workers)))
    batches: list[list[Task]] = []
    seconds = share
    for task in sorted(tasks, key=lambda task: -task.seconds):
        if seconds >= share:
            batches.append([])
            seconds = 0.0
        batches[-1].append(task)
        seconds += task.seconds
    return batches


def _perform_all(tasks: Sequence[Task], folder: Path) -> list[Outcome | str]:
    return [perform(task, folder) for task in tasks]


def _outcome(key: str, answer: Outcome | str) -> Outcome | Failure:
    return Failure(key, answer) if isinstance(answer, str) else answer
