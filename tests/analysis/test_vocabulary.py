"""Words of a study file that the analysis knows."""

from pathlib import Path

import pytest

from granstudy.analysis.figures.figure import FIGURES
from granstudy.analysis.tables.fits import FITS
from granstudy.analysis.vocabulary import check_words, study_schema, write_schema
from granstudy.study.schema.experiment import FigureModel, FitModel
from granstudy.study.study import load_study

WORKFLOW = Path(__file__).parents[2] / "workflow" / "config"

STUDY = """
title: words
experiments:
  errors:
    title: errors
    run: evolution
    scene: {name: bkw2d, restitution: 0.5}
    solver: {N: 8, R: 7.0}
    time: {t_final: 1.0}
    sweep:
      - {dt: [0.1, 0.2]}
    table: {quantity: temperature_error, paper: table1}
    fit: {law: order, x: dt}
    figure: {kind: convergence, x: dt}
"""


@pytest.mark.parametrize("path", sorted(WORKFLOW.glob("*.yaml")), ids=lambda path: path.stem)
def test_the_shipped_studies_use_known_words(path):
    check_words(load_study(path).model)


def test_every_unknown_word_is_named_with_the_nearest(load):
    study = load().model
    check_words(study)
    errors = study.experiments["errors"]
    table = errors.table.model_copy(update={"quantity": "temperture", "paper": "table9"})
    fit = FitModel.model_construct(law="ordr")
    figure = FigureModel.model_construct(kind="convergense")
    changed = errors.model_copy(update={"table": table, "fit": fit, "figure": figure})
    with pytest.raises(ValueError) as caught:
        check_words(study.model_copy(update={"experiments": {"errors": changed}}))
    lines = str(caught.value).splitlines()
    assert [line.split(": allowed are ")[0] for line in lines] == [
        "experiments.errors.table.quantity: unknown quantity 'temperture' (did you mean 'temperature'?)",
        "experiments.errors.table.paper: unknown printed table 'table9' (did you mean 'table8'?)",
        "experiments.errors.fit.law: unknown law 'ordr' (did you mean 'order'?)",
        "experiments.errors.figure.kind: unknown kind 'convergense' (did you mean 'convergence'?)",
    ]


def test_standard_errors_are_quantities(load):
    check_words(load("temperature_error", "temperature_standard_error").model)


def test_editors_know_the_words(tmp_path):
    sections = study_schema()["$defs"]
    assert sections["FigureModel"]["properties"]["kind"]["enum"] == list(FIGURES)
    assert sections["FitModel"]["properties"]["law"]["enum"] == list(FITS)
    write_schema(tmp_path / "study.schema.json")
    committed = WORKFLOW / "study.schema.json"
    assert (tmp_path / "study.schema.json").read_text() == committed.read_text()
