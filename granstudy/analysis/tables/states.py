"""Tables of states: numbers that were solved for, beside theory and beside other experiments."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.analysis.columns import column, computed
from granstudy.analysis.groups import keys
from granstudy.analysis.source import Row, TableSource
from granstudy.analysis.tables.runs import check_quantity, with_swept
from granstudy.datasets.open_runs import final_values
from granstudy.study.run import Run
from granstudy.study.schema.experiment import StateExperiment
from granstudy.support.variables import Variable, labelled

COMPARED = {"cooling": ("a2",), "heated": ("a2", "temperature")}
"""Quantities compared with other experiments; a cooling state has no temperature of its own."""

LINEAR: dict[str, dict[str, Callable[[float, int, float], float]]] = {
    "cooling": {"a2_linear": theory.cooling_state_a2, "a2_divided": theory.montanero_santos_a2},
    "heated": {"a2_linear": theory.heated_state_a2},
}
"""Theories linear in a2 by column (`granstudy.theory`), for gases other than Maxwell molecules."""

EXACT_MOMENTS = {
    "cooling": theory.maxwell_cooling_moments,
    "heated": theory.maxwell_heated_moments,
}
"""Exact even moments of Maxwell molecules."""


def state_table(source: TableSource) -> xr.Dataset:
    """A row for each state, its columns in reading order.

    Columns: `a2`, theories of it, other experiments' a2; for heated states the same of `temperature`; `a3`,
    `cooling_coefficient`, `estimated_a2_error`, the label `trust`, `status`. The attribute `state` is
    ``cooling`` or ``heated``; `beside` names the other experiments.

    Raises
    ------
    ValueError
        If the runs do not have the quantity, or another's table does not fit.
    """
    return state_columns(source, final_values([file for _, file in source.rows]))


NUMBERS = ("temperature", "a2", "a3", "cooling_coefficient", "a2_error_estimate")
"""Variables of states that their table has."""

ACCURATE = {
    "temperature": "temperature",
    "a2": "a2",
    "a3": "a3",
    "cooling_coefficient": "cooling_coefficient",
    "a2_error": "estimated_a2_error",
    "a3_error": "estimated_a3_error",
    "cooling_coefficient_error": "estimated_cooling_coefficient_error",
    "tail_rate": "tail_rate",
    "tail_rate_error": "tail_rate_error",
    "far_slope": "far_slope",
    "far_slope_error": "far_slope_error",
    "far_speed": "far_speed",
}
"""Variables of states to an accuracy that their table has, and their columns."""


def columns_of(source: TableSource) -> dict[str, str]:
    """Variables of the states of an experiment that its table has, and their columns."""
    if all(run.solver.accuracy is not None for run, _ in source.rows):
        return ACCURATE
    return dict(zip(NUMBERS, NUMBERS, strict=True)) | {"a2_error_estimate": "estimated_a2_error"}


def state_columns(source: TableSource, last: xr.Dataset) -> xr.Dataset:
    """The table of states, from their numbers; as of `state_table`."""
    assert isinstance(source.experiment, StateExperiment)
    rows, state = source.rows, source.experiment.state
    columns = columns_of(source)
    table = with_swept(last[[*columns, "status", "trust"]].rename(columns), rows)
    others = dict(zip(source.experiment.beside_table, source.beside, strict=True))
    table.attrs |= {"state": state, "dim": rows[0].run.scene.dim, "beside": " ".join(others)}
    shown = []
    for quantity in COMPARED[state]:
        theories = _theories(table, rows) if quantity == "a2" else {}
        beside = _beside(table, quantity, others)
        table = table.assign(theories | beside)
        shown += [quantity, *theories, *beside]
    if columns is ACCURATE:
        table = table.assign(linear_coefficient(table, rows))
        shown += ["estimated_a2_error", *OF_ACCURATE]
    shown += ["a3", "cooling_coefficient", "estimated_a2_error", "trust", "status"]
    check_quantity(source.quantity, table)
    table = table[list(dict.fromkeys((source.quantity, *shown)))]
    for name, variable in table.data_vars.items():
        if variable.dtype.kind == "f":
            own = column(str(name), list(others))
            variable.attrs["format"] = own.solved or own.digits
    return table


OF_ACCURATE = (
    "a3",
    "estimated_a3_error",
    "cooling_coefficient",
    "estimated_cooling_coefficient_error",
    "cooling_coefficient_linear",
    "tail_rate",
    "tail_rate_error",
    "far_speed",
    "far_slope",
    "far_slope_error",
)
"""Columns of states to an accuracy after those of a2, in reading order."""


def linear_coefficient(table: xr.Dataset, rows: Sequence[Row]) -> dict[str, Variable]:
    """K by linear theory: that of a Gaussian, corrected for the a2 of linear theory."""
    state, dim = table.attrs["state"], table.attrs["dim"]
    found = []
    for run, _ in rows:
        e, kernel = _restitution(run), run.scene.kernel
        a2 = theory_a2("a2_linear", state, e, dim, kernel.exponent)
        K = theory.gaussian_cooling_coefficient(kernel, e, dim)
        found.append(K * theory.cooling_correction(kernel.exponent, a2))
    name = "cooling_coefficient_linear"
    return {name: computed(name, np.array(found))}


def theory_a2(column: str, state: str, e: float, dim: int, exponent: float) -> float:
    """a2 of a state by the theory of a column: one of `LINEAR`, or ``a2_exact``."""
    if column == "a2_exact":
        return float(EXACT_MOMENTS[state](2, e, dim)[2]) - 1.0
    return LINEAR[state][column](e, dim, exponent)


def _theories(table: xr.Dataset, rows: Sequence[Row]) -> dict[str, Variable]:
    """Theory for every run: linear in a2, or exact for Maxwell molecules, with the error of a2."""
    state, dim = table.attrs["state"], table.attrs["dim"]
    gases = [(_restitution(run), run.scene.kernel.exponent) for run, _ in rows]
    exact = all(exponent == 0.0 for _, exponent in gases)
    found = {
        name: np.array([theory_a2(name, state, e, dim, exponent) for e, exponent in gases])
        for name in (("a2_exact",) if exact else LINEAR[state])
    }
    if exact:
        found["a2_error"] = np.abs(table["a2"].values - found["a2_exact"])
        if state == "cooling":
            tails = [theory.maxwell_tail_exponent(e, dim) for e, _ in gases]
            found["tail_exponent"] = np.array(tails)
    return {name: computed(name, values) for name, values in found.items()}


def _restitution(run: Run) -> float:
    """Restitution of a state's gas, which is constant."""
    e = run.scene.restitution
    assert not callable(e)
    return float(e)


