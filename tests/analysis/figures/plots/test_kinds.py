"""Kinds of figures of study files, beside what `ds.granular.plot` draws of the same runs."""

import numpy as np
import pytest
from studies import load_text, replaced

import granstudy as gs
from granstudy.analysis.requests import check_requests
from granstudy.study.schema.experiment import FigureModel

STUDY = """
title: look
experiments:
  cooling:
    title: "a2 of cooling gases"
    run: evolution
    scene: {name: maxwellian3d, exponent: 1.0, diffusion: 0.0}
    solver: {R: 9.0, method: radial}
    time: {t_final: 10.0, time_rtol: 1.0e-4, frame: rescaled, save_every: 4}
    sweep:
      - {e: [0.5, 0.7, 0.9], N: [10, 24]}
    table: {quantity: temperature}
    fit: {law: haff}
    figure: {kind: quantity, quantity: a2}
"""


def drawn(made, **figure):
    experiment = made.experiment("cooling").model_copy(update={"figure": FigureModel(**figure)})
    return made.draw("cooling", experiment=experiment)


def legend(figure):
    return [text.get_text() for one in figure.legends for text in one.get_texts()]


def test_a_quantity_over_time(made):
    figure = drawn(made, kind="quantity", quantity="a2")
    (ax,) = figure.axes
    assert ax.get_ylabel() == "$a_2$" and ax.get_xscale() == "log"
    assert figure.get_suptitle() == "a2 of cooling gases"
    labels = legend(figure)
    assert labels[:3] == ["$e$ = 0.5", "$e$ = 0.7", "$e$ = 0.9"] and "untrusted" in labels


def test_a_quantity_over_a_parameter_and_its_map_have_the_runs_last_numbers(made):
    table = made.tables["cooling"]
    (ax,) = drawn(made, kind="quantity", quantity="a2", x="e").axes
    last = gs.final_values(made.files["cooling"])["a2"].values
    shown = np.concatenate(
        [line.get_ydata() for line in ax.lines if line.get_linestyle() in ("-", "--")]
    )
    assert set(np.round(last, 12)) <= set(np.round(shown.astype(float), 12))
    ax = drawn(made, kind="map", x="e", y="N").axes[0]
    assert len(ax.texts) == 6
    assert {t.get_text() for t in ax.texts} == {f"{T:.2g}" for T in table["temperature"].values}


@pytest.mark.parametrize("kind", ["over_maxwellian", "tail", "marginal"])
def test_densities(made, kind):
    figure = drawn(made, kind=kind)
    (ax,) = figure.axes
    assert "Maxwellian" in legend(figure) and "untrusted" in legend(figure)
    assert ax.get_yscale() == ("linear" if kind == "marginal" else "log")
    assert len([line for line in ax.lines if len(line.get_xdata()) > 30]) >= 6


def test_cooling_has_fits_and_trust(made):
    figure = drawn(made, kind="cooling")
    left, right = figure.axes
    assert left.get_xscale() == left.get_yscale() == "log"
    assert "untrusted" in legend(figure) and right.get_ylabel() == r"$\sqrt{T_0/T} - 1$"
    assert sum(line.get_linestyle() == "--" for line in left.lines) == 6


@pytest.mark.parametrize(
    ("figure", "message"),
    [
        (
            "{kind: quantity, quantity: b2}",
            "figure.quantity: unknown quantity 'b2': allowed are density",
        ),
        ("{kind: quantity, x: R}", "figure.x='R': must be one of the swept parameters e, N"),
        ("{kind: map, x: e}", "figure.y: must be given; a map is over two swept parameters"),
        ("{kind: map, x: e, y: e}", "figure.y='e': must be another parameter than figure.x"),
        (
            "{kind: cooling, quantity: a2}",
            "figure.quantity='a2': only quantity, map take it, not cooling",
        ),
        ("{kind: quantity, y: N}", "figure.y='N': only map take it, not quantity"),
    ],
)
def test_mistakes_are_told_before_any_work(tmp_path, figure, message):
    text = replaced(STUDY, "{kind: quantity, quantity: a2}", figure)
    with pytest.raises(ValueError, match=message):
        check_requests(load_text(tmp_path, text))


def test_densities_must_be_kept(tmp_path):
    text = replaced(STUDY, ", save_every: 4", "")
    text = replaced(text, "{kind: quantity, quantity: a2}", "{kind: tail}")
    with pytest.raises(ValueError, match=r"figure.kind='tail': .* keeps none; set time.save_every"):
        check_requests(load_text(tmp_path, text))


def test_a_map_of_more_than_two_parameters_is_refused(tmp_path):
    text = replaced(STUDY, "N: [10, 24]}", "N: [10, 24], R: [8.0, 9.0]}").replace("R: 9.0, ", "")
    text = replaced(text, "{kind: quantity, quantity: a2}", "{kind: map, x: e, y: N}")
    with pytest.raises(ValueError, match="the runs differ in R too"):
        check_requests(load_text(tmp_path, text))


def test_what_runs_chose_for_themselves_tells_no_line_from_another(tmp_path):
    """The grids of two accuracies differ; the legend has what is swept."""
    said = {
        "title": "test",
        "experiments": {
            "cooling": {
                "title": "cooling",
                "run": "evolution",
                "scene": {"name": "maxwellian2d", "exponent": 1.0, "diffusion": 0.0, "e": 0.5},
                "time": {"t_final": 1.0},
                "sweep": [{"accuracy": [1e-2, 1e-5]}],
                "table": {"quantity": "temperature"},
                "figure": {"kind": "cooling"},
            }
        },
    }
    study = gs.open_study(said, results=tmp_path)
    study.compute(workers=1, progress=False)
    assert len(set(study.dataset("cooling")["N"].values)) == 2
    (legend,) = study.figure("cooling").legends
    assert not [text for text in legend.get_texts() if "N" in text.get_text()]
