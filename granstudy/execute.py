"""Execute one run of a study and write its dataset."""

import time
from dataclasses import replace
from pathlib import Path

import xarray as xr

from granstudy.collision import collision_operator
from granstudy.dataset import collision_dataset, write_dataset
from granstudy.evolve import simulate
from granstudy.study import Run


def execute(run: Run, path: str | Path, threads: int) -> xr.Dataset:
    """Run an ``evolution`` or a ``collision`` point with so many threads; write it to ``path``.

    A run that ends early is written too, with its status: nothing computed is lost.
    """
    solver = replace(run.solver, threads=threads)
    start = time.perf_counter()
    if run.model.time is not None:
        assert run.dt is not None
        ds = simulate(
            run.scene,
            solver,
            t_final=run.model.time.t_final,
            dt=run.dt,
            save_every=run.model.time.save_every,
        )
    else:
        operator = collision_operator(run.scene, solver)
        Q = operator(run.scene.density(operator.grid))
        ds = collision_dataset(run.scene, solver, operator.grid, Q)
    write_dataset(ds, path, duration=time.perf_counter() - start)
    return ds