def _beside(
    table: xr.Dataset, quantity: str, others: Mapping[str, xr.Dataset]
) -> dict[str, Variable]:
    """Other experiments' numbers for the same gases, in one quantity.

    Runs are of the same gas where all swept parameters are equal that both tables sweep. For each name in
    ``others``: `<quantity>_<name>`, its `.._standard_error` where the other table has one, and
    `.._difference`, that number less the state's own. NaN where the other experiment has no such run.

    Raises
    ------
    ValueError
        If the tables sweep no parameter in common, or another's lacks the quantity or has several runs of a
        gas.
    """
    names, found = list(others), dict[str, Variable]()
    for name, other in others.items():
        runs = _same_gases(table, other, quantity, name)
        theirs, of = f"{quantity}_{name}", f"{quantity} of {other.attrs['title']!r}"
        error, difference = f"{theirs}_standard_error", f"{theirs}_difference"
        values = _taken(other[quantity], runs)
        less = values - table[quantity].values
        found[theirs] = labelled(values, of, "run")
        if f"{quantity}_standard_error" in other:
            errors = _taken(other[f"{quantity}_standard_error"], runs)
            found[error] = computed(error, errors, names, of=of)
        found[difference] = computed(difference, less, names, of=of, own=quantity)
    return found


def _same_gases(table: xr.Dataset, other: xr.Dataset, quantity: str, name: str) -> list[int | None]:
    """Index of the same gas in another table for every run of a table; None where it has none."""
    swept, where = table.attrs["swept"].split(), f"table.beside={name!r}"
    common = [key for key in swept if key in other.attrs["swept"].split()]
    if not common:
        raise ValueError(f"{where}: sweeps none of {', '.join(swept)}")
    if quantity not in other:
        raise ValueError(f"{where}: its table has no {quantity}; give it quantity: {quantity}")
    place = {key: i for i, key in enumerate(keys(other, common))}
    if len(place) < other.sizes["run"]:
        raise ValueError(f"{where}: has several runs with the same {', '.join(common)}")
    return [place.get(key) for key in keys(table, common)]


def _taken(values: xr.DataArray, runs: Sequence[int | None]) -> np.ndarray:
    return np.array([np.nan if i is None else float(values[i]) for i in runs])
