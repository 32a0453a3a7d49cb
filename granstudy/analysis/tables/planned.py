"""The table that an experiment will have, before any run: its columns, with 1 for every number.

The functions that make the real table make this one too, so that what they refuse is refused here.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import xarray as xr

from granstudy.analysis.columns import listed
from granstudy.analysis.paper.printed import printed_quantity, with_paper
from granstudy.analysis.source import TableSource
from granstudy.analysis.tables.fits import check_fit
from granstudy.analysis.tables.labels import FLAGS, labels_columns
from granstudy.analysis.tables.labels import NUMBERS as LABELLED
from granstudy.analysis.tables.runs import (
    check_average,
    check_quantity,
    collision_columns,
    evolution_columns,
)
from granstudy.analysis.tables.states import columns_of, state_columns
from granstudy.analysis.tables.truth import AT_THE_END, MEASURES, truth_columns, wants_seconds
from granstudy.datasets.parameters import ABSENT
from granstudy.particles.dataset import COUNTS
from granstudy.study.benchmark.benchmark import benchmark_dataset
from granstudy.study.benchmark.measure import Measurement
from granstudy.study.run import Run, swept_words
from granstudy.study.schema.experiment import EvolutionExperiment
from granstudy.study.schema.words import coordinate
from granstudy.trust.exact_law import has_exact_law
from granstudy.trust.flags import Status
from granstudy.velocity.moments import FRAME, MOMENTS

ON_GRIDS = ("minimum",)
"""Moments that particles do not have."""

SCALARS = tuple(
    name for name, quantity in MOMENTS.items() if not quantity.dimensions and name not in ON_GRIDS
)
"""Moments that are numbers, and that all runs have."""

HAVE: dict[str, tuple[str, Callable[[Run], bool]]] = {
    **dict.fromkeys((*SCALARS, "density_drift"), ("all runs", lambda run: True)),
    **dict.fromkeys(
        ("temperature_error_estimate", "a2_error_estimate"), ("all runs", lambda run: True)
    ),
    **dict.fromkeys(
        (*ON_GRIDS, "mass_drift", "momentum_drift", "edge", "spectral_tail"),
        ("runs on a grid", lambda run: not run.solver.traits.by_particles),
    ),
    "step_ratio": (
        "runs on a grid with dt",
        lambda run: _time(run).dt is not None and not run.solver.traits.by_particles,
    ),
    **dict.fromkeys(
        (name for name, quantity in FRAME.items() if not quantity.dimensions),
        ("runs with frame rescaled", lambda run: _time(run).rescaled),
    ),
    **dict.fromkeys(
        (
            f"{name}_{ending}"
            for name in ("temperature", "paper_temperature")
            for ending in ("exact", "error")
        ),
        (
            "Maxwell molecules (exponent 0) with constant e",
            lambda run: has_exact_law(run.scene),
        ),
    ),
    **dict.fromkeys(
        (*COUNTS, *(f"{name}_standard_error" for name in (*SCALARS, *COUNTS))),
        ("runs of method dsmc", lambda run: run.solver.traits.by_particles),
    ),
}
"""Numbers at the end of an evolution: of which runs, in words, and whether a run has it."""


def planned_table(source: TableSource) -> xr.Dataset:
    """The table that `granstudy.analysis.tables.table.experiment_table` will make, every number 1.

    Raises
    ------
    ValueError
        One line for a quantity, an average, a printed table, a fit, or other experiments beside, that the
        runs do not fit; it begins with the field.
    """
    experiment, asked = source.experiment, source.experiment.table
    table = _PLANNED[experiment.run](source)
    table.attrs |= {"quantity": source.quantity, "title": experiment.title}
    check_fit(table, source)
    if experiment.fit is not None and experiment.fit.law == "haff":
        table = table.assign(C0=_ones(table.sizes["run"]))
    if asked is not None and asked.paper is not None:
        try:
            table = with_paper(table, asked.paper, printed_quantity(asked.paper, source.quantity))
        except ValueError as error:
            text = str(error)
            where = "table." if text.startswith("paper=") else "table.paper: "
            raise ValueError(f"{where}{text}") from None
    return table


def _evolution(source: TableSource) -> xr.Dataset:
    assert isinstance(source.experiment, EvolutionExperiment)
    asked, rows = source.experiment.table, source.rows
    if source.experiment.has_truth:
        if asked is not None and asked.average is not None:
            raise ValueError("table.average: not beside a truth; leave one of them out")
        measured = (*MEASURES, "seconds") if wants_seconds(source) else MEASURES
        ones = dict.fromkeys(measured, [1.0] * len(rows))
        table = truth_columns(source, _values(source, AT_THE_END), ones, ["a truth"])
        _check(source.quantity, table)
        return table
    runs = [run for run, _ in rows]
    there = [name for name, (_, has) in HAVE.items() if any(map(has, runs))]
    last = _values(source, there)
    averages: dict[str, Any] = {}
    if asked is not None and asked.average is not None:
        check_average(rows, asked.average)
        averages = {
            f"{name}{ending}": _ones(len(rows))
            for name in asked.average.of
            for ending in ("", "_standard_error")
        }
    _check(source.quantity, last)
    return evolution_columns(source, last, averages)


def _check(quantity: str, table: xr.Dataset) -> None:
    """Raise ValueError unless runs have the quantity: says which have it, where the name is right."""
    whose, has = HAVE.get(quantity, ("", None))
    if quantity not in table and has is not None and whose != "all runs":
        raise ValueError(f"table.quantity={quantity!r}: only {whose} have it")
    kept = [name for name in table.data_vars if _is_listed(str(name))]
    try:
        check_quantity(quantity, table[kept])
    except ValueError as error:
        raise ValueError(f"table.quantity: {error}") from None


def _is_listed(name: str) -> bool:
    try:
        return bool(listed(name))
    except ValueError:
        return False


def _collision(source: TableSource) -> xr.Dataset:
    count = len(source.rows)
    table = collision_columns(source, _values(source, ()), np.ones(count), np.ones(count))
    _check(source.quantity, table)
    return table


def _benchmark(source: TableSource) -> xr.Dataset:
    rows = [
        Measurement(run, 1, seconds=1.0, fft_seconds=1.0, transforms=1, error=1.0)
        for run, _ in source.rows
    ]
    table = benchmark_dataset(rows)
    table.attrs["swept"] = " ".join(
        str(name) for name, c in table.coords.items() if c.dims == ("run",)
    )
    _check(source.quantity, table)
    return table


def _state(source: TableSource) -> xr.Dataset:
    try:
        return state_columns(source, _values(source, columns_of(source)))
    except ValueError as error:
        text = str(error)
        raise ValueError(text if text.startswith("table.") else f"table.quantity: {text}") from None


def _labels(source: TableSource) -> xr.Dataset:
    count = len(source.rows)
    flags = {name: ("run", np.zeros(count, np.int8)) for name in FLAGS}
    numbers = xr.Dataset(flags | {name: _ones(count) for name in LABELLED})
    others: dict[str, list[Any]] = {"truth": [""] * count, "seconds": [1.0] * count}
    table = labels_columns(source.rows, numbers, others)
    _check(source.quantity, table)
    return table


_PLANNED: dict[str, Callable[[TableSource], xr.Dataset]] = {
    "evolution": _evolution,
    "collision": _collision,
    "benchmark": _benchmark,
    "state": _state,
    "labels": _labels,
}


def _values(source: TableSource, names: Iterable[str]) -> xr.Dataset:
    """What `granstudy.datasets.open_runs.final_values` will give: numbers by name, every parameter."""
    rows = source.rows
    first = rows[0].run
    count = len(rows)
    coords: dict[str, Any] = {
        name: ("run", np.full(count, value, dtype=object if isinstance(value, str) else None))
        for name, value in _coordinates(first).items()
        if value is not None
    }
    for word in swept_words(run for run, _ in rows):
        name = coordinate(word)
        coords |= _swept(name, [_value(run, word, name) for run, _ in rows])
    data = {name: _ones(count) for name in names}
    flags = {"status": int(Status.OK), "trust": 0}
    return xr.Dataset(
        data | {name: ("run", np.full(count, value, np.int8)) for name, value in flags.items()},
        coords,
    )


def _swept(name: str, values: list[Any]) -> dict[str, Any]:
    """A swept parameter over ``run``; a pair of M_sph as its product and its factors."""
    if name == "M_sph" and any(isinstance(value, list) for value in values):
        pairs = [value if isinstance(value, list) else [value, 1] for value in values]
        parts = {"N_theta": [pair[0] for pair in pairs], "N_phi": [pair[-1] for pair in pairs]}
        parts["M_sph"] = [int(np.prod(pair)) for pair in pairs]
        return {part: ("run", np.array(column)) for part, column in parts.items()}
    values = [ABSENT.get(name, "") if value is None else value for value in values]
    if all(isinstance(value, int | float) for value in values):
        return {name: ("run", np.array(values))}
    return {name: ("run", np.array([str(value) for value in values], dtype=object))}


def _value(run: Run, word: str, name: str) -> Any:
    """A run's value of a swept word, whether or not its block sweeps it; None where it has none."""
    swept = dict(run.values)
    return swept[word] if word in swept else _coordinates(run).get(name)


def _coordinates(run: Run) -> dict[str, Any]:
    """The parameters of a run that its dataset has as coordinates."""
    on_grid = run.time is not None and not run.solver.traits.by_particles
    times = _time(run).coordinates() if on_grid else {}
    return {**run.scene.coordinates(), **run.solver.coordinates(run.scene.dim), **times}


def _ones(count: int) -> Any:
    return "run", np.ones(count)


def _time(run: Run) -> Any:
    assert run.time is not None
    return run.time
