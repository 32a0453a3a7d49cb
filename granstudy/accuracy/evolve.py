"""A density through time, to an accuracy."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from granstudy.accuracy.asked import Accuracy
from granstudy.accuracy.dataset import accuracy_dataset
from granstudy.accuracy.run import Run
from granstudy.accuracy.setup import prepared
from granstudy.datasets.run_dataset import Header
from granstudy.evolution.times import TimeSettings
from granstudy.model.choice import Choice
from granstudy.model.scene import Scene
from granstudy.support.machine import memory, one_blas_thread
from granstudy.support.progress import Progress, watched


@dataclass(frozen=True)
class Limits:
    """What a run may use: wall time in seconds, bytes of memory, threads."""

    seconds: float = float("inf")
    memory: float = float("inf")
    threads: int | None = None


@one_blas_thread()
def evolve_to(
    scene: Scene,
    asked: Accuracy,
    settings: TimeSettings,
    limits: Limits | None = None,
    progress: Progress = None,
) -> xr.Dataset:
    """Advance a scene through time with errors of T and a2 within what is asked.

    Parameters
    ----------
    scene : Scene
    asked : Accuracy
    settings : TimeSettings
        Final time and outputs (`granstudy.accuracy.asked`).
    limits : Limits, optional
    progress : bool or callable, optional
        As of `granstudy.simulate`.

    Returns
    -------
    xarray.Dataset
        `granstudy.accuracy.dataset`.
    """
    limits = limits or Limits()
    t_final = settings.t_final
    allowed_memory = min(limits.memory, memory() or np.inf)
    gas, chooser = prepared(scene, asked, t_final, allowed_memory, limits.threads)
    with (
        np.errstate(over="ignore", invalid="ignore", divide="ignore"),
        watched(progress, len(settings.outputs) - 1) as report,
    ):
        run = Run(chooser, asked, settings.outputs, "dopri54", limits.seconds, report)
        outcome = run.go()
    last = outcome.legs[-1].solver
    frame = "rescaled" if gas.rescaled else "fixed"
    found: dict[str, Any] = {"frame": frame, "t_final": float(t_final)}
    header = Header.of("evolution", scene, Choice(last, last, ""), found)
    return accuracy_dataset(header, asked, outcome, gas.rescaled)
