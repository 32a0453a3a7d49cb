"""A run on a grid between two steps: all that its further course and its dataset depend on."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from granstudy.datasets.run_dataset import Record, columns, rows
from granstudy.evolution.steps import Position
from granstudy.trust.changes import Change
from granstudy.trust.error_estimate import Balance, Memory, Settled


@dataclass(frozen=True)
class Snapshot:
    """A run between two steps.

    Scene, operator, frame and exact rates are not in it: they are made from the run's parameters alone. The
    quadrature in use is the last of the record's plans.

    Attributes
    ----------
    position : Position
        Where the steps stand: time, state and step control.
    memory : Memory
        What the error estimates depend on.
    scale : float
        Scale θ of the frame at the last output.
    record : Record
        All that was recorded.
    """

    position: Position
    memory: Memory
    scale: float
    record: Record

    def plain(self) -> dict[str, Any]:
        """The snapshot as plain data and arrays (`granstudy.datasets.storage.checkpoint`)."""
        memory, record = self.memory, self.record
        balance = memory.balance
        return {
            "position": self.position._asdict(),
            "memory": memory._asdict()
            | {
                "balance": None if balance is None else balance._asdict(),
                "settled": memory.settled._asdict(),
                "stepped": memory.stepped._asdict(),
            },
            "scale": self.scale,
            "times": np.array(record.times),
            "moments": columns(record.moments),
            "health": columns(record.health),
            "kept_at": np.array(list(record.snapshots)),
            "kept": list(record.snapshots.values()),
            "plans": record.plans,
            "warnings": record.warnings,
        }

    @classmethod
    def of(cls, plain: Mapping[str, Any]) -> "Snapshot":
        """The snapshot that `plain` described."""
        memory, balance = plain["memory"], plain["memory"]["balance"]
        parts = {
            "balance": None if balance is None else Balance(**balance),
            "settled": Settled(**memory["settled"]),
            "stepped": Change(**memory["stepped"]),
        }
        record = Record(
            times=plain["times"].tolist(),
            moments=rows(plain["moments"]),
            snapshots=dict(zip(plain["kept_at"].tolist(), plain["kept"], strict=True)),
            health=rows(plain["health"]),
            plans=plain["plans"],
            warnings=plain["warnings"],
        )
        return cls(Position(**plain["position"]), Memory(**memory | parts), plain["scale"], record)
