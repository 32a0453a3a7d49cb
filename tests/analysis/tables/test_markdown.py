"""Markdown tables: cells, alignment, and methods that nobody listed."""

import numpy as np

from granstudy.analysis.tables.markdown import github_table, markdown_table


def cells(text):
    """The cells of a Markdown table's lines, but for the rule below its header."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return rows[:1] + rows[2:]


def test_cells_stay_as_they_are_and_go_to_their_side():
    text = github_table(
        ["a", "b", "b"], [["0.20", "1e-3", ""], ["x", "-0", "7"]], ["left"] * 2 + ["right"]
    )
    assert cells(text) == [["a", "b", "b"], ["0.20", "1e-3", ""], ["x", "-0", "7"]]
    rule = text.splitlines()[1].strip("|").split("|")
    assert [(side.startswith(":"), side.endswith(":")) for side in rule] == [
        (True, False),
        (True, False),
        (False, True),
    ]


def test_methods_share_lines_the_papers_first_and_new_ones_last(table_of):
    rows = [
        (N, method, error)
        for N in (8, 16)
        for method, error in (("new", 1e-3), ("fast", 2e-3), ("literal", 3e-3))
    ]
    table = table_of(rows, ["N", "method"], "collision_error")
    table["status"] = ("run", np.zeros(6, dtype=np.int8))
    assert cells(markdown_table(table)) == [
        ["N", "literal", "fast", "new"],
        ["8", "3.000e-03", "2.000e-03", "1.000e-03"],
        ["16", "3.000e-03", "2.000e-03", "1.000e-03"],
    ]


def test_a_run_that_ended_early_says_so_and_absent_parameters_stay_empty(table_of):
    rows = [("fast", 30, -1.0, np.nan), ("radial", -1, 1e-7, 0.25)]
    table = table_of(rows, ["method", "N_rho", "time_rtol"], "a2")
    table["temperature"] = ("run", np.array([np.nan, 1.0]))
    table["status"] = ("run", np.array([2, 0], dtype=np.int8))
    text = markdown_table(table)
    assert cells(text) == [
        ["method", "N_ρ", "time_rtol", "a2", "temperature"],
        ["fast", "30", "", "diverged", ""],
        ["radial", "", "1e-07", "0.25", "1"],
    ]
    assert "diverged: the run could not reach the final time." in text


def test_numbers_side_by_side_tell_which_are_not_trusted(table_of):
    rows = [(8, "fast", 2e-3), (8, "literal", 3e-3), (16, "fast", 4e-4), (16, "literal", 5e-4)]
    table = table_of(rows, ["N", "method"], "temperature_error")
    table["status"] = ("run", np.zeros(4, dtype=np.int8))
    table["trust"] = ("run", np.array([0, 1, 2, 2], dtype=np.int8))
    assert cells(markdown_table(table)) == [
        ["N", "literal", "fast"],
        ["8", "3.000e-03 (marginal)", "2.000e-03 (untrusted)"],
        ["16", "5.000e-04", "4.000e-04"],
    ]
