"""Every column has its row, which tables, figures and comparisons read."""

from pathlib import Path

import pandas as pd
import pytest

from granstudy.analysis.columns import (
    COLUMNS,
    CONSTANT,
    DERIVED,
    column,
    computed,
    heading,
    listed,
    reading_order,
    symbol,
    tolerance,
)
from granstudy.analysis.compare import KEYS
from granstudy.study.benchmark.benchmark import VARIABLES
from granstudy.velocity.moments import MOMENTS

TABLES = sorted((Path(__file__).parents[2] / "results").glob("*/tables/*.csv"))
OTHERS = ["cooling_particles", "heated_particles", "from_hot", "from_cold"]


@pytest.mark.parametrize("path", TABLES, ids=lambda path: f"{path.parts[-3]}/{path.stem}")
def test_every_committed_column_has_a_row_and_stands_in_reading_order(path):
    columns = [name for name in pd.read_csv(path, nrows=1).columns if name not in KEYS]
    states = "estimated_a2_error" in columns
    beside = OTHERS if states else []
    assert {listed(name, beside) for name in columns} <= COLUMNS.keys()
    if path.stem not in ("map", "atlas"):  # labels that are wrong last; an error by its number
        assert reading_order(columns, columns[0], beside, as_built=states) == columns


def test_every_moment_and_every_measure_of_a_benchmark_has_a_row():
    assert {name for name, moment in MOMENTS.items() if not moment.dimensions} <= COLUMNS.keys()
    assert set(VARIABLES) <= COLUMNS.keys()


def test_a_column_without_a_row_is_an_error_that_names_it():
    with pytest.raises(ValueError, match="column 'surprise': has no row in .*COLUMNS"):
        reading_order(["a2", "surprise"], "a2")
    with pytest.raises(ValueError, match="'a2_surprise'"):
        column("a2_surprise")


def test_columns_named_at_run_time_follow_one_rule():
    beside = ["others"]
    assert listed("a2_others_difference", beside) == "a2"
    assert column("temperature_others", beside).solved == column("temperature").solved
    for name in ("a2_standard_error", "a2_others_standard_error"):
        dims, values, about = computed(name, [0.1], beside, of="a2 of others")
        assert (dims, values) == ("run", [0.1])
        assert about == {"long_name": "standard error of a2 of others", "units": "1"}
    # a row of its own goes before the rule
    assert listed("a2_error", ["error"]) == "a2_error"
    assert tolerance("a2_others") is COLUMNS["a2"].tolerance
    assert tolerance("a2_others_difference") is DERIVED["_difference"].tolerance
    assert tolerance("a2_others_standard_error") is tolerance("N_rho") is CONSTANT
    assert heading("a2_others_difference") == "a2 others difference"


def test_the_quantity_comes_first_and_the_status_last():
    names = ["status", "density_drift", "temperature", "a2", "a2_standard_error", "order", "front"]
    in_order = ["a2", "a2_standard_error", "order", "temperature", "front", "density_drift"]
    assert reading_order(names, "a2") == [*in_order, "status"]
    as_built = ["a2", "a2_standard_error", "order", "density_drift", "temperature", "front"]
    assert reading_order(names, "a2", as_built=True) == [*as_built, "status"]


def test_parameters_and_columns_are_called_by_heading_and_symbol():
    assert [heading(name) for name in ("N_rho", "M_sph", "C0", "density_drift", "threads")] == [
        "N_ρ",
        "M_sph",
        "C₀",
        "density drift",
        "threads",
    ]
    assert [symbol(name) for name in ("N", "variant", "a2", "front", "threads")] == [
        "$N$",
        "variant",
        "$a_2$",
        "front",
        "threads",
    ]


def test_digits_of_a_ratio_follow_its_size():
    assert [column("ratio").text(value) for value in (1.0, 0.0123, 0.0045, 2e4)] == [
        "1.000",
        "0.012",
        "4.5e-03",
        "2.0e+04",
    ]
