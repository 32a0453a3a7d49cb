"""Tables of states: theory, and what other experiments came to, beside what was solved for."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from granstudy import theory
from granstudy.datasets.open_runs import final_values
from granstudy.study.run import Run
from granstudy.study.schema.experiment import StateExperiment

COMPARED = {"a2": ".6f", "temperature": ".7f"}
"""What is held against other experiments, and the digits worth reading; the temperature if heated."""

LINEAR = {
    "cooling": {"a2_linear": theory.cooling_state_a2, "a2_divided": theory.montanero_santos_a2},
    "heated": {"a2_linear": theory.heated_state_a2},
}
"""Theories linear in a2 by column (`granstudy.theory`); of Maxwell molecules there are exact moments."""

EXACT_MOMENTS = {
    "cooling": theory.maxwell_cooling_moments,
    "heated": theory.maxwell_heated_moments,
}

LONG_NAMES = {
    "a2_linear": "a2 by the theory linear in it",
    "a2_divided": "a2 by the theory linear in it after division by 1 + a2",
    "a2_exact": "a2 by the exact moments of Maxwell molecules",
    "a2_error": "|a2 − a2_exact|",
    "tail_exponent": "p of the exact tail |v|^(−d−p), of which ⟨|v|⁴⟩ beyond V is V^(4−p)",
}


def state_table(rows: Sequence[tuple[Run, str]]) -> xr.Dataset:
    """What states are, with theory beside: linear in a2, for Maxwell molecules exact.

    Parameters
    ----------
    rows : sequence of (Run, str)
        Runs of one experiment and their files.

    Returns
    -------
    xarray.Dataset
        Over ``run``: `a2`, `a3`, `temperature`, `cooling_coefficient`, `estimated_a2_error`; theory by
        `LONG_NAMES`; the label `trust`. The attribute `state` says which states they are.
    """
    with final_values([file for _, file in rows]) as final:
        names = ["temperature", "a2", "a3", "cooling_coefficient", "a2_error_estimate", "status"]
        # One thread: netCDF4 has crashed under several.
        table = final[[*names, "trust"]].load(scheduler="synchronous")
    table = table.rename(a2_error_estimate="estimated_a2_error")
    run = rows[0][0]
    assert isinstance(run.model, StateExperiment)
    state, dim = run.model.state, run.scene.dim
    table.attrs |= {"state": state, "dim": dim}
    gases = [(float(run.scene.restitution), run.scene.kernel.exponent) for run, _ in rows]  # type: ignore[arg-type]
    if any(exponent > 0.0 for _, exponent in gases):
        for name, law in LINEAR[state].items():
            _add(table, name, [law(e, dim, exponent) for e, exponent in gases])
    else:
        exact = np.array([EXACT_MOMENTS[state](2, e, dim)[2] - 1.0 for e, _ in gases])
        _add(table, "a2_exact", exact)
        _add(table, "a2_error", np.abs(table["a2"].values - exact), ".1e")
        if state == "cooling":
            tails = [theory.maxwell_tail_exponent(e, dim) for e, _ in gases]
            _add(table, "tail_exponent", tails, ".3g")
    for name, digits in (COMPARED | {"a3": ".6f", "cooling_coefficient": ".7g"}).items():
        table[name].attrs["format"] = digits
    table["estimated_a2_error"].attrs["format"] = ".1e"
    return table


def with_beside(table: xr.Dataset, beside: dict[str, xr.Dataset]) -> xr.Dataset:
    """Add what other experiments' tables say of the same gases.

    Runs are of the same gas where all swept parameters are equal that both tables sweep. For each
    ``name`` in ``beside`` and each of `COMPARED` that its table has: `<quantity>_<name>`, with its
    `.._standard_error` where it has one, and `.._difference`, that number less the state's own. NaN where the
    other experiment has no such run.

    Raises
    ------
    ValueError
        If the tables sweep no parameter in common, another's has no a2, or several runs of a gas.
    """
    swept = table.attrs["swept"].split()
    for name, other in beside.items():
        common = [key for key in swept if key in other.attrs["swept"].split()]
        if not common:
            raise ValueError(f"table.beside={name!r}: sweeps none of {', '.join(swept)}")
        if "a2" not in other:
            raise ValueError(f"table.beside={name!r}: its table has no a2; give it quantity: a2")
        place = _places(other, common, name)
        found = [place.get(key) for key in _keys(table, common)]
        for quantity, digits in COMPARED.items():
            if quantity == "temperature" and table.attrs["state"] != "heated":
                continue
            column, long_name = f"{quantity}_{name}", f"{quantity} of {other.attrs['title']!r}"
            values = _taken(other[quantity], found)
            _add(table, column, values, digits, long_name)
            if (error := f"{quantity}_standard_error") in other:
                long = f"standard error of {long_name}"
                _add(table, f"{column}_standard_error", _taken(other[error], found), ".1e", long)
            difference = values - table[quantity].values
            long = f"{long_name}, less {quantity}"
            _add(table, f"{column}_difference", difference, ".1e", long)
    table.attrs["beside"] = " ".join(beside)
    return table


def columns(table: xr.Dataset) -> list[str]:
    """The columns of a table of states in reading order."""
    names = ["a2", *LONG_NAMES, *(str(name) for name in table if str(name).startswith("a2_"))]
    if table.attrs["state"] == "heated":
        names += [str(name) for name in table if str(name).startswith("temperature")]
    names += ["a3", "cooling_coefficient", "estimated_a2_error", "trust"]
    # the estimate stands beside the label that comes of it
    last = names[-2:]
    return [*dict.fromkeys(n for n in names if n in table and n not in last), *last]


def _add(
    table: xr.Dataset,
    name: str,
    values: Sequence[float] | np.ndarray,
    digits: str = ".6f",
    long_name: str | None = None,
) -> None:
    attributes = {"long_name": long_name or LONG_NAMES[name], "units": "1", "format": digits}
    table[name] = ("run", np.asarray(values, dtype=float), attributes)


def _keys(table: xr.Dataset, names: list[str]) -> list[tuple[object, ...]]:
    return [
        tuple(table[name].values[i].item() for name in names) for i in range(table.sizes["run"])
    ]


def _places(other: xr.Dataset, common: list[str], name: str) -> dict[tuple[object, ...], int]:
    keys = _keys(other, common)
    place = {key: i for i, key in enumerate(keys)}
    if len(place) < len(keys):
        raise ValueError(
            f"table.beside={name!r}: has several runs with the same {', '.join(common)}"
        )
    return place


def _taken(values: xr.DataArray, found: list[int | None]) -> np.ndarray:
    return np.array([np.nan if i is None else float(values[i]) for i in found])
