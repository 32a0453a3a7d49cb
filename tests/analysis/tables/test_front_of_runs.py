"""A front of whole runs from its study file: accuracies that are asked for, beside solvers set by hand."""

import numpy as np
import pytest
from studies import load_text, replaced

from granstudy.analysis.figures.plots.whole_runs import KNOWN, NAMES, run_front
from granstudy.analysis.labels import ASKED, families
from granstudy.analysis.requests import table_source
from granstudy.analysis.tables.markdown import markdown_table
from granstudy.analysis.tables.planned import planned_table

STUDY = """
title: tiny
experiments:
  cooling:
    title: cooling
    run: evolution
    scene: {name: bkw3d, e: 0.5, exponent: 1.0, diffusion: 0.0}
    solver: {R: 8.0}
    time: {t_final: 1.0, times: [0.5], time_rtol: 1.0e-4}
    truth:
      solver: {method: radial, N: 32, R: 10.0}
      time: {time_rtol: 1.0e-9, frame: rescaled}
    sweep:
      - {accuracy: [1.0e-2, 1.0e-4]}
      - {method: radial, N: [8, 16], frame: rescaled}
      - {method: dsmc, N: 16, R: 7.0, particles: 2000}
    table: &table {quantity: largest_temperature_error, seconds: true}
    figure: {kind: front, beside: [heated]}
  heated:
    title: heated
    run: evolution
    scene: {name: maxwellian2d, e: 0.5, exponent: 1.0, diffusion: 0.1}
    time: {t_final: 1.0, times: [0.5]}
    truth:
      solver: {method: radial, N: 32, R: 10.0}
      time: {time_rtol: 1.0e-9, frame: rescaled}
    accuracy: 1.0e-3
    sweep:
      - {e: 0.5}
    table: *table
"""


@pytest.fixture(scope="module")
def load(tmp_path_factory):
    folder = tmp_path_factory.mktemp("refused")
    return lambda old, new: load_text(folder, replaced(STUDY, old, new))


def test_blocks_beside_a_truth_say_what_they_need(made):
    runs = made.study.runs["cooling"]
    assert [run.is_reference for run in runs.values()] == [False, True, False, False, False, False]
    asked, set_by_hand = (
        runs["accuracy~0.0001"],
        runs["N~16/method~radial/frame~rescaled"],
    )
    assert asked.solver.accuracy == 1e-4 and asked.solver.N is None
    assert set_by_hand.solver.accuracy is None
    assert (set_by_hand.solver.N, set_by_hand.solver.R) == (16, 8.0)
    assert set_by_hand.time_fields["time_rtol"] == 1e-4 and "time_rtol" not in asked.time_fields
    assert asked.truth.path == set_by_hand.truth.path == "reference"
    # an accuracy of the whole experiment is none of its truth's
    truth = made.study.run("heated", "e~0.5").truth
    assert truth.solver.accuracy is None and truth.solver.N == 32


def test_every_row_stands_under_all_that_is_swept(made):
    table = made.tables["cooling"]
    swept = ["accuracy", "N", "R", "particles", "method", "frame"]
    assert table.attrs["swept"].split() == swept
    assert families(table) == [ASKED, ASKED, "radial", "radial", "dsmc"]
    np.testing.assert_array_equal(table["accuracy"], [1e-2, 1e-4, np.nan, np.nan, np.nan])
    assert table["particles"].values.tolist() == [-1, -1, -1, -1, 2000]
    planned = planned_table(table_source(made.study, "cooling", []))
    assert planned.attrs["swept"].split() == swept
    assert families(planned) == families(table)
    rows = [line.split("|") for line in markdown_table(table).splitlines() if line.startswith("| ")]
    assert [row[1].strip() for row in rows] == ["accuracy", "0.01", "0.0001", "", "", ""]
    assert all(len(row[3].strip()) <= 8 for row in rows), "a chosen R has all its digits"


def test_accuracies_are_kept_and_the_truth_is_known_better(made):
    table = made.tables["cooling"]
    error, asked = table["largest_temperature_error"].values[:2], table["accuracy"].values[:2]
    assert np.all(error <= asked) and np.all(table["largest_a2_error"].values[:2] <= 10 * asked)
    assert 0 < table.attrs["temperature_known_to"] < 1e-6
    assert 0 < table.attrs["a2_known_to"] < 1e-5


def test_the_figure_has_a_column_for_each_gas_and_a_line_of_what_was_asked(made):
    figure = made.draw("cooling")
    axes = np.array(figure.axes).reshape(2, 2)
    assert [ax.get_title() for ax in axes[0]] == ["cooling", "heated"]
    table = made.tables["cooling"]
    for ax, measure in zip(
        axes[:, 0], ("largest_temperature_error", "largest_a2_error"), strict=True
    ):
        assert ax.get_xscale() == ax.get_yscale() == "log"
        line = next(line for line in ax.lines if line.get_color() == "black")
        # from the finest to the coarsest
        np.testing.assert_array_equal(line.get_xdata(), table["seconds"].values[[1, 0]])
        np.testing.assert_array_equal(line.get_ydata(), table[measure].values[[1, 0]])
    assert [text.get_text() for text in axes[0, 0].texts] == ["$10^{-2}$", "$10^{-4}$"]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:3] == [NAMES[ASKED], "radial", "dsmc"]


def test_one_gas_has_both_errors_side_by_side(made):
    T, a2 = run_front([made.tables["heated"]]).axes
    assert "T" in T.get_ylabel() and "a_2" in a2.get_ylabel()
    assert T.get_position().x1 < a2.get_position().x0


def test_how_well_the_truth_is_known_is_a_line_where_it_is_in_sight(made):
    table = made.tables["cooling"]
    labels = [t.get_text() for t in run_front([table]).legends[0].get_texts()]
    assert KNOWN not in labels
    middle = float(np.median(table["largest_temperature_error"]))
    figure = run_front([table.assign_attrs(temperature_known_to=middle)])
    assert KNOWN in [text.get_text() for text in figure.legends[0].get_texts()]
    drawn = [line.get_ydata() for line in figure.axes[0].lines if line.get_linestyle() == ":"]
    assert drawn == [[middle, middle]]


def test_what_does_not_stand_beside_is_refused(made, load):
    heated = made.tables["heated"]
    with pytest.raises(ValueError, match="heated: a front needs table.seconds: true"):
        run_front([heated.drop_vars("seconds")])
    without = heated.copy()
    del without.attrs["truth"]
    with pytest.raises(ValueError, match="heated: has no truth"):
        run_front([made.tables["cooling"], without])
    # the experiment's solver is that of the blocks that ask for no accuracy, where there are some
    with pytest.raises(ValueError, match="R=8.0: not beside accuracy, which chooses it"):
        load(STUDY[STUDY.index("      - {method: radial") : STUDY.index("    table: &table")], "")
    with pytest.raises(ValueError, match="N=8: not beside accuracy, which chooses it"):
        load("{accuracy: [1.0e-2, 1.0e-4]}", "{accuracy: 1.0e-2, N: 8, R: 8.0}")


def test_blocks_without_a_truth_set_the_same_parameters(load):
    truth = STUDY[STUDY.index("    truth:") : STUDY.index("    sweep:")]
    with pytest.raises(
        ValueError, match="all blocks must set the same parameters, except those of"
    ):
        load(truth, "")
