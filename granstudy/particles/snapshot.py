"""A run by particles between the records of its batches: all that its further course depends on."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from threading import Lock
from typing import Any

import numpy as np

from granstudy.datasets.run_dataset import columns, rows
from granstudy.datasets.storage.checkpoint import Checkpoint, seconds_between
from granstudy.particles.batch import Batch, Gas


@dataclass(frozen=True)
class BatchRecord:
    """All that one batch leaves.

    Attributes
    ----------
    moments : list of dict
        Moments at each time that the batch reached.
    counts : dict of ndarray
        Particles in each cell, by time.
    reason : str
        Why the batch ended early; "" where it did not.
    """

    moments: list[dict[str, Any]] = field(default_factory=list)
    counts: dict[float, np.ndarray] = field(default_factory=dict)
    reason: str = ""

    def plain(self) -> dict[str, Any]:
        """The record as plain data and arrays (`granstudy.datasets.storage.checkpoint`)."""
        return {
            "moments": columns(self.moments),
            "counted_at": np.array(list(self.counts)),
            "counts": list(self.counts.values()),
            "reason": self.reason,
        }

    @classmethod
    def of(cls, plain: Mapping[str, Any]) -> "BatchRecord":
        """The record that `plain` described."""
        counts = zip(plain["counted_at"].tolist(), plain["counts"], strict=True)
        return cls(rows(plain["moments"]), dict(counts), plain["reason"])


class BatchSnapshots:
    """The last states of all batches that have begun, each after a record of its own.

    Batches are independent, so their states need not be of one time.

    Parameters
    ----------
    checkpoint : Checkpoint or None
        Where they are kept; None keeps nothing.
    """

    def __init__(self, checkpoint: Checkpoint | None) -> None:
        self._checkpoint = checkpoint
        self._lock = Lock()
        found = None if checkpoint is None else checkpoint.read()
        self._plain: dict[str, dict[str, Any]] = found or {}
        self._begun = dict(self._plain)
        self._every = seconds_between() / 2  # what is written is then not much older
        self._taken: dict[int, float] = {}
        self._start = time.monotonic()
        self._is_new = False

    def record(self, number: int) -> BatchRecord:
        """What a batch has recorded until its last state; empty for one that has not begun."""
        plain = self._begun.get(str(number))
        return BatchRecord() if plain is None else BatchRecord.of(plain["record"])

    def batch(self, number: int, gas: Gas, rng: np.random.Generator) -> Batch | None:
        """A batch in its last state, or None for one that has not begun; the state of ``rng`` is set too."""
        plain = self._begun.get(str(number))
        if plain is None:
            return None
        rng.bit_generator.state = plain["random"]
        batch = Batch(gas, plain["c"][:, : gas.dim], rng)
        batch.c[:] = plain["c"]
        batch.collisions = plain["collisions"]
        return batch

    def offer(self, number: int, batch: Batch, record: BatchRecord, ended: bool) -> None:
        """Take the state of a batch after a record, if the last one is old; of one that ended, always."""
        if self._checkpoint is None:
            return
        now = time.monotonic()
        if not ended and now - self._taken.get(number, self._start) < self._every:
            return
        self._taken[number] = now
        plain = {
            "c": batch.c[:0].copy() if ended else batch.c.copy(),
            "collisions": int(batch.collisions),
            "random": batch.rng.bit_generator.state,
            "record": record.plain(),
        }
        with self._lock:
            self._plain[str(number)] = plain
            self._is_new = True

    def write(self) -> None:
        """Write the states, if that is due and one of them is new."""
        if self._checkpoint is not None and self._is_new and self._checkpoint.due():
            with self._lock:
                plain, self._is_new = dict(self._plain), False
            self._checkpoint.write(plain)
