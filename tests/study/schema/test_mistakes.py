"""What a study file is told of a field that its kind of run does not take."""

from typing import get_args

import pytest

from granstudy.runs.kinds import KINDS
from granstudy.study.schema.experiment import StateExperiment
from granstudy.study.schema.mistakes import EXPERIMENTS, taken_by

STUDY = """
title: test
experiments:
  fields:
    title: fields
    run: evolution
    scene: {name: bkw2d, restitution: 0.5}
    solver: {R: 7.0, N: 8}
    time: {t_final: 0.2, dt: 0.1}
    sweep:
      - {e: [0.2, 0.5]}
    table: {quantity: temperature}
  single:
    title: single
    run: collision
    scene: {name: bkw2d, restitution: 0.5}
    solver: {R: 7.0, N: 8}
    reference: {method: direct}
    sweep:
      - {M_cir: [4, 8]}
"""


def test_every_kind_has_its_row():
    states = get_args(StateExperiment.model_fields["state"].annotation)
    named = [name for name in EXPERIMENTS if name != "state"]
    assert list(KINDS) == [*named, *(f"{state} state" for state in states)]


@pytest.mark.parametrize(
    ("path", "text"),
    [
        (["time"], "evolution runs need it; others do not take it"),
        (["state"], "state runs need it, cooling or heated; others do not take it"),
        (
            ["reference"],
            "collision runs need it; benchmark runs may have it; others do not take it",
        ),
        (["truth"], "only evolution runs take it"),
        (["timing"], "only benchmark runs take it"),
        (["table", "average"], "only evolution runs take it"),
        (["table", "beside"], "only state runs take it"),
        (["table", "quantity"], ""),
        (["time", "t_final"], ""),
        (["scene", "name"], ""),
        (["nothing"], ""),
    ],
)
def test_which_kinds_take_a_field_follows_from_their_classes(path, text):
    assert taken_by(path) == text


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "run: evolution",
            "run: evoltion",
            r"fields.run: unknown run 'evoltion' \(did you mean 'evolution'\?\): allowed are evol",
        ),
        (
            "    run: evolution\n",
            "",
            "experiments.fields.run: must be given; allowed are evolution, ",
        ),
        ("run: evolution", "rum: evolution", r"fields.rum: unknown field \(did you mean 'run'"),
        ("title: fields", "titel: fields", r"fields.titel: unknown field \(did you mean 'title'"),
        ("{t_final: 0.2, dt: 0.1}", "", "experiments.fields.time: evolution runs need it"),
        ("{t_final: 0.2, dt: 0.1}", "{dt: 0.1}", "experiments.fields.time.t_final: must be given"),
        ("    reference: {method: direct}\n", "", "single.reference: collision runs need it"),
        (
            "quantity: temperature",
            "quantity: temperature, beside: [single]",
            "experiments.fields.table.beside: only state runs take it",
        ),
        (
            "    reference: {method: direct}\n",
            "    reference: {method: direct}\n    timing: {rounds: 1}\n",
            "experiments.single.timing: only benchmark runs take it",
        ),
        (
            "title: test",
            "title: test\nsweep: []",
            "yaml: sweep: unknown field; allowed are title, ",
        ),
        (
            "M_cir: [4, 8]",
            "dt: [0.1]",
            "single: sweep: 'dt' is of times, which only evolution runs",
        ),
        ("restitution: 0.5", "restitution: {viscoelastc: 0.5}", "restitution.viscoelastc: unknown"),
    ],
)
def test_mistakes(load, old, new, message):
    with pytest.raises(ValueError, match=message):
        load(old, new)


def test_everything_wrong_is_told_at_once(load):
    with pytest.raises(ValueError) as error:
        load(text=STUDY.replace("R: 7.0", "P: 7.0"))
    lines = str(error.value).splitlines()
    assert len(lines) == 2 and all("solver.P: unknown field" in line for line in lines)
